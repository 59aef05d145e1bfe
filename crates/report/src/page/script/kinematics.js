// Where the frames of the arm are (Khalil and Dombre 2002: modified Denavit-Hartenberg rows).

/** @type {Mat} tool frame to flange frame */
const FLANGE_FROM_TOOL = (() => {
  const { rotation: q, xyz_mm: at } = RAW.spindle;
  return [q[0][0], q[1][0], q[2][0], 0, q[0][1], q[1][1], q[2][1], 0, q[0][2], q[1][2], q[2][2], 0, ...at, 1];
})();

/** The robot base frame on what carries it: the mount. @type {Mat} */
const MOUNT = (() => {
  const mount = RAW.robot.mount;
  if (!mount) return IDENTITY;
  const { rotation: q, xyz_mm: at } = mount;
  return [q[0][0], q[1][0], q[2][0], 0, q[0][1], q[1][1], q[2][1], 0, q[0][2], q[1][2], q[2][2], 0, ...at, 1];
})();

/** Frames 0 (base) to 6 (flange) and 7 (tool). @param {number[]} joints @param {Mat} base @returns {Mat[]} */
function framesOf(joints, base = MOUNT) {
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

/** Frames of twelve numbers a point, by columns, where a run has them. @param {string[] | null} packed @returns {Float32Array[] | null} */
const framesBy = (packed) => (packed ? packed.map(singlesOf) : null);
const PART_FRAMES = framesBy(RAW.part_frames);
const CARRIAGE_FRAMES = framesBy(RAW.carriage_frames);

/** One of them at a fractional point: a little further on than the last where external axes move. @param {Float32Array} all @param {number} t @returns {Mat} */
function frameAt(all, t) {
  const i = Math.min(Math.floor(t), COUNT - 1);
  const next = Math.min(i + 1, COUNT - 1);
  const [from, to] = [all.subarray(12 * i, 12 * i + 12), all.subarray(12 * next, 12 * next + 12)];
  const m = mix(Array.from(from), Array.from(to), t - i);
  return [m[0], m[1], m[2], 0, m[3], m[4], m[5], 0, m[6], m[7], m[8], 0, m[9], m[10], m[11], 1];
}

/** What external axes have done with the robot: the frame that plans are stated in, in the cell. @param {Case} of @param {number} t @returns {Mat} */
const carriageFrame = (of, t) => (CARRIAGE_FRAMES ? frameAt(CARRIAGE_FRAMES[of.number - 1], t) : IDENTITY);

/** The robot base frame in the cell at a path point. @param {Case} of @param {number} t @returns {Mat} */
const baseFrame = (of, t) => (CARRIAGE_FRAMES ? product(carriageFrame(of, t), MOUNT) : MOUNT);

/** The workpiece frame in the cell at a path point. @param {Case} of @param {number} t @returns {Mat} */
function workpieceFrame(of, t) {
  if (PART_FRAMES) return product(carriageFrame(of, t), frameAt(PART_FRAMES[of.number - 1], t));
  const { x, y, z, yaw } = of.at;
  const [c, s] = [Math.cos(yaw * RADIANS), Math.sin(yaw * RADIANS)];
  return [c, s, 0, 0, -s, c, 0, 0, 0, 0, 1, 0, x, y, z, 1];
}

/** Joint angles at a fractional path point; between segments the arm moves from posture to posture. @param {Case} of @param {number} t */
function jointsAt(of, t) {
  const i = Math.min(Math.floor(t), COUNT - 1);
  const f = t - i;
  if (!f) return of.joints[i];
  return mix(of.joints[i], of.joints[i + 1], isMove(i) ? f * f * (3 - 2 * f) : f);
}

/** How far the wrist centre reaches from the shoulder, and the shoulder's distance from axis 1 and height. */
const REACH = {
  arm: Math.abs(ROWS[2].a) + Math.hypot(ROWS[3].a, ROWS[3].d),
  shoulder: Math.abs(ROWS[1].a),
  height: ROWS[0].d,
};
const FARTHEST = REACH.arm + REACH.shoulder;
