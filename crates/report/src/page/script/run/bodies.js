// The bodies of robot, spindle and surroundings: meshes that the page's data holds, each in the frame that it moves with.

import { RAW, bytesOf } from './data.js';
import { smoothed } from './mesh.js';
/** @import { Mesh } from './mesh.js' */

/** @typedef {{ name: string, frame: string, isIllustration: boolean, mesh: Mesh }} Body */

/** @param {any} body @returns {Body} */
function bodyOf(body) {
  const packed = new Int16Array(bytesOf(body.positions).buffer);
  const corners = Float32Array.from(packed, (step, k) => body.middle_mm[k % 3] + step * body.mm_per_step);
  const bytes = bytesOf(body.triangles).buffer;
  const triangles = body.wide ? new Uint32Array(bytes) : new Uint16Array(bytes);
  const colour = body.color.map((/** @type {number} */ part) => Math.round(part * 255));
  return {
    name: body.name,
    frame: body.frame,
    isIllustration: body.is_illustration,
    mesh: smoothed(corners, triangles, colour),
  };
}

/** @type {Body[]} the robot and its spindle */
export const BODIES = RAW.bodies.map(bodyOf);

/** @type {Body[]} the shapes in which collisions are looked for */
export const SHAPES = (RAW.surroundings || []).map(bodyOf);

/** @type {Body[]} the stock before the path and after it, where the run has one */
export const STOCKS = (RAW.removal?.stock || []).map(bodyOf);

/** Bodies that move together, as one mesh. @param {Body[]} all @param {string} frame @returns {Mesh} */
export function bodiesOf(all, frame) {
  const parts = all.filter((body) => body.frame === frame).map((body) => body.mesh);
  const joined = (/** @type {(part: Mesh) => number[] | Float32Array} */ of) => {
    const out = new Float32Array(parts.reduce((sum, part) => sum + of(part).length, 0));
    let at = 0;
    for (const part of parts) {
      out.set(of(part), at);
      at += of(part).length;
    }
    return out;
  };
  return { p: joined((part) => part.p), n: joined((part) => part.n), c: joined((part) => part.c), i: [] };
}

/** The frames in which a pose puts the bodies that hang on the arm. */
export const ARM_FRAMES = ['base', 'link_1', 'link_2', 'link_3', 'link_4', 'link_5', 'link_6', 'tool'];

/** Whether collision shapes are known of the arm. */
export const HAS_ENVELOPES = SHAPES.some((body) => ARM_FRAMES.includes(body.frame));

/** Whether anything is known that stands in the cell. */
export const HAS_SURROUNDINGS = SHAPES.some((body) => body.frame === 'cell' || body.frame.startsWith('axis_'));

/** What is drawn that no drawing of the real part is behind, in words. */
export const ILLUSTRATED = [
  BODIES.some((body) => body.isIllustration && body.frame !== 'tool') ? 'arm' : '',
  BODIES.some((body) => body.isIllustration && body.frame === 'tool') ? 'spindle' : '',
].filter(Boolean).join(' and ');
