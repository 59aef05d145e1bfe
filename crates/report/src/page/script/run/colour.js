// Colours: one logarithmic scale of deflections for everything; the path may have those of its forces.

import { rampOf } from '../draw/heat-map.js';
import { clamp, percentile, rounded } from '../draw/scale.js';
import { viridis } from '../draw/theme.js';
import { CASES, REMOVAL } from './data.js';
import { size } from './linear.js';
/** @import { Case } from './data.js' */

/**
 * The ends of the scale in mm, 1, 2 or 5 times a power of ten: what 98 of 100 points of all cases do not exceed, and one to three decades below
 * it what 98 of 100 reach.
 * @type {[number, number]}
 */
export const SCALE = (() => {
  const scores = CASES.flatMap((of) => Array.from(of.columns.score_mm));
  const high = rounded(percentile(scores, 0.98) || 1);
  return [rounded(clamp(percentile(scores, 0.02), high / 1000, high / 10), 'down'), high];
})();

/** The ticks of the scale: of few decades each round value, else one a decade. */
const MARKS = (() => {
  const [low, high] = SCALE;
  const isShort = high / low < 30;
  const marks = [high];
  for (let next = high; next > low; ) {
    next = isShort ? rounded(next * 0.99, 'down') : Math.max(low, +(next / 10).toPrecision(1));
    marks.unshift(next);
  }
  return marks;
})();

/** What the colours of deflections stand for. @param {number} [largest] of what is shown beside the path */
export const errorRamp = (largest = 0) =>
  rampOf({ label: 'mm', is_log: true, range: SCALE }, CASES.reduce((most, of) => Math.max(most, of.max), largest), MARKS);

/** @param {number} mm @returns {number} from 0 to 1 along the scale */
const level = (mm) => Math.log(Math.max(Math.abs(mm), SCALE[0]) / SCALE[0]) / Math.log(SCALE[1] / SCALE[0]);

/** @param {number} mm */
export const colourOf = (mm) => viridis(level(mm));

/**
 * @typedef {{ name: string, ramp: () => HTMLElement, at: (of: Case, i: number) => number, colour: (value: number) => number[] }} Colouring
 * what the path is coloured by: its name, its scale, the value at a point, and the colour of a value
 */

/** From nothing to what 98 of 100 values do not exceed. @param {string} name @param {number[]} values @param {string} unit @returns {Colouring} */
function evenly(name, values, unit) {
  const high = rounded(percentile(values, 0.98) || 1);
  const ramp = () => rampOf({ label: unit, is_log: false, range: [0, high] }, values.reduce((a, b) => Math.max(a, b || 0), 0));
  return { name, ramp, at: (_, i) => values[i], colour: (value) => viridis(value / high) };
}

/** @type {Colouring[]} the usual one first */
export const COLOURINGS = [
  { name: 'error', ramp: errorRamp, at: (of, i) => of.columns.score_mm[i], colour: colourOf },
  ...(REMOVAL
    ? [
        evenly('force', REMOVAL.force.map(size), 'N'),
        evenly('removed', Array.from(REMOVAL.columns.removed_mm3_per_mm), 'mm³/mm'),
      ]
    : []),
];

export const JOINT_COLOURS = ['--j1', '--j2', '--j3', '--j4', '--j5', '--j6'];
