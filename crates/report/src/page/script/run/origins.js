// Where the scored deflection comes from: joint by joint where the tool is, and where more yields than the joints about their axes, by case
// and along the path.

import { legendOf } from '../draw/chart.js';
import { card, el } from '../draw/dom.js';
import { giving } from '../draw/downloads.js';
import { fixed } from '../draw/scale.js';
import { alongPath } from './charts.js';
import { JOINT_COLOURS } from './colour.js';
import { CASES, ROWS, SHORT_NAMES } from './data.js';
import { pathPoint } from './path.js';
import { smallTable } from './small-table.js';
import { chosenState, current, currentPoint, onChange, state } from './state.js';
import { HAS_OTHERS, besideJoints, byJointHere } from './yielding.js';
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

/** What each joint gives of the deflection where the tool is, or at the state that is chosen in the map: a bar each. */
export function jointSharesCard() {
  const rows = [...ROWS.map((_, j) => [`A${j + 1}`, JOINT_COLOURS[j]]), ...(HAS_OTHERS ? [['other', '--soft']] : [])].map(([name, colour]) => {
    const [bar, value] = [el('div.rng'), el('b')];
    bar.style.background = `var(${colour})`;
    bar.style.opacity = '1';
    return { bar, value, host: el('div.g', {}, el('b', {}, name), el('div.rail', {}, bar), value) };
  });
  const out = card('Which joint yields', '', el('div.gauges.shares', {}, ...rows.map(({ host }) => host)));
  const words = /** @type {HTMLElement} */ (out.querySelector('.sub'));
  onChange(() => {
    const [chosen, here] = [chosenState(), byJointHere()];
    const where = chosen ? `point ${chosen.point}, β ${fixed(chosen.beta, 1)}°` : `point ${pathPoint(currentPoint())}`;
    if (!here) {
      words.textContent = `${where}: the chosen state is not allowed`;
      rows.forEach(({ bar, value }) => {
        bar.style.width = '0';
        value.textContent = '–';
      });
      return;
    }
    const others = HAS_OTHERS && !chosen ? [besideJoints(current(), currentPoint())] : [];
    const parts = [...here, ...others];
    const all = parts.reduce((a, b) => a + b, 0);
    const about = HAS_OTHERS && chosen ? 'by the joints about their axes alone' : 'of the scored part';
    words.textContent = `${where}: ${fixed(all, 4)} mm ${about}; a minus takes from the others`;
    // Zero in the middle as soon as something takes from the others.
    const [low, high] = [Math.min(0, ...parts), Math.max(0, ...parts)];
    const span = high - low || 1;
    rows.forEach(({ bar, value }, k) => {
      const part = parts[k];
      if (part === undefined) {
        bar.style.width = '0';
        value.textContent = 'along plans only';
        return;
      }
      bar.style.left = `${((Math.min(part, 0) - low) / span) * 100}%`;
      bar.style.width = `${(Math.abs(part) / span) * 100}%`;
      value.textContent = `${fixed(part, 4)} mm, ${fixed(all ? (part / all) * 100 : 0, 0)} %`;
    });
  });
  const figures = () => (byJointHere() ?? []).map((part, j) => [`A${j + 1}`, part]);
  return giving(out, { rows: () => [['joint', 'of the scored part (mm)'], ...figures()] });
}

/** @returns {HTMLElement | null} where the run knows more than joints about their axes */
export function originsCard() {
  if (!HAS_OTHERS) return null;
  const known = CASES.filter((of) => of.entry.by_origin_mm);
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
