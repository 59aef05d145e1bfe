// What stands about the arm: the block under the path, the cell volume, the reach, and the grid on the floor.

import { BODIES, SHAPES, STOCKS } from './bodies.js';
import { CASES, RAW, TASK } from './data.js';
import { baseFrame, workpieceFrame } from './external-axes.js';
import { FARTHEST, MOUNT, REACH } from './kinematics.js';
import { IDENTITY, RADIANS, moved } from './linear.js';
import { creasesOf, lathe, mesh } from './mesh.js';
import { EXTENT, PATH_SIZE } from './path-mesh.js';
/** @import { Body } from './bodies.js' */
/** @import { Mat, Vec } from './linear.js' */
/** @import { Mesh } from './mesh.js' */

/** Lowest and highest place of a body in a direction of the frame that a pose is in. @param {Body} body @param {Mat} pose @param {number} k @returns {[number, number]} */
function spanOf({ mesh: { p } }, pose, k) {
  let [low, high] = [Infinity, -Infinity];
  for (let c = 0; c < p.length; c += 3) {
    const value = pose[k] * p[c] + pose[4 + k] * p[c + 1] + pose[8 + k] * p[c + 2] + pose[12 + k];
    [low, high] = [Math.min(low, value), Math.max(high, value)];
  }
  return [low, high];
}

/** The extent of the stock before it is cut, where there is one. @type {[number, number][] | null} */
const STOCK = STOCKS.length ? /** @type {[number, number][]} */ ([0, 1, 2].map((k) => spanOf(STOCKS[0], IDENTITY, k))) : null;

/** The extent of path and stock in the workpiece frame. */
const WORK = EXTENT.map(([low, high], k) => (STOCK ? [Math.min(low, STOCK[k][0]), Math.max(high, STOCK[k][1])] : [low, high]));

/** The bodies of part and stock. */
const PARTS = [...BODIES, ...SHAPES, ...STOCKS].filter((body) => body.frame === 'workpiece');

/** Whether a block can be drawn under the path: the tool comes from above everywhere, and no body of the part is known. */
export const HAS_BLOCK = TASK.axis.every((axis) => axis[2] > 0.8) && !PARTS.length;

/** Whether one of them surrounds the path, so that it may hide it. */
export const HIDES_PATH = PARTS.some((body) =>
  EXTENT.every(([low, high], k) => {
    const [from, to] = spanOf(body, IDENTITY, k);
    return from < low && high < to;
  }),
);

/** The lowest place of the work, wherever it is placed. */
const LOWEST_WORK = Math.min(
  RAW.cell.z_mm[0] + Math.min(EXTENT[2][0], 0),
  ...CASES.map((of) => boxCorners(WORK).reduce((low, corner) => Math.min(low, moved(workpieceFrame(of, 0), corner)[2]), Infinity)),
);

/** @param {number[][]} extent along three axes @returns {Vec[]} its corners */
function boxCorners(extent) {
  return [0, 1, 2, 3, 4, 5, 6, 7].map((bits) => [0, 1, 2].map((k) => extent[k][(bits >> k) & 1]));
}

/** Whether a body of the cell is its floor: flat, wide and below the work. @param {Body} body */
function isFloor(body) {
  const [[x0, x1], [y0, y1], [z0, z1]] = [0, 1, 2].map((k) => spanOf(body, IDENTITY, k));
  const wide = Math.min(x1 - x0, y1 - y0);
  return wide > 0.6 * FARTHEST && z1 - z0 < 0.2 * wide && z1 <= LOWEST_WORK;
}

/** The height of the floor: as the cell has it, else below the robot's foot, the fences and all places of the workpiece. */
export const FLOOR = (() => {
  const standing = SHAPES.filter(({ frame }) => frame === 'cell');
  const floors = standing.filter(isFloor).map((body) => spanOf(body, IDENTITY, 2)[1]);
  if (floors.length) return Math.max(...floors);
  const foot = baseFrame(CASES[0], 0);
  const lows = [
    ...standing.map((body) => spanOf(body, IDENTITY, 2)[0]),
    ...[...BODIES, ...SHAPES].filter(({ frame }) => frame === 'base').map((body) => spanOf(body, foot, 2)[0]),
  ];
  return Math.min(LOWEST_WORK - PATH_SIZE * 0.15, ...lows);
})();

/** @returns {Vec[]} edges of what stands in the cell */
export const wallEdges = () => SHAPES.filter(({ frame }) => frame === 'cell').flatMap((body) => creasesOf(body.mesh));

