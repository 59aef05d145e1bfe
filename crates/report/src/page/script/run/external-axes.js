// External axes: rails and turntables that carry the robot or the part, and where they have brought what stands on them.

import { CASES, RAW, TASK } from './data.js';
import { MOUNT, between, framesOf, poseOf } from './kinematics.js';
import { IDENTITY, RADIANS, dot, less, moved, product, times, turned } from './linear.js';
/** @import { Case } from './data.js' */
/** @import { Mat, Vec } from './linear.js' */

/**
 * @typedef {{
 *   name: string, isRail: boolean, column: string, carries: 'robot' | 'workpiece', direction: Vec, point: Vec, range: [number, number]
 * }} ExternalAxis direction and point in the cell, with all axes at zero
 */

/** @type {ExternalAxis[]} those that carry the same thing stand on each other in this order, the first one on the floor */
export const AXES = (RAW.external_axes || []).map((/** @type {any} */ axis) => ({
  name: axis.name,
  isRail: axis.kind === 'rail',
  column: axis.column,
  carries: axis.carries,
  direction: axis.direction,
  point: axis.point_mm,
  range: axis.range,
}));

/** A turn about a line. @param {Vec} direction of length 1 @param {Vec} point @param {number} degrees @returns {Mat} */
function turnAbout(direction, point, degrees) {
  const [x, y, z] = direction;
  const [c, s] = [Math.cos(degrees * RADIANS), Math.sin(degrees * RADIANS)];
  const v = 1 - c;
  const turn = [
    ...[x * x * v + c, x * y * v + z * s, x * z * v - y * s, 0, x * y * v - z * s, y * y * v + c, y * z * v + x * s, 0],
    ...[x * z * v + y * s, y * z * v - x * s, z * z * v + c, 0, 0, 0, 0, 1],
  ];
  const kept = less(point, turned(turn, point));
  return [...turn.slice(0, 12), kept[0], kept[1], kept[2], 1];
}

/** What an axis does to what it carries. @param {ExternalAxis} axis @param {number} at mm or deg @returns {Mat} */
const axisMotion = (axis, at) =>
  axis.isRail
    ? [...IDENTITY.slice(0, 12), ...times(axis.direction, at), 1]
    : turnAbout(axis.direction, axis.point, at);

/** Positions of the axes at a fractional path point. @param {Case} of @param {number} t */
export const axesAt = (of, t) => between(of, (i) => AXES.map((axis) => of.columns[axis.column][i]), (way) => way.axes, t);

/** Where the first `count` axes have brought what they carry, in the cell. @param {string} what @param {number[]} at @param {number} count @returns {Mat} */
export const carriedBy = (what, at, count = AXES.length) =>
  AXES.slice(0, count).reduce((pose, axis, k) => (axis.carries === what ? product(pose, axisMotion(axis, at[k])) : pose), IDENTITY);

/** What an axis moves, in the cell. @param {number} k @param {number[]} at @returns {Mat} */
export const axisFrame = (k, at) => carriedBy(AXES[k].carries, at, k + 1);

/** The robot base frame in the cell at a path point. @param {Case} of @param {number} t @returns {Mat} */
export const baseFrame = (of, t) => product(carriedBy('robot', axesAt(of, t)), MOUNT);

/** How the part is turned before it is placed, for each plan. @type {Mat[] | null} */
export const PART_TURNS = RAW.part_turns && RAW.part_turns.map((/** @type {number[][]} */ rotation) => poseOf(rotation, [0, 0, 0]));

/** The workpiece frame in the cell at a path point. @param {Case} of @param {number} t @returns {Mat} */
export function workpieceFrame(of, t) {
  const { x, y, z, yaw } = of.at;
  const [c, s] = [Math.cos(yaw * RADIANS), Math.sin(yaw * RADIANS)];
  const placed = product(carriedBy('workpiece', axesAt(of, t)), [c, s, 0, 0, -s, c, 0, 0, 0, 0, 1, 0, x, y, z, 1]);
  return PART_TURNS ? product(placed, PART_TURNS[of.number - 1]) : placed;
}

/** A vector as the tables of a plan have it, which rides with the robot, in the workpiece frame. @param {Case} of @param {number} i @param {Vec} vector @returns {Vec} */
export function inWorkpiece(of, i, vector) {
  const inCell = turned(carriedBy('robot', axesAt(of, i)), vector);
  const part = workpieceFrame(of, i);
  return [0, 4, 8].map((k) => dot([part[k], part[k + 1], part[k + 2]], inCell));
}

/** At every point of a plan the tool by the arm and the path by the workpiece, in the cell, what carries the robot, and what each axis moves: for tests. @param {number} number */
export function meets(number) {
  const of = CASES[number];
  return of.joints.map((joints, i) => ({
    tool: moved(framesOf(joints, baseFrame(of, i))[7], [0, 0, 0]),
    path: moved(workpieceFrame(of, i), TASK.position[i]),
    carriage: carriedBy('robot', axesAt(of, i)),
    axes: AXES.map((_, k) => axisFrame(k, axesAt(of, i))),
  }));
}
