// Where the scored deflection comes from, where more yields than the joints about their axes: by case, and along the path.

import { legendOf } from '../draw/chart.js';
import { card, el } from '../draw/dom.js';
import { fixed } from '../draw/scale.js';
import { alongPath } from './charts.js';
import { CASES, SHORT_NAMES } from './data.js';
import { smallTable } from './small-table.js';
import { current, onChange, state } from './state.js';
/** @import { Series } from '../draw/chart-data.js' */
/** @import { Case } from './data.js' */

/** What can yield: its words, its name in the files, its colour. */
const ORIGINS = [
  ['joints about their axes', 'axes', '--accent'],
  ['normal to them', 'normal', '--j3'],
  ['base', 'base', '--j2'],
  ['mount of the spindle', 'mount', '--j4'],
  ['holder and tool', 'tip', '--j5'],
  ['part', 'part', '--j6'],
];

/** What each adds in the mean of a case. mm @param {Case} of @param {string} name @returns {number} */
const adds = (of, name) => of.entry.by_origin_mm[`${name}_mm`];

/** The size of the scored part in the mean of a case. mm @param {Case} of */
const sum = (of) => ORIGINS.reduce((all, [, name]) => all + adds(of, name), 0);

/** @returns {HTMLElement | null} where the run knows more than joints about their axes */
export function originsCard() {
  const known = CASES.filter((of) => of.entry.by_origin_mm);
  if (!known.length) return null;
  const there = ORIGINS.filter(([, name]) => known.some((of) => adds(of, name) !== 0));
  const share = (/** @type {Case} */ of, /** @type {number} */ mm) =>
    `${fixed(mm, 4)} (${fixed(sum(of) > 0 ? (mm / sum(of)) * 100 : 0, 0)} %)`;
  const rows = known.map((of) => [
    SHORT_NAMES[of.number - 1],
    fixed(sum(of), 4),
    ...there.map(([, name]) => share(of, adds(of, name))),
  ]);
  const parts = [smallTable(['Mean in mm', 'Scored part', ...there.map(([words]) => words)], rows)];
  if (there.some(([, name]) => name === 'normal')) {
    const byJoint = known.map((of) => [
      SHORT_NAMES[of.number - 1],
      ...of.entry.by_origin_mm.normal_by_joint_mm.map((/** @type {number} */ mm) => fixed(mm, 4)),
    ]);
    parts.push(smallTable(['Normal to the axes, mm', 'A1', 'A2', 'A3', 'A4', 'A5', 'A6'], byJoint));
  }
  /** @returns {Series[]} */
  const series = () =>
    there.map(([words, name, color]) => ({
      name: words,
      style: 'line',
      y: Array.from(current().columns[`from_${name}_mm`]),
      color,
      width: 2,
    }));
  const make = () => {
    const values = series().flatMap(({ y }) => Array.from(y, (value) => value ?? NaN)).filter(Number.isFinite);
    const [least, most] = values.reduce(([a, b], value) => [Math.min(a, value), Math.max(b, value)], [0, 0]);
    const range = /** @type {[number, number]} */ ([least, most > least ? most + 0.05 * (most - least) : least + 1]);
    return { y: { label: 'mm', is_log: false, range }, series: series() };
  };
  const chart = alongPath('What yields', make, { digits: 4, chosen: () => (state.chosen ? [NaN] : null) });
  const out = card('Where the deflection comes from', '', chart.host, el('div.legend', {}, ...legendOf(series())), ...parts);
  const words = /** @type {HTMLElement} */ (out.querySelector('.sub'));
  onChange(() => {
    const of = current();
    const all = there.map(([name, key]) => `${name} ${fixed(adds(of, key), 4)}`).join(', ');
    words.textContent = `of ${fixed(sum(of), 4)} mm in the mean: ${all}`;
  });
  return out;
}
