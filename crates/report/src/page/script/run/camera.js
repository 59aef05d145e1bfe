// The eye: it turns about a place, by drag, wheel, pinch and keys.

import { clamp, mix } from '../draw/scale.js';
import { CASES } from './data.js';
import { baseFrame, workpieceFrame } from './external-axes.js';
import { FARTHEST, MOUNT, REACH, framesOf } from './kinematics.js';
import { add, cross, dot, less, moved, times, unit } from './linear.js';
import { EXTENT, PATH_SIZE } from './path-mesh.js';
import { current, currentJoints, state } from './state.js';
/** @import { Case } from './data.js' */
/** @import { Mat, Vec } from './linear.js' */

/** @param {Vec} eye @param {Vec} target @param {Vec} up @returns {Mat} */
export function lookAt(eye, target, up) {
  const z = unit(less(eye, target));
  const x = unit(cross(up, z));
  const y = cross(z, x);
  return [x[0], y[0], z[0], 0, x[1], y[1], z[1], 0, x[2], y[2], z[2], 0, -dot(x, eye), -dot(y, eye), -dot(z, eye), 1];
}

/** @param {number} angle @param {number} aspect @param {number} near @param {number} far @returns {Mat} */
export function perspective(angle, aspect, near, far) {
  const s = 1 / Math.tan(angle / 2);
  return [
    s / aspect,
    0,
    0,
    0,
    0,
    s,
    0,
    0,
    0,
    0,
    (far + near) / (near - far),
    -1,
    0,
    0,
    (2 * far * near) / (near - far),
    0,
  ];
}

/** @param {number} half @param {number} near @param {number} far @returns {Mat} */
export const parallel = (half, near, far) => [
  1 / half,
  0,
  0,
  0,
  0,
  1 / half,
  0,
  0,
  0,
  0,
  -2 / (far - near),
  0,
  0,
  0,
  -(far + near) / (far - near),
  1,
];

/** The middle of the path as placed. @param {Case} of @returns {Vec} */
const middleOf = (of) =>
  moved(
    workpieceFrame(of, 0),
    EXTENT.map(([low, high]) => (low + high) / 2),
  );

/** Where the scene looks to: between the robot and the places of the workpiece. */
const WORK = CASES.reduce((sum, of) => add(sum, times(middleOf(of), 1 / CASES.length)), [0, 0, 0]);
/** The middle of the robot's reach: on a floor above its foot, or beside a wall or under a ceiling that it hangs on. */
const SHOULDER = moved(baseFrame(CASES[0], 0), [0, 0, REACH.height]);
const WORK_SIDE = Math.atan2(WORK[1] - SHOULDER[1], WORK[0] - SHOULDER[0]);
/** The middle of the views: between the two, level with the robot where it stands upright. */
export const MIDDLE = add(mix(SHOULDER, [WORK[0], WORK[1], SHOULDER[2]], 0.52), [0, 0, MOUNT[10] > 0.9 ? 0 : (WORK[2] - SHOULDER[2]) / 2]);

/** @typedef {{ around: number, up: number, distance: number, target: Vec }} Eye angles in rad */

/** The eye of a named view. @param {string} name @returns {Eye} */
export function viewOf(name) {
  const far = FARTHEST;
  const raised = (/** @type {number} */ by) => add(MIDDLE, [0, 0, by * far]);
  if (name === 'top')
    return { around: WORK_SIDE, up: 1.5, distance: 2.6 * far, target: raised(-0.1) };
  if (name === 'front')
    return { around: WORK_SIDE, up: 0.06, distance: 2.4 * far, target: raised(0.08) };
  if (name === 'tool') {
    const tip = moved(framesOf(currentJoints(), baseFrame(current(), state.t))[7], [0, 0, 0]);
    return { around: WORK_SIDE + 0.6, up: 0.42, distance: clamp(2.6 * PATH_SIZE, 0.25 * far, 0.8 * far), target: tip };
  }
  return { around: WORK_SIDE + 0.55, up: 0.31, distance: 1.82 * far, target: raised(0.05) };
}

