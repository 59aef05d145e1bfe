// What pushes the tool and where it goes, as arrows along the path: forces, and deflections drawn too large.

import { clamp } from '../draw/scale.js';
import { CASES, COUNT, TASK } from './data.js';
import { inWorkpiece } from './external-axes.js';
import { add, cross, dot, less, size, times, unit } from './linear.js';
import { lathe, mesh } from './mesh.js';
import { PATH_SIZE } from './path-mesh.js';
import { RUNS } from './path.js';
/** @import { Case } from './data.js' */
/** @import { Vec } from './linear.js' */
/** @import { Mesh } from './mesh.js' */

/** No more arrows than this: a longer path has one at every so many points. */
const MOST_ARROWS = 100;
/** Length of the longest arrow of a force, over the size of the path. */
const LONGEST = 0.2;
const FORCE = [214, 72, 58];
const DEFLECTION = [34, 122, 181];

/** What the workpiece does to the tool, in the workpiece frame. N @param {Case} of @param {number} i @returns {Vec} */
export const forceAt = (of, i) =>
  inWorkpiece(of, i, [of.columns.force_x_n[i], of.columns.force_y_n[i], of.columns.force_z_n[i]]);

/** Its parts along the feed, to its left, and along the axis of the path. N @param {Case} of @param {number} i */
export function forceParts(of, i) {
  const axis = TASK.axis[i];
  const feed = unit(less(TASK.feed[i], times(axis, dot(axis, TASK.feed[i]))));
  return [feed, cross(axis, feed), axis].map((direction) => dot(forceAt(of, i), direction));
}

/** The whole deflection of the tool, in the workpiece frame. mm @param {Case} of @param {number} i @returns {Vec} */
export const deflectionAt = (of, i) =>
  inWorkpiece(of, i, [of.columns.deflection_x_mm[i], of.columns.deflection_y_mm[i], of.columns.deflection_z_mm[i]]);

/** Sizes of the forces at the drawn points, in N: the same in every case. */
export const FORCES = CASES[0].joints.map((_, i) => {
  const { force_x_n: x, force_y_n: y, force_z_n: z } = CASES[0].columns;
  return Math.hypot(x[i], y[i], z[i]);
});

/** The largest force of a drawn point, in N. */
export const LARGEST_FORCE = FORCES.reduce((a, b) => Math.max(a, b), 0);

/** Arrows from the tool centre point in the workpiece frame. @param {(i: number) => Vec} at @param {number} scale mm for a unit of what they stand for @param {number[]} colour @returns {Mesh} */
function arrowsOf(at, scale, colour) {
  const out = mesh();
  const thin = clamp(PATH_SIZE * 0.003, 0.5, 2.5);
  const stride = Math.ceil(COUNT / MOST_ARROWS);
  for (const [first, last] of RUNS) {
    for (let i = first; i <= last; i += stride) {
      const to = times(at(i), scale);
      const length = size(to);
      if (length < 4 * thin) continue;
      const neck = length - Math.min(8 * thin, length / 2);
      const profile = /** @type {[number, number][]} */ ([
        [0, thin],
        [neck, thin],
        [neck, 2.6 * thin],
        [length, 0],
      ]);
      lathe(out, TASK.position[i], add(TASK.position[i], to), profile, 8, colour);
    }
  }
  return out;
}

/** The forces of a case. @param {Case} of */
export const forceArrows = (of) =>
  arrowsOf((i) => forceAt(of, i), LARGEST_FORCE ? (LONGEST * PATH_SIZE) / LARGEST_FORCE : 0, FORCE);

/** Its deflections, so many times too large. @param {Case} of @param {number} magnified */
export const deflectionArrows = (of, magnified) => arrowsOf((i) => deflectionAt(of, i), magnified, DEFLECTION);
