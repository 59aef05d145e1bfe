// Long jobs with their progress, and what the session keeps.

import { card, el } from '../draw/dom.js';
import { RAW } from '../run/data.js';
import { AXES } from '../run/external-axes.js';
import { concerns } from './concerns.js';
import { goTo, place, placeOf } from './place.js';
import { PAGE, Refusal, ask, onLost, serverState } from './server.js';
import { keptOver, loadAnew } from './tab.js';

/** Between two looks at the server while a job runs, and while none does. ms */
const [OFTEN_MS, SELDOM_MS] = [300, 800];

/** @type {((state: any) => void)[]} */
const watchers = [];
/** @param {(state: any) => void} watch told what the server keeps, now and later */
export const onState = (watch) => {
  watchers.push(watch);
  watch(RAW.live.state);
};

/** Jobs that had ended before this page was opened are not told of. */
let told = RAW.live.state.jobs.ended.reduce((/** @type {number} */ last, /** @type {any} */ job) => Math.max(last, job.id), 0);
let timer = 0;
/** @type {(text: string, isWrong?: boolean) => void} */
let say = () => {};

/** Says something where the jobs are. @param {string} text @param {boolean} [isWrong] */
export const tell = (text, isWrong = false) => say(text, isWrong);

/** Does something that the server may refuse. @param {() => Promise<any>} act */
export const tried = (act) =>
  act().catch((error) => {
    say(error instanceof Refusal ? error.message : 'the session does not answer', true);
    return null;
  });

async function look() {
  clearTimeout(timer);
  let state = null;
  try {
    state = await serverState();
  } catch {
    // What is lost is said elsewhere; it is looked for all the same.
  }
  if (state) {
    if (state.version !== RAW.live.state.version) return changed(state.edits);
    for (const job of state.jobs.ended) if (job.id > told) ended(job);
    watchers.forEach((watch) => watch(state));
  }
  timer = window.setTimeout(look, state && !state.jobs.running ? SELDOM_MS : OFTEN_MS);
}

/** Shows the run with the values as they are now; the part, the steps back and what is compared stay. @param {string[]} edits */
export function changed(edits) {
  tell(`the values of the run were changed: ${edits.length ? edits.join(', ') : 'they are those of the file'}`);
  loadAnew();
}

/** @param {any} job */
function ended(job) {
  told = job.id;
  const name = `${job.name}${job.was_stopped ? ', stopped' : ''}`;
  if (job.error) return say(`${name}: ${job.error}`, true);
  say(`${name}: ${job.said.join('; ')}`);
  if (job.place && job.page === PAGE && !job.name.startsWith('keep')) goTo(placeOf(job.place));
}

/** Begins a job at the place of now. @param {string} job @param {Record<string, any>} [more] */
export const begin = (job, more = {}) => tried(() => ask('/job', { job, ...place, ...more })).then(look);

/** A button with a name of its own. @param {string} id @param {string} text @param {() => void} onclick */
export const chip = (id, text, onclick) => el('button.chip', { type: 'button', id, onclick }, text);

/** The card of the jobs. */
export function jobsCard() {
  const gap = /** @type {HTMLInputElement} */ (el('input', { type: 'number', id: 'gap', value: 1, min: 0.0001, max: 99, step: 'any' }));
  const label = /** @type {HTMLInputElement} */ (el('input', { type: 'text', id: 'label', maxlength: 60, placeholder: 'name' }));
  const keep = () => {
    const text = label.value.trim();
    const doubts = concerns().filter(({ level }) => level).map(({ text: doubt }) => `- ${doubt}`);
    if (doubts.length && !confirm(['Pin this placement all the same?', ...doubts].join('\n'))) return;
    void begin('keep', text ? { is_labelled: true, label: text } : {});
  };
  const starts = [
    chip('search-here', 'Search from here', () => void begin('search_here')),
    chip('search-cell', 'Search the cell', () => void begin('search_cell')),
    ...(AXES.length ? [chip('set-up', 'Axes where it is best', () => void begin('set_up'))] : []),
    chip('certify', 'Certify', () => void begin('certify', { gap_percent: gap.valueAsNumber })),
    chip('keep', 'Pin this placement', keep),
  ];
  const bar = /** @type {HTMLProgressElement} */ (el('progress', { 'aria-label': 'Progress' }));
  const words = el('span.sub', { id: 'job-words' });
  const stop = chip('stop', 'Stop', () => void tried(() => ask('/stop')).then(look));
  // Before the words, which change, so that it stays where it is.
  const running = el('div.row', { id: 'job', hidden: true }, stop, bar, words);
  const log = el('ul');
  const logged = el('div.log', { id: 'log', role: 'log', 'aria-label': 'What jobs came to', tabindex: 0, hidden: true }, log);
  say = (text, isWrong = false) => {
    logged.hidden = false;
    log.prepend(el(isWrong ? 'li.wrong' : 'li', {}, text));
    while (log.childElementCount > 30) log.lastElementChild?.remove();
  };
  const lines = keptOver('log', () => Array.from(log.children, (line) => [line.textContent, line.className]));
  for (const [text, kind] of (lines ?? []).reverse()) say(text, kind === 'wrong');
  onState((state) => {
    const job = state.jobs.running;
    running.hidden = !job;
    starts.forEach((start) => (/** @type {any} */ (start).disabled = Boolean(job)));
    if (!job) return;
    if (job.total) {
      bar.max = job.total;
      bar.value = job.done;
    } else bar.removeAttribute('value');
    words.textContent = [job.name, job.stage, job.message, `${job.seconds} s`, job.is_stopping ? 'ends with what it has' : ''].filter(Boolean).join(' · ');
    /** @type {any} */ (stop).disabled = job.is_stopping;
  });
  return card(
    'Search, certify, keep',
    `kept in ${RAW.live.state.folder}`,
    el('div.row', {}, starts[0], starts[1], ...(AXES.length ? [starts[2]] : [])),
    el('div.row', {}, starts[starts.length - 2], el('label.field', {}, el('span', {}, 'gap %'), gap), starts[starts.length - 1], el('label.field', {}, el('span', {}, 'as'), label)),
    running,
    logged,
  );
}

/** A line that says that the session has ended; what would ask it is grey. @param {HTMLElement[]} asking */
export function lostBanner(...asking) {
  const banner = el('div.warnings.lost', { id: 'lost', role: 'alert', hidden: true }, 'The session has ended, or does not answer. What is pinned is kept: start `stead live` again.');
  onLost((isLost) => {
    banner.hidden = !isLost;
    asking.forEach((part) => (part.inert = isLost));
  });
  return banner;
}

/** Begins to look at the server. */
export const watchServer = () => void (timer = window.setTimeout(look, OFTEN_MS));
