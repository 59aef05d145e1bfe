// The charts along the path: deflection by direction, joints within their limits, conditioning, and clearance where it is known.

import { chartPlot } from '../draw/chart.js';
import { card, choice, el } from '../draw/dom.js';
import { fixed } from '../draw/scale.js';
import { JOINT_COLOURS, SCALE } from './colour.js';
import { CASES, COUNT, ENDS, JOINT_NAMES, LIMITS, ROWS } from './data.js';
import { DIRECTION, SCORED } from './path-mesh.js';
import { RUNS, pathPoint } from './path.js';
import { pause } from './play.js';
import { chosenState, current, currentPoint, onChange, set, state } from './state.js';
/** @import { Reading } from '../draw/chart.js' */
/** @import { Axis, Chart, Mark, Series } from '../draw/chart-data.js' */
/** @import { Case, Numbers, Room } from './data.js' */

/** Deflections to choose from: words and columns. @type {[string, string][]} */
const DEFLECTIONS = /** @type {[string, string][]} */ ([
  ['wall', 'normal_mm'],
  ['surface', 'surface_mm'],
  ['axis', 'axial_mm'],
  ['total', 'total_mm'],
]).filter(([, column]) => column in CASES[0].columns);
let deflection = Math.max(
  0,
  DEFLECTIONS.findIndex(([name]) => name === DIRECTION),
);

/** Says in the words of a card what its chart marks of a state that is chosen in the map. @param {HTMLElement} out @param {string} usual @param {() => string} told */
function sayChosen(out, usual, told) {
  const words = /** @type {HTMLElement} */ (out.querySelector('.sub'));
  onChange(() => {
    const chosen = chosenState();
    words.textContent = !chosen ? usual : `${usual}; ${chosen.isAllowed ? told() : 'the chosen state is not allowed'}`;
  });
  return out;
}

/** Of a state chosen in the map nothing is marked where only the plans have it. */
const notOfChosen = () => (state.chosen ? [NaN] : null);

/** The path points by their numbers. @type {Axis} */
const POINTS = {
  label: 'point',
  is_log: false,
  names: Array.from({ length: COUNT }, (_, i) => String(pathPoint(i))),
  range: [0, Math.max(1, COUNT - 1)],
};

/** Where a segment ends and the next begins. @type {Mark[]} */
const BREAKS = RUNS.slice(1).map(([first]) => ({ is_level: false, at: first - 0.5, label: '', kind: 'break' }));

/**
 * A chart along the path, which moves the tool when it is pointed to.
 * @param {string} label @param {() => Pick<Chart, 'y' | 'series' | 'marks'>} make @param {Partial<Reading>} reading
 */
export function alongPath(label, make, reading = {}) {
  const host = el('div.plot');
  const chart = () => {
    const { y, series, marks = [] } = make();
    return { title: `${label} along the path`, detail: '', x: POINTS, y, series, marks: [...BREAKS, ...marks] };
  };
  const onPoint = (/** @type {number} */ t) => {
    pause();
    set({ t });
  };
  const plot = chartPlot(host, chart, { at: () => state.t, onPoint, ...reading });
  onChange(({ case: isOther }) => (isOther ? plot.refresh() : plot.over()));
  return { host, refresh: () => plot.refresh() };
}

/** @param {number} at @returns {Mark} */
export const limitAt = (at) => ({ is_level: true, at, label: '', kind: 'limit' });

/** The case with the same plan at the other placement, and that with the other plan here. @returns {[Case | undefined, Case]} */
function beside() {
  const of = current();
  const find = (/** @type {number} */ place, /** @type {number} */ plan) =>
    CASES.find((one) => one.place === place && one.plan === plan);
  return [find(1 - of.place, of.plan), /** @type {Case} */ (find(of.place, 1 - of.plan))];
}

/** This case and those beside it as series. @param {(of: Case) => Numbers} column @param {boolean} withPlan */
function seriesBeside(column, withPlan) {
  const [there, other] = beside();
  /** @type {Series[]} */
  const series = [];
  if (there) series.push({ name: 'other placement', y: column(there), color: '--soft', width: 1, style: 'dashed' });
  const [own, otherPlan] = current().plan ? ['--bad', '--good'] : ['--good', '--bad'];
  if (withPlan) series.push({ name: 'other plan', y: column(other), color: otherPlan, width: 1, style: 'dashed' });
  series.push({ name: 'this case', y: column(current()), color: withPlan ? own : '--accent', width: 2.2, style: 'line' });
  return series;
}

