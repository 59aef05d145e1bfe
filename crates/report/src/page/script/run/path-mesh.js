// The path as coloured tubes, and as a curtain where the tool goes in truth, its error drawn too large.

import { clamp } from '../draw/scale.js';
import { CASES, COUNT, RAW, REMOVAL, TASK } from './data.js';
import { inWorkpiece } from './external-axes.js';
import { add, dot, less, size, times, unit } from './linear.js';
import { lathe, mesh } from './mesh.js';
import { RUNS } from './path.js';
/** @import { Colouring } from './colour.js' */
/** @import { Case } from './data.js' */
/** @import { Vec } from './linear.js' */
/** @import { Mesh } from './mesh.js' */

/** The direction of the deflection that is scored. @type {string | null} */
export const DIRECTION = RAW.criterion.direction;

/** What the scored deflection spoils, in words. */
export const SCORED = { wall: 'wall', surface: 'surface', axis: 'floor' }[DIRECTION || ''] || 'tool';

/** The scored part of the deflection at a point, in the workpiece frame. @param {Case} of @param {number} i @returns {Vec} */
function errorAt(of, i) {
  const { deflection_x_mm: x, deflection_y_mm: y, deflection_z_mm: z } = of.columns;
  const whole = inWorkpiece(of, i, [x[i], y[i], z[i]]);
  if (TASK.scored.length > 1) return whole;
  const direction = unit(TASK.scored[0][i]);
  return times(direction, dot(direction, whole));
}

/** The extent of the path in the workpiece frame. */
export const EXTENT = [0, 1, 2].map((k) => {
  const values = TASK.position.map((position) => position[k]);
  return [values.reduce((a, b) => Math.min(a, b), Infinity), values.reduce((a, b) => Math.max(a, b), -Infinity)];
});
export const PATH_SIZE = Math.max(Math.hypot(...EXTENT.map(([low, high]) => high - low)), 50);

/** How many times too large errors can be drawn. */
export const FACTORS = [1, 2, 5, 10, 20, 50, 100, 200, 500, 1000, 2000, 5000];

/** That of them which suits the run, the same for all cases, by what 95 of 100 points stay below. */
export const MAGNIFIED = (() => {
  const high = CASES.map(({ columns }) => {
    const scores = columns.score_mm.slice().sort();
    return scores[Math.floor(0.95 * (scores.length - 1))];
  });
  return FACTORS.filter((factor) => factor <= 1000 && factor * Math.max(...high) < 0.6 * PATH_SIZE).pop() ?? 1;
})();

/** No more tubes than this: a longer path is drawn by every so many points. */
const MOST_TUBES = 1500;

/** Both in the workpiece frame. @param {Case} of @param {Colouring} by @param {number} magnified @returns {{ tube: Mesh, curtain: Mesh }} */
export function pathMeshes(of, by, magnified) {
  const [tube, curtain] = [mesh(), mesh()];
  const tips = TASK.position;
  const offs = tips.map((tip, i) => add(tip, times(errorAt(of, i), magnified)));
  // In a stock the path must not fill the cut.
  const radius = clamp(PATH_SIZE * 0.011, 2, 8) * (REMOVAL ? 0.35 : 1);
  const stride = Math.ceil(COUNT / MOST_TUBES);
  for (const [first, last] of RUNS) {
    for (let i = first; i < last; i += stride) {
      const next = Math.min(i + stride, last);
      const length = size(less(tips[next], tips[i]));
      const value = Math.max(by.at(of, i), by.at(of, next));
      if (length > 0) {
        // Of a long path the ends of its many tubes are not seen.
        const side = [
          [-2, radius],
          [length + 2, radius],
        ];
        const profile = /** @type {[number, number][]} */ (stride > 1 ? side : [[-2, 0], ...side, [length + 2, 0]]);
        lathe(tube, tips[i], tips[next], profile, stride > 1 ? 5 : 8, by.colour(value));
      }
      const base = curtain.p.length / 3;
      for (const k of [i, next]) {
        // As high as the tube: in the face of the part both would flicker.
        const lift = times(TASK.axis[k], radius);
        for (const corner of [tips[k], offs[k]]) {
          curtain.p.push(...add(corner, lift));
          curtain.n.push(0, 0, 1);
          curtain.c.push(...by.colour(by.at(of, k)));
        }
      }
      curtain.i.push(base, base + 1, base + 3, base, base + 3, base + 2);
    }
  }
  return { tube, curtain };
}