/** @param {Vec} low @param {Vec} high @returns {Vec[]} ends of the twelve edges of a box */
export function edgesOf(low, high) {
  const at = (/** @type {number} */ x, /** @type {number} */ y, /** @type {number} */ z) => [
    x ? high[0] : low[0],
    y ? high[1] : low[1],
    z ? high[2] : low[2],
  ];
  return [
    [0, 0],
    [0, 1],
    [1, 0],
    [1, 1],
  ].flatMap(([a, b]) => [at(0, a, b), at(1, a, b), at(a, 0, b), at(a, 1, b), at(a, b, 0), at(a, b, 1)]);
}

/** The extent of the stock, or of a block under the path, with a margin: an illustration. @returns {[Vec, Vec]} */
export function blockBox() {
  if (STOCK) return [STOCK.map(([low]) => low), STOCK.map(([, high]) => high)];
  const margin = Math.max(20, PATH_SIZE * 0.07);
  const [[x0, x1], [y0, y1], [z0]] = EXTENT;
  const top = z0 - Math.max(2, PATH_SIZE * 0.012);
  return [
    [x0 - margin, y0 - margin, top - PATH_SIZE * 0.13],
    [x1 + margin, y1 + margin, top],
  ];
}

/** @param {number[]} colour to 255 @returns {Mesh} the block in the workpiece frame */
export function block(colour) {
  const out = mesh();
  const [low, high] = blockBox();
  for (let axis = 0; axis < 3; axis++) {
    for (const side of [0, 1]) {
      const base = out.p.length / 3;
      const [u, v] = [(axis + 1) % 3, (axis + 2) % 3];
      for (const [a, b] of [
        [0, 0],
        [1, 0],
        [1, 1],
        [0, 1],
      ]) {
        const corner = [0, 0, 0];
        corner[axis] = side ? high[axis] : low[axis];
        corner[u] = a ? high[u] : low[u];
        corner[v] = b ? high[v] : low[v];
        out.p.push(...corner);
        out.n.push(...[0, 1, 2].map((k) => (k === axis ? (side ? 1 : -1) : 0)));
        out.c.push(...colour);
      }
      out.i.push(base, base + 1, base + 2, base, base + 2, base + 3);
    }
  }
  return out;
}

/** @returns {Vec[]} edges of the stock, of the block, or of the extent of the path, in the workpiece frame */
export function partEdges() {
  const [low, high] = blockBox();
  return edgesOf(low, HAS_BLOCK || STOCK ? high : [high[0], high[1], EXTENT[2][1]]);
}

/** @returns {Vec[]} edges of the volume in which the workpiece origin may stand */
export function cellEdges() {
  const { x_mm: x, y_mm: y, z_mm: z } = RAW.cell;
  return edgesOf([x[0], y[0], z[0]], [x[1], y[1], z[1]]);
}

/** Where a ray of the wrist's reach ends. @param {number} around @param {number} up @returns {Vec} */
function reachAt(around, up) {
  const side = Math.sign(Math.cos(up)) * REACH.shoulder * Math.abs(Math.cos(up)) ** 0.2;
  const radius = side + REACH.arm * Math.cos(up);
  const z = REACH.height + REACH.arm * Math.sin(up);
  return [radius * Math.cos(around), radius * Math.sin(around), MOUNT === IDENTITY ? Math.max(z, FLOOR) : z];
}

/** @returns {Vec[]} four half circles and a ring of the reach, as lines */
export function reachLines() {
  const out = [];
  for (let k = 0; k < 120; k++) {
    const [a, b] = [3 * k * RADIANS, 3 * (k + 1) * RADIANS];
    out.push(reachAt(a, 0), reachAt(b, 0));
    for (let q = 0; q < 4; q++) out.push(reachAt(q * 45 * RADIANS, a), reachAt(q * 45 * RADIANS, b));
  }
  return out;
}

/** @returns {Mesh} the reach as a ball that only its rim shows */
export function reachBall() {
  const out = mesh();
  const profile = /** @type {[number, number][]} */ (
    Array.from({ length: 33 }, (_, k) => {
      const angle = (Math.PI * k) / 32;
      return [FARTHEST * (1 - Math.cos(angle)), FARTHEST * Math.sin(angle)];
    })
  );
  lathe(out, [0, 0, REACH.height - FARTHEST], [0, 0, REACH.height + FARTHEST], profile, 64, [255, 255, 255]);
  return out;
}

/** Lines on the floor, thin and thick. @returns {[Vec[], Vec[]]} */
export function floorGrid() {
  const step = FARTHEST > 1200 ? 250 : FARTHEST > 400 ? 100 : 20;
  const half = Math.ceil((FARTHEST * 1.3) / step / 4) * step * 4;
  /** @type {[Vec[], Vec[]]} */
  const out = [[], []];
  for (let s = -half; s <= half; s += step) {
    out[s % (4 * step) === 0 ? 1 : 0].push([s, -half, FLOOR], [s, half, FLOOR], [-half, s, FLOOR], [half, s, FLOOR]);
  }
  return out;
}
