// Along the path: buttons, slider, keys.

import { el } from '../draw/dom.js';
import { fixed } from '../draw/scale.js';
import { cssOf, turnTheme } from '../draw/theme.js';
import { colourOf } from './colour.js';
import { CASES, COUNT, RAW, postureText } from './data.js';
import { reasonText } from './map.js';
import { RUNS, SEGMENT, isMove, pathPoint } from './path.js';
import { clock, nextSpeed, onPlaying, pause, playOrPause, timeAt } from './play.js';
import { chosenState, current, currentPoint, onChange, set, state } from './state.js';
/** @import { Case } from './data.js' */
/** @import { mapState } from './state.js' */

/** What is said on the way from one segment to the next. @param {Case} of */
function moveWords(of) {
  const low = Math.floor(state.t);
  if (state.t === low || !isMove(low)) return '';
  const pair = of.entry.transfers?.[SEGMENT[low] - 1]?.blocked_by;
  return pair ? `moving over, no free way: ${pair}` : 'moving over';
}

/** What is said of a state of the map. @param {ReturnType<typeof mapState>} chosen */
function chosenWords(chosen) {
  const point = `point ${chosen.point} of ${RAW.task.points - 1}`;
  const beta = `β ${fixed(chosen.beta, 1)}°`;
  if (!chosen.isAllowed) return [point, beta, `not allowed: ${reasonText(chosen.reason)}`, 'the robot stays on the plan'];
  return [point, `segment ${SEGMENT[currentPoint()]}`, postureText(chosen.posture), beta, `${fixed(chosen.score)} mm, chosen in the map`];
}

export function transport() {
  const button = el('button.play', { type: 'button', id: 'play', 'aria-label': 'Play', onclick: playOrPause }, '▶');
  onPlaying((isPlaying) => {
    button.textContent = isPlaying ? '❚❚' : '▶';
    button.setAttribute('aria-label', isPlaying ? 'Pause' : 'Play');
  });
  const pace = el('button.chip', { type: 'button', id: 'speed', 'aria-label': '1×: speed' }, '1×');
  pace.addEventListener('click', () => {
    const speed = nextSpeed();
    pace.textContent = speed === 0.5 ? '½×' : `${speed}×`;
    pace.setAttribute('aria-label', `${pace.textContent}: speed`);
  });
  const slider = /** @type {HTMLInputElement} */ (
    el('input', { type: 'range', id: 'slider', min: 0, max: COUNT - 1, step: 1, value: 0, 'aria-label': 'Path point' })
  );
  slider.addEventListener('input', () => {
    pause();
    set({ t: +slider.value });
  });
  const strip = /** @type {HTMLCanvasElement} */ (el('canvas.strip', { height: 6, 'aria-hidden': 'true' }));
  const now = el('div.now', { id: 'now' });
  onChange(({ case: isOther }) => {
    const of = current();
    const i = currentPoint();
    slider.value = String(state.t);
    const chosen = chosenState();
    slider.setAttribute(
      'aria-valuetext',
      chosen ? chosenWords(chosen).join(', ') : `point ${pathPoint(i)}, segment ${SEGMENT[i]}, ${fixed(of.columns.score_mm[i])} mm`,
    );
    const parts = [
      `point ${pathPoint(i)} of ${RAW.task.points - 1}`,
      moveWords(of) || `segment ${SEGMENT[i]}`,
      postureText(of.columns.posture[i]),
      `β ${fixed(of.columns.beta_deg[i], 1)}°`,
      `${fixed(timeAt(clock(), state.t), 1)} s`,
    ];
    now.textContent = (chosen ? chosenWords(chosen) : parts).join(' · ');
    if (!isOther) return;
    const wide = Math.min(COUNT, 2000);
    strip.width = wide;
    const g = /** @type {CanvasRenderingContext2D} */ (strip.getContext('2d'));
    for (let x = 0; x < wide; x++) {
      g.fillStyle = cssOf(colourOf(of.columns.score_mm[Math.floor((x / wide) * COUNT)]));
      g.fillRect(x, 0, 1, 6);
    }
  });
  return el(
    'section.card.bar',
    { 'aria-label': 'Position along the tool path' },
    button,
    pace,
    el('div.track', {}, slider, strip),
    now,
  );
}

/** Keys that work wherever nothing else takes them. @param {KeyboardEvent} event */
export function onKey(event) {
  if (event.ctrlKey || event.metaKey || event.altKey) return;
  const target = /** @type {HTMLElement} */ (event.target);
  const isOnControl =
    ['BUTTON', 'SUMMARY', 'A'].includes(target.tagName) || /** @type {any} */ (target).type === 'checkbox';
  const { key } = event;
  const i = currentPoint();
  if (key === 'ArrowRight' || key === 'ArrowLeft') {
    const step = key === 'ArrowRight' ? 1 : -1;
    const starts = RUNS.map(([first]) => first);
    const far =
      step > 0 ? (starts.find((first) => first > i) ?? COUNT - 1) : (starts.filter((first) => first < i).pop() ?? 0);
    pause();
    set({ t: event.shiftKey ? far : i + step });
  } else if (key === ' ' && !isOnControl) playOrPause();
  else if (key >= '1' && key <= String(CASES.length)) set({ case: +key - 1 });
  else if (key === 'd' || key === 'D') turnTheme();
  else if (key === 'Home' || key === 'End') {
    pause();
    set({ t: key === 'Home' ? 0 : COUNT - 1 });
  } else if (key === 'Escape') set({ chosen: null });
  else return;
  event.preventDefault();
}