/** @param {Eye} eye @returns {Vec} */
export const placeOf = (eye) =>
  add(
    eye.target,
    times(
      [Math.cos(eye.up) * Math.cos(eye.around), Math.cos(eye.up) * Math.sin(eye.around), Math.sin(eye.up)],
      eye.distance,
    ),
  );

/** The angle of the view upwards, by how much wider than high it is. rad @param {number} aspect */
export const fieldOf = (aspect) => (aspect < 1 ? 0.9 : 0.63);

/** @typedef {{ from: Vec, along: Vec }} Ray */

/** What is seen at a place of the window. @param {Eye} eye @param {HTMLElement} surface @param {number} x @param {number} y @returns {Ray} */
export function rayAt(eye, surface, x, y) {
  const box = surface.getBoundingClientRect();
  const aspect = box.width / Math.max(box.height, 1);
  const half = Math.tan(fieldOf(aspect) / 2);
  const [right, up] = [((2 * (x - box.left)) / box.width - 1) * half * aspect, (1 - (2 * (y - box.top)) / box.height) * half];
  const from = placeOf(eye);
  const m = lookAt(from, eye.target, [0, 0, 1]);
  return { from, along: unit([0, 4, 8].map((k) => m[k] * right + m[k + 1] * up - m[k + 2])) };
}

/** Moves the eye by hand. @param {HTMLElement} surface @param {Eye} eye @param {() => void} changed */
export function steer(surface, eye, changed) {
  const zoom = (/** @type {number} */ factor) => {
    eye.distance = clamp(eye.distance * factor, 0.12 * FARTHEST, 6 * FARTHEST);
  };
  const turn = (/** @type {number} */ dx, /** @type {number} */ dy) => {
    eye.around -= dx * 0.006;
    eye.up = clamp(eye.up + dy * 0.006, -0.25, 1.5);
  };
  const pan = (/** @type {number} */ dx, /** @type {number} */ dy) => {
    const scale = (eye.distance * 0.63) / Math.max(surface.clientHeight, 1);
    const [ca, sa, ce, se] = [Math.cos(eye.around), Math.sin(eye.around), Math.cos(eye.up), Math.sin(eye.up)];
    eye.target = add(eye.target, add(times([-sa, ca, 0], -dx * scale), times([-ca * se, -sa * se, ce], dy * scale)));
  };
  /** @type {Map<number, [number, number]>} */
  const fingers = new Map();
  let apart = 0;
  surface.addEventListener('pointerdown', (event) => {
    surface.setPointerCapture(event.pointerId);
    fingers.set(event.pointerId, [event.clientX, event.clientY]);
  });
  const up = (/** @type {PointerEvent} */ event) => {
    fingers.delete(event.pointerId);
    apart = 0;
  };
  surface.addEventListener('pointerup', up);
  surface.addEventListener('pointercancel', up);
  surface.addEventListener('contextmenu', (event) => event.preventDefault());
  surface.addEventListener('pointermove', (event) => {
    const from = fingers.get(event.pointerId);
    if (!from) return;
    const [dx, dy] = [event.clientX - from[0], event.clientY - from[1]];
    fingers.set(event.pointerId, [event.clientX, event.clientY]);
    if (fingers.size === 2) {
      const [a, b] = [...fingers.values()];
      const now = Math.hypot(a[0] - b[0], a[1] - b[1]);
      if (apart > 0 && now > 0) zoom(apart / now);
      apart = now;
      pan(dx / 2, dy / 2);
    } else if (event.buttons & 6 || event.shiftKey) pan(dx, dy);
    else turn(dx, dy);
    changed();
  });
  const onWheel = (/** @type {WheelEvent} */ event) => {
    event.preventDefault();
    zoom(Math.exp(clamp(event.deltaY, -60, 60) * 0.002));
    changed();
  };
  surface.addEventListener('wheel', onWheel, { passive: false });
  return { turn, pan, zoom };
}
