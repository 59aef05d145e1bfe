// External axes as they are drawn where nothing is known of their looks: rails, shafts and platters. Illustrations.

import { CASES } from './data.js';
import { AXES, axesAt, carriedBy, workpieceFrame } from './external-axes.js';
import { FARTHEST, MOUNT } from './kinematics.js';
import { add, dot, inverseOf, less, moved, product, times } from './linear.js';
import { across, lathe, mesh, tubes } from './mesh.js';
import { EXTENT } from './path-mesh.js';
import { FLOOR, blockBox, edgesOf } from './surroundings.js';
/** @import { Case } from './data.js' */
/** @import { Vec } from './linear.js' */
/** @import { Mesh } from './mesh.js' */

const STEEL = [122, 132, 144];
const DARK_STEEL = [74, 82, 94];

/** How far a platter or a shaft goes to each side. */
const PLATTER = Math.max(0.62 * Math.hypot(EXTENT[0][1] - EXTENT[0][0], EXTENT[1][1] - EXTENT[1][0]), 0.08 * FARTHEST);

/** The middle of the underside of the work as a plan places it, with all axes at zero. @param {Case} of @returns {Vec} */
function undersideOf(of) {
  const [low, high] = blockBox();
  const part = product(inverseOf(carriedBy('workpiece', axesAt(of, 0))), workpieceFrame(of, 0));
  const corners = edgesOf(low, high).map((corner) => moved(part, corner));
  const lowest = corners.reduce((least, corner) => Math.min(least, corner[2]), Infinity);
  const middle = moved(part, times(add(low, high), 0.5));
  return [middle[0], middle[1], lowest];
}

/** What an axis moves on, where the axes before it have brought it. @param {number} k @returns {Mesh} */
export function axisTrack(k) {
  const axis = AXES[k];
  const thick = FARTHEST * 0.016;
  const under = undersideOf(CASES[0]);
  if (axis.isRail) {
    const foot = axis.carries === 'robot' ? [MOUNT[12], MOUNT[13], FLOOR] : [under[0], under[1], under[2]];
    const aside = times(across(axis.direction)[0], axis.carries === 'robot' ? FARTHEST * 0.13 : PLATTER * 0.7);
    const [from, to] = axis.range.map((at, end) => add(foot, times(axis.direction, at + (end ? 1 : -1) * FARTHEST * 0.16)));
    return tubes([add(from, aside), add(to, aside), less(from, aside), less(to, aside)], thick, DARK_STEEL);
  }
  const middle = add(axis.point, times(axis.direction, dot(less(under, axis.point), axis.direction)));
  const half = times(axis.direction, isPlatter(k) ? FARTHEST * 0.06 : PLATTER * 1.15);
  const ends = isPlatter(k) ? [less(middle, half), middle] : [less(middle, half), add(middle, half)];
  return tubes(ends, 1.4 * thick, DARK_STEEL);
}

/** Whether the work stands on an axis itself, and turns with it. @param {number} k */
const isPlatter = (k) => AXES[k].carries === 'workpiece' && !AXES[k].isRail && !AXES.slice(k + 1).some((axis) => axis.carries === 'workpiece');

/** The disc that the work stands on, in the frame that its axis moves; nothing on other axes. @param {Case} of @param {number} k @returns {Mesh} */
export function platter(of, k) {
  const out = mesh();
  if (!isPlatter(k)) return out;
  const { point, direction } = AXES[k];
  const under = undersideOf(of);
  const top = add(point, times(direction, dot(less(under, point), direction)));
  const thick = FARTHEST * 0.012;
  const from = less(top, times(direction, thick));
  const profile = /** @type {[number, number][]} */ ([[0, 0], [0, PLATTER], [thick, PLATTER], [thick, 0]]);
  lathe(out, from, top, profile, 48, STEEL);
  return out;
}
