// What each joint adds to the scored deflection by yielding about its axis.

import { forceAt } from './arrows.js';
import { CASES, FOLD, JOINED, ROWS, TASK } from './data.js';
import { axesAt, baseFrame, carriedBy, workpieceFrame } from './external-axes.js';
import { framesOf } from './kinematics.js';
import { add, cross, dot, less, times, turned } from './linear.js';
import { chosenState, current, currentPoint } from './state.js';
/** @import { Case } from './data.js' */
/** @import { Vec } from './linear.js' */

/** The compliance of a joint at an angle (deg), in proportion between those of its row. urad/(N m) @param {number} j @param {number} angle */
function complianceAt(j, angle) {
  const { min, max, compliance } = ROWS[j];
  const at = Math.min(1, Math.max(0, (angle - min) / (max - min))) * (compliance.length - 1);
  const k = Math.min(Math.floor(at), Math.max(0, compliance.length - 2));
  return compliance[k] + (at - k) * ((compliance[k + 1] ?? compliance[k]) - compliance[k]);
}

/** How far each joint moves the tool under the load of a point, in the cell. mm @param {Case} of @param {number} i @param {number[]} joints @returns {Vec[]} */
function movedByJoint(of, i, joints) {
  const frames = framesOf(joints, baseFrame(of, i));
  const part = workpieceFrame(of, i);
  const [force, moment] = [turned(part, forceAt(of, i)), turned(part, TASK.moment?.[i] ?? [0, 0, 0])];
  const tip = frames[7].slice(12, 15);
  const twists = ROWS.map((_, j) => {
    const frame = frames[j + 1];
    const axis = frame.slice(8, 11);
    return { axis, lever: cross(axis, less(tip, frame.slice(12, 15))) };
  });
  if (JOINED?.linkage) {
    // The spring of joint 2 leaves the forearm its direction.
    const [second, third] = [twists[1], twists[2]];
    twists[1] = { axis: [0, 0, 0], lever: less(second.lever, times(third.lever, FOLD)) };
  }
  return twists.map(({ axis, lever }, j) => {
    const torque = dot(lever, force) / 1000 + dot(axis, moment);
    return times(lever, torque * complianceAt(j, joints[j]) * 1e-6);
  });
}

/** The direction in the cell along which the scored part of a deflection grows fastest. @param {Case} of @param {number} i @param {Vec} whole the deflection in the cell @returns {Vec} */
function scoredDirection(of, i, whole) {
  const part = workpieceFrame(of, i);
  /** @type {Vec[]} */
  const directions = TASK.scored.map((/** @type {Vec[]} */ list) => turned(part, list[i]));
  const along = directions.map((direction) => dot(direction, whole));
  const scored = Math.hypot(...along) || 1;
  return directions.reduce((sum, direction, k) => add(sum, times(direction, along[k] / scored)), [0, 0, 0]);
}

/** What each joint adds to the scored part of the deflection; one below 0 takes from the others. mm @param {Case} of @param {number} i @param {number[]} joints @param {Vec} [whole] the deflection in the cell, where more yields than the joints */
function byJoint(of, i, joints, whole) {
  const moved = movedByJoint(of, i, joints);
  const direction = scoredDirection(of, i, whole ?? moved.reduce(add));
  return moved.map((one) => dot(one, direction));
}

/** The same at a point of a plan. @param {Case} of @param {number} i */
export function byJointOnPlan(of, i) {
  const { deflection_x_mm: x, deflection_y_mm: y, deflection_z_mm: z } = of.columns;
  return byJoint(of, i, of.joints[i], turned(carriedBy('robot', axesAt(of, i)), [x[i], y[i], z[i]]));
}

/** Whether more yields than the joints about their axes. */
export const HAS_OTHERS = CASES.some((of) => of.entry.by_origin_mm);

/** Where more yields than the joints about their axes, what that adds at a point of a plan. mm @param {Case} of @param {number} i */
export const besideJoints = (of, i) =>
  ['normal', 'base', 'mount', 'tip', 'part'].reduce((sum, name) => sum + (of.columns[`from_${name}_mm`]?.[i] ?? 0), 0);

/** What each joint adds at what is shown: the state chosen in the map, or the point of the plan; nothing for a state that is not allowed. @returns {number[] | null} */
export function byJointHere() {
  const [of, i, chosen] = [current(), currentPoint(), chosenState()];
  if (!chosen) return byJointOnPlan(of, i);
  return chosen.isAllowed ? byJoint(of, i, chosen.joints) : null;
}