function deflectionCard() {
  const absolute = (/** @type {Case} */ of) =>
    of.columns[DEFLECTIONS[deflection][1]].map((mm) => Math.max(Math.abs(mm), SCALE[0] / 100));
  const isScored = () => DEFLECTIONS[deflection][0] === DIRECTION;
  const make = () => {
    const most = CASES.reduce((sum, of) => absolute(of).reduce((a, b) => Math.max(a, b), sum), 0);
    const range = /** @type {[number, number]} */ ([Math.min(SCALE[0], most / 100), Math.max(SCALE[1], most)]);
    const column = (/** @type {Case} */ of) => absolute(of).map((mm) => Math.max(mm, range[0]));
    return { y: { label: 'mm', is_log: true, range }, series: seriesBeside(column, true) };
  };
  const chart = alongPath('Deflection', make, {
    digits: 4,
    chosen: () => {
      const chosen = chosenState();
      if (!chosen) return null;
      return [chosen.isAllowed && isScored() ? Math.max(chosen.score, SCALE[0] / 100) : NaN];
    },
  });
  const parts = choice(
    'Direction of the deflection',
    DEFLECTIONS.map(([name]) => name),
    () => deflection,
    (k) => {
      deflection = k;
      chart.refresh();
      set({});
    },
    onChange,
  );
  const told = () => (isScored() ? `dot: ${SCORED} error of the chosen state` : 'of the chosen state the scored error alone is known');
  const out = sayChosen(card('Deflection', '', chart.host), 'mm, logarithmic', told);
  /** @type {HTMLElement} */ (out.firstChild).append(parts);
  return out;
}

/** An angle of the row of a joint in % of its range, from the end that its name calls the lower one. @param {number} j @param {number} angle */
const share = (j, angle) => ((angle - ENDS[j][0]) / (ENDS[j][1] - ENDS[j][0])) * 100;

function jointsCard() {
  /** @returns {Series[]} */
  const series = () =>
    ROWS.map((_, j) => ({
      name: JOINT_NAMES[j],
      style: 'line',
      y: current().joints.map((angles) => share(j, angles[j])),
      color: JOINT_COLOURS[j],
    }));
  const make = () => ({ y: { label: '%', is_log: false, range: /** @type {[number, number]} */ ([0, 100]) }, series: series() });
  const chart = alongPath('Joints', make, {
    digits: 0,
    hasNames: true,
    chosen: () => {
      const chosen = chosenState();
      return chosen && chosen.joints.map((angle, j) => share(j, angle));
    },
  });
  return sayChosen(card('Joints within their limits', '', chart.host), '% of range', () => 'dots: the chosen state');
}

/** A column of this case and of the other placement, from nothing up. @param {string} label @param {(one: Case) => Float32Array} of @param {number} least what is within in any case @param {(most: number) => number} end @param {Mark[]} marks @param {number} digits */
function columnChart(label, of, least, end, marks, digits) {
  const most = CASES.reduce((sum, one) => of(one).reduce((a, b) => (b > a ? b : a), sum), least);
  const y = { label, is_log: false, range: /** @type {[number, number]} */ ([0, end(most)]) };
  return alongPath(label, () => ({ y, series: seriesBeside(of, false), marks }), { chosen: notOfChosen, digits });
}

function conditioningCard() {
  const limit = LIMITS.inverse;
  const upToTenths = (/** @type {number} */ most) => Math.ceil(most * 10) / 10;
  const chart = columnChart('Conditioning', (one) => one.columns.inverse_condition, limit, upToTenths, [limitAt(limit)], 3);
  return sayChosen(card('Conditioning 1/κ', '', chart.host), `limit ${limit}`, () => 'along plans only');
}

/** @returns {HTMLElement | null} where the run knows clearances */
function clearanceCard() {
  if (!CASES[0].room) return null;
  const roomOf = (/** @type {Case} */ one) => /** @type {Room} */ (one.room);
  const chart = columnChart('Clearance', (one) => roomOf(one).distance, 1, (most) => most, [], 1);
  const out = card('Clearance', '', chart.host);
  const words = /** @type {HTMLElement} */ (out.querySelector('.sub'));
  onChange(() => {
    if (state.chosen) return void (words.textContent = 'mm; along plans only');
    const { distance, pair, still } = roomOf(current());
    const clearance = distance[currentPoint()];
    const here = Number.isFinite(clearance) ? `here ${fixed(clearance, 1)}: ${pair(currentPoint())}` : 'here nothing within 1 m';
    words.textContent = ['mm', here, still.length ? `left out, the same all along: ${still.join(', ')}` : ''].filter(Boolean).join('; ');
  });
  return out;
}

export const chartCards = () =>
  el('div.charts', {}, deflectionCard(), jointsCard(), conditioningCard(), clearanceCard());
