// Where the frames of the arm are (Khalil and Dombre 2002: modified Denavit-Hartenberg rows).

import { clamp, mix } from '../draw/scale.js';
import { COUNT, RAW, ROWS } from './data.js';
import { IDENTITY, RADIANS, product } from './linear.js';
import { SEGMENT, isMove } from './path.js';
/** @import { Case, Way } from './data.js' */
/** @import { Mat, Vec } from './linear.js' */

/** A pose from a rotation by rows and a place. @param {number[][]} q @param {Vec} at @returns {Mat} */
export const poseOf = (q, at) => [
  ...[q[0][0], q[1][0], q[2][0], 0, q[0][1], q[1][1], q[2][1], 0],
  ...[q[0][2], q[1][2], q[2][2], 0, at[0], at[1], at[2], 1],
];

/** @type {Mat} tool frame to flange frame */
const FLANGE_FROM_TOOL = poseOf(RAW.spindle.rotation, RAW.spindle.xyz_mm);

/** The robot base frame on what carries it: the mount. @type {Mat} */
export const MOUNT = RAW.robot.mount ? poseOf(RAW.robot.mount.rotation, RAW.robot.mount.xyz_mm) : IDENTITY;

/** Frames 0 (base) to 6 (flange) and 7 (tool). @param {number[]} joints @param {Mat} base @returns {Mat[]} */
export function framesOf(joints, base = MOUNT) {
  const frames = [base];
  ROWS.forEach((row, k) => {
    const [theta, alpha] = [joints[k] * RADIANS, row.alpha * RADIANS];
    const [ct, st, ca, sa] = [Math.cos(theta), Math.sin(theta), Math.cos(alpha), Math.sin(alpha)];
    const step = [ct, st * ca, st * sa, 0, -st, ct * ca, ct * sa, 0, 0, -sa, ca, 0, row.a, -sa * row.d, ca * row.d, 1];
    frames.push(product(frames[k], step));
  });
  frames.push(product(frames[6], FLANGE_FROM_TOOL));
  return frames;
}

/** How much of a way from rest to rest is done at a share of its time. @param {number} f */
const smooth = (f) => f * f * (3 - 2 * f);

/** The number of the place that a move is at, at a share of its time; between two places in proportion. @param {Way} way @param {number} f */
function placeOn(way, f) {
  const part = way.parts.find(({ until }) => f < until) || way.parts[way.parts.length - 1];
  return part.first + part.steps * smooth(clamp((f - part.from) / (part.until - part.from || 1), 0, 1));
}

/** Rows in proportion to a number between two of theirs. @param {number[][]} rows @param {number} at */
function rowAt(rows, at) {
  const i = Math.min(Math.floor(at), rows.length - 1);
  return i === at ? rows[i] : mix(rows[i], rows[i + 1], at - i);
}

/**
 * What a plan has at a fractional path point; between segments it goes the way of its move, or smoothly straight over where that has none.
 * @param {Case} of @param {(i: number) => number[]} at @param {(way: Way) => number[][]} on @param {number} t
 */
export function between(of, at, on, t) {
  const i = Math.min(Math.floor(t), COUNT - 1);
  const f = t - i;
  if (!f) return at(i);
  if (!isMove(i)) return mix(at(i), at(i + 1), f);
  const way = of.ways[SEGMENT[i] - 1];
  return way ? rowAt(on(way), placeOn(way, f)) : mix(at(i), at(i + 1), smooth(f));
}

/** Joint angles at a fractional path point. @param {Case} of @param {number} t */
export const jointsAt = (of, t) => between(of, (i) => of.joints[i], (way) => way.joints, t);

/** How far the wrist centre reaches from the shoulder, and the shoulder's distance from axis 1 and height. */
export const REACH = {
  arm: Math.abs(ROWS[2].a) + Math.hypot(ROWS[3].a, ROWS[3].d),
  shoulder: Math.abs(ROWS[1].a),
  height: ROWS[0].d,
};
export const FARTHEST = REACH.arm + REACH.shoulder;
