// The bodies of robot, spindle and surroundings: meshes that the page's data holds, each in the frame that it moves with.

/** @typedef {{ name: string, frame: string, isIllustration: boolean, mesh: Mesh }} Body */

/** @type {Body[]} */
const BODIES = RAW.bodies.map((/** @type {any} */ body) => {
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
});

/** Bodies that move together, as one mesh. @param {string} frame @returns {Mesh} */
function bodiesOf(frame) {
  const parts = BODIES.filter((body) => body.frame === frame).map((body) => body.mesh);
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
const ARM_FRAMES = ['base', 'link_1', 'link_2', 'link_3', 'link_4', 'link_5', 'link_6', 'tool'];

/** Whether shapes are drawn that no drawing of the real part is behind. */
const HAS_ILLUSTRATIONS = BODIES.some((body) => body.isIllustration);

/** The floor: below the robot's foot, or where nothing says, below everything. */
const FLOOR = (() => {
  let lowest = Infinity;
  for (const body of BODIES) {
    if (body.frame === 'base')
      for (let k = 2; k < body.mesh.p.length; k += 3) lowest = Math.min(lowest, body.mesh.p[k]);
  }
  return Number.isFinite(lowest) ? lowest : Math.min(...CASES.map((of) => of.at.z), 0) - 300;
})();
