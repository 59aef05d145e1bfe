// Colours: one logarithmic scale of deflections for everything; the path may have those of its forces.

import { viridis } from '../draw/theme.js';
import { CASES, REMOVAL } from './data.js';
import { size } from './linear.js';
/** @import { Case } from './data.js' */

/** The ends of the scale in mm: three decades, moved so that the largest score is within. @type {[number, number]} */
export const SCALE = (() => {
  const largest = CASES.reduce((most, of) => Math.max(most, of.max), 0);
  let high = 5;
  while (largest > high) high *= 10;
  while (largest < high / 50 && high > 5e-3) high /= 10;
  return [high / 1000, high];
})();

/** @param {number} mm @returns {number} from 0 to 1 along the scale */
const level = (mm) => Math.log(Math.max(Math.abs(mm), SCALE[0]) / SCALE[0]) / Math.log(SCALE[1] / SCALE[0]);

/** @param {number} mm */
export const colourOf = (mm) => viridis(level(mm));

/**
 * @typedef {{ name: string, ends: [string, string], at: (of: Case, i: number) => number, colour: (value: number) => number[] }} Colouring
 * what the path is coloured by: its name, the ends of its scale, the value at a point, and the colour of a value
 */

/** From nothing to the largest value. @param {string} name @param {number[]} values @param {string} unit @returns {Colouring} */
function evenly(name, values, unit) {
  const most = values.reduce((a, b) => Math.max(a, b), 0) || 1;
  const ends = /** @type {[string, string]} */ (['0', `${most.toPrecision(3)} ${unit}`]);
  return { name, ends, at: (_, i) => values[i], colour: (value) => viridis(value / most) };
}

/** @type {Colouring[]} the usual one first */
export const COLOURINGS = [
  { name: 'error', ends: [String(SCALE[0]), `${SCALE[1]} mm`], at: (of, i) => of.columns.score_mm[i], colour: colourOf },
  ...(REMOVAL
    ? [
        evenly('force', REMOVAL.force.map(size), 'N'),
        evenly('removed', Array.from(REMOVAL.columns.removed_mm3_per_mm), 'mm³/mm'),
      ]
    : []),
];

export const JOINT_COLOURS = ['--j1', '--j2', '--j3', '--j4', '--j5', '--j6'];
