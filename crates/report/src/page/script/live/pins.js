// The placements that are kept, and two of them side by side.

import { card, el } from '../draw/dom.js';
import { fixed } from '../draw/scale.js';
import { CASES, RAW } from '../run/data.js';
import { set, state } from '../run/state.js';
import { dropCompared, putAnswer } from './answers.js';
import { onAnswer, shown } from './follow.js';
import { begin, onState, tried } from './jobs.js';
import { goTo, placeOf } from './place.js';
import { ask, keptFile } from './server.js';
import { keptOver } from './tab.js';

/** @type {any[]} */
let pins = [];

const nameOf = (/** @type {any} */ pin) => (pin.label ? `${pin.name} · ${pin.label}` : pin.name);

/** Rows of the comparison: names, values and digits. @type {[string, (of: any) => number | null | undefined, number, string][]} */
const ROWS = [
  ['Mean', (of) => of.best?.mean_mm, 4, 'mm'],
  ['Largest', (of) => of.best?.max_mm, 4, 'mm'],
  ['Whole, mean', (of) => of.best?.deflection_mm.total.mean, 4, 'mm'],
  ['Whole, largest', (of) => of.best?.deflection_mm.total.max, 4, 'mm'],
  ['Clearance', (of) => of.best?.clearance?.distance_mm, 1, 'mm'],
  ['Highest feed', (of) => of.best?.feed.highest_mm_per_s, 0, 'mm/s'],
  ['Joint travel', (of) => of.best?.joint_travel.total_deg, 0, '°'],
  ['Cycle', (of) => of.best?.cycle_s, 1, 's'],
  ['x', (of) => of.placement_exact?.x_mm, 1, 'mm'],
  ['y', (of) => of.placement_exact?.y_mm, 1, 'mm'],
  ['z', (of) => of.placement_exact?.z_mm, 1, 'mm'],
  ['yaw', (of) => of.placement_exact?.yaw_deg, 2, '°'],
];

/** What stands at a side: the name of a pin, or nothing for the placement that is moved. */
/** @type {{ a: string, b: string }} */
const sides = keptOver('sides', () => sides) ?? { a: '', b: '' };

/** @param {string} name @returns {any} */
const figuresOf = (name) => (name ? pins.find((pin) => pin.name === name) : shown.isFeasible && shown.answer?.document) || {};

/** The pin at the second side is seen as the other placement. */
async function drawCompared() {
  const pin = pins.find((one) => one.name === sides.b);
  const answer = pin && (await tried(() => ask('/preview', { ...placeOf(pin), id: 0, page: `compared ${pin.name}` })));
  if (!answer?.feasible) {
    if (state.case > 1) set({ case: 0 });
    dropCompared();
  } else putAnswer(answer, 1, nameOf(pin));
  set({ renewed: true });
}

/** The card with both. */
export function pinsCard() {
  const list = el('div.scroll', { tabindex: 0, role: 'group', 'aria-label': 'Pinned placements' });
  const rows = ROWS.map(([name, , , unit]) => ({ name, unit, cells: [el('td'), el('td'), el('td')] }));
  const pick = (/** @type {'a' | 'b'} */ side, /** @type {string} */ label) => {
    const select = /** @type {HTMLSelectElement} */ (el('select', { id: `side-${side}`, 'aria-label': label }));
    select.addEventListener('change', () => {
      sides[side] = select.value;
      compare();
      if (side === 'b') void drawCompared();
    });
    return select;
  };
  const selects = { a: pick('a', 'First placement'), b: pick('b', 'Second placement, seen as the other one') };
  const head = el('thead', {}, el('tr', {}, el('th.words', { scope: 'col' }, 'Figure'), el('th', { scope: 'col' }, selects.a), el('th', { scope: 'col' }, selects.b), el('th', { scope: 'col' }, 'difference')));
  const body = el('tbody', {}, ...rows.map(({ name, cells }) => el('tr', {}, el('th.words', { scope: 'row' }, name), ...cells)));
  const table = el('table', { id: 'comparison' }, el('caption.sr', {}, 'Two placements side by side'), head, body);
  const comparison = el('div.scroll', { tabindex: 0, role: 'group', 'aria-label': 'Comparison', hidden: true }, table);
  const compare = () => {
    const [a, b] = [figuresOf(sides.a), figuresOf(sides.b)];
    ROWS.forEach(([, value, digits, unit], k) => {
      const [left, right] = [value(a), value(b)];
      const text = (/** @type {number | null | undefined} */ one) => (typeof one === 'number' ? `${fixed(one, digits)} ${unit}` : '–');
      const by = typeof left === 'number' && typeof right === 'number' ? right - left : null;
      const sign = by !== null && by > 0 ? '+' : '';
      rows[k].cells.forEach((cell, column) => (cell.textContent = column === 2 ? (by === null ? '–' : sign + text(by)) : text(column ? right : left)));
    });
  };
  const refill = () => {
    for (const side of /** @type {const} */ (['a', 'b'])) {
      if (!pins.some((pin) => pin.name === sides[side])) sides[side] = '';
      const options = [{ name: '', shown: 'this placement' }, ...pins.map((pin) => ({ name: pin.name, shown: nameOf(pin) }))];
      selects[side].replaceChildren(...options.map(({ name, shown: text }) => el('option', { value: name, selected: name === sides[side] }, text)));
    }
  };
  onState((now) => {
    if (now.pins.length === pins.length && list.childElementCount) return;
    const isFirst = !list.childElementCount;
    const isNew = now.pins.length > pins.length && !isFirst;
    pins = now.pins;
    list.replaceChildren(pinTable());
    if (isNew) sides.b = pins[pins.length - 1].name;
    refill();
    compare();
    comparison.hidden = !pins.length;
    if (isNew || (isFirst && sides.b)) void drawCompared();
  });
  onAnswer(compare);
  return card('Pinned placements', "each a folder as 'stead score --out' writes it", list, comparison);
}

/** @returns {HTMLElement} */
function pinTable() {
  if (!pins.length) return el('p.sub.none-yet', {}, 'Nothing is pinned yet: Pin this placement, or search.');
  const link = (/** @type {any} */ pin, /** @type {string} */ file, /** @type {string} */ text) =>
    el('a', { href: keptFile(pin.name, file), target: '_blank', rel: 'noopener' }, text);
  const rows = pins.map((pin) =>
    el(
      'tr',
      {},
      el('td.words', {}, nameOf(pin)),
      el('td', {}, `${fixed(pin.best?.mean_mm, 4)} mm`),
      el(
        'td.words',
        {},
        el('button.chip', { type: 'button', onclick: () => goTo(placeOf(pin)) }, 'Go there'),
        ' ',
        ...(RAW.live.has_page ? [link(pin, 'setup.svg', 'Setup sheet'), ' ', link(pin, 'report.html', 'Page'), ' '] : []),
        exportButton(pin),
      ),
    ),
  );
  return el('table', { id: 'pins' }, el('caption.sr', {}, 'Pinned placements'), el('tbody', {}, ...rows));
}

/** @param {any} pin */
function exportButton(pin) {
  const format = el('select', { 'aria-label': `Program of ${pin.name}` }, ...['krl', 'rapid', 'fanuc', 'csv'].map((one) => el('option', { value: one }, one)));
  const start = () => void begin('export', { pin: pin.name, format: /** @type {HTMLSelectElement} */ (format).value, name: 'PART' });
  return el('span', {}, format, ' ', el('button.chip', { type: 'button', onclick: start }, 'Export'));
}

/** Whether the other placement is drawn. */
export const isCompared = () => CASES.length > 2;
