// Colours: one logarithmic scale of deflections for everything.

import { viridis } from '../draw/theme.js';
import { CASES } from './data.js';

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

export const JOINT_COLOURS = ['--j1', '--j2', '--j3', '--j4', '--j5', '--j6'];
