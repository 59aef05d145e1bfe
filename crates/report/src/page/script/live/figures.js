// What the placement comes to: the sentence, the figures, and what is in its way.

import { card, el } from '../draw/dom.js';
import { fixed } from '../draw/scale.js';
import { CASES, RAW } from '../run/data.js';
import { SCORED } from '../run/path-mesh.js';
import { concerns } from './concerns.js';
import { onAnswer, shown } from './follow.js';

/** How much the view greys while there is no plan. */
const view = () => document.querySelector('.view');

/** Whether the figures are those of now, and of how many points. */
function stateWords() {
  const { answer, isFollowing, isWhole, isFeasible } = shown;
  if (!answer) return 'being computed';
  const [some, all] = answer.points;
  const points = some < all ? ` on ${some} of ${all} points: an estimate` : '';
  if (isFollowing) return `following the part${points}`;
  if (!isFeasible) return isWhole ? 'no plan' : `no plan on the grid of the run${points}; a finer one is looked for`;
  return isWhole ? `as 'stead score' states it${points}` : `on the grid of the run${points}; the whole follows`;
}

/** @typedef {[id: string, name: string, value: (best: any) => string, more: (best: any) => string]} Figure */
const mm = (/** @type {number | null | undefined} */ value, digits = 4) => (value === null || value === undefined ? '–' : `${fixed(value, digits)} mm`);

/** @type {Figure[]} */
export const FIGURES = [
  ['mean', `Mean ${SCORED} error`, (best) => mm(best.mean_mm), () => ''],
  ['largest', 'Largest', (best) => mm(best.max_mm), () => ''],
  ['total', 'Whole deflection', (best) => mm(best.deflection_mm?.total.mean), (best) => `largest ${mm(best.deflection_mm?.total.max, 3)}`],
  ['clearance', 'Clearance', (best) => mm(best.clearance?.distance_mm, 1), (best) => best.clearance?.pair.join(' and ') ?? ''],
  ['feed', 'Highest feed', (best) => (best.feed?.highest_mm_per_s ? `${fixed(best.feed.highest_mm_per_s, 0)} mm/s` : '–'), (best) => feedWords(best.feed)],
  ['travel', 'Joint travel', (best) => (best.joint_travel ? `${fixed(best.joint_travel.total_deg, 0)}°` : '–'), () => ''],
  ['cycle', 'Cycle', (best) => (best.cycle_s === null ? '–' : `${fixed(best.cycle_s, 1)} s`), (best) => (best.cycle_s === null ? `cut ${fixed(best.cutting_s, 1)} s` : '')],
];

/** What decides the feed. @param {any} feed */
function feedWords(feed) {
  const by = feed?.decided_by;
  if (!by) return '';
  const what = by.joint ? `joint ${by.joint}` : by.external_axis;
  return `${by.kind} of ${what}, point ${by.point}`;
}

/** The figures, which are shown as they come. */
export function figuresCard() {
  const state = el('span.sub', { id: 'live-state' });
  const cells = FIGURES.filter(([id]) => id !== 'clearance' || 'clearance_mm' in CASES[0].columns).map(([id, name, value, more]) => {
    const [shownValue, shownMore] = [el('div.v', { id: `live-${id}` }, '–'), el('div.d')];
    const put = (/** @type {any} */ best) => {
      shownValue.textContent = best ? value(best) : '–';
      shownMore.textContent = best ? more(best) : '';
      // There is one line for it, which may be too short.
      shownMore.title = shownMore.textContent ?? '';
    };
    return { tile: el('div.tile', {}, el('div.k', {}, name), shownValue, shownMore), put };
  });
  const blocked = el('div.blocked', { id: 'live-blocked', role: 'status', hidden: true });
  const notes = el('details', { id: 'live-notes', hidden: true });
  const chips = el('ul.concerns', { id: 'concerns', 'aria-label': 'What the figures rest on' });
  const out = card('This placement', '', chips, el('div.tiles.live', {}, ...cells.map(({ tile }) => tile)), blocked, notes);
  /** @type {HTMLElement} */ (out.firstChild).append(state);
  let said = '';
  const list = (/** @type {string[]} */ lines) => el('ul', {}, ...lines.map((line) => el('li', {}, line)));
  onAnswer(() => {
    const { answer, isFeasible, reasons } = shown;
    const best = isFeasible ? answer?.document?.best : null;
    // While the part is followed, the last figures stay until there are new ones.
    if (best || !isFeasible) cells.forEach(({ put }) => put(best));
    state.textContent = stateWords();
    out.classList.toggle('following', shown.isFollowing);
    const known = concerns();
    chips.replaceChildren(...known.map(({ level, text }) => el('li', { 'data-level': level }, text)));
    for (const framed of [out, view()]) framed?.setAttribute('data-level', known[0]?.level ?? '');
    const isBlocked = !isFeasible && reasons.length > 0;
    view()?.classList.toggle('noplan', isBlocked);
    blocked.hidden = !isBlocked;
    const lines = [...(answer?.outside_cell ? [answer.outside_cell] : []), ...(isBlocked ? reasons : [])];
    if (isBlocked) blocked.replaceChildren(el('b', {}, 'No plan here'), list(lines));
    const warnings = answer?.document?.warnings ?? [];
    const all = [...warnings.map((/** @type {string} */ text) => `Warning: ${text}`), ...(isBlocked ? [] : lines), ...(answer?.document?.notes ?? [])];
    if (!shown.isWhole && isFeasible) return;
    if (all.join() === said) return;
    said = all.join();
    notes.hidden = all.length === 0;
    /** @type {any} */ (notes).open = warnings.length > 0;
    notes.replaceChildren(el('summary', {}, `${all.length} note${all.length === 1 ? '' : 's'} on what this rests on`), list(all));
  });
  return out;
}

/** The title, and what is at stake in a sentence. */
export function titleOf() {
  const { points, segments } = RAW.task;
  const what = `${RAW.robot.name} · ${points} path points, ${segments} segment${segments === 1 ? '' : 's'} · live`;
  return el('h1', {}, document.title.replace(/ · stead$/, ''), el('small', {}, what));
}
