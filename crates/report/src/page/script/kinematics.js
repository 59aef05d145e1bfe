// Where the frames of the arm are (Khalil and Dombre 2002: modified Denavit-Hartenberg rows).

/** A pose from a rotation by rows and a place. @param {number[][]} q @param {Vec} at @returns {Mat} */
const poseOf = (q, at) => [
  ...[q[0][0], q[1][0], q[2][0], 0, q[0][1], q[1][1], q[2][1], 0],
  ...[q[0][2], q[1][2], q[2][2], 0, at[0], at[1], at[2], 1],
];

/** @type {Mat} tool frame to flange frame */
const FLANGE_FROM_TOOL = poseOf(RAW.spindle.rotation, RAW.spindle.xyz_mm);

/** The robot base frame on what carries it: the mount. @type {Mat} */
const MOUNT = RAW.robot.mount ? poseOf(RAW.robot.mount.rotation, RAW.robot.mount.xyz_mm) : IDENTITY;

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

/** What a plan has at a fractional path point; between segments everything moves over smoothly. @param {(i: number) => number[]} at @param {number} t */
function between(at, t) {
  const i = Math.min(Math.floor(t), COUNT - 1);
  const f = t - i;
  if (!f) return at(i);
  return mix(at(i), at(i + 1), isMove(i) ? f * f * (3 - 2 * f) : f);
}

/** Joint angles at a fractional path point. @param {Case} of @param {number} t */
const jointsAt = (of, t) => between((i) => of.joints[i], t);

/** How far the wrist centre reaches from the shoulder, and the shoulder's distance from axis 1 and height. */
const REACH = {
  arm: Math.abs(ROWS[2].a) + Math.hypot(ROWS[3].a, ROWS[3].d),
  shoulder: Math.abs(ROWS[1].a),
  height: ROWS[0].d,
};
const FARTHEST = REACH.arm + REACH.shoulder;
