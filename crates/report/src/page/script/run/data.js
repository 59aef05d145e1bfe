// What the page shows: the JSON beside the script, with its packed lists unpacked. Lengths in mm, angles in deg, times in s.

/**
 * @typedef {number[] | Float32Array | Float64Array | Uint16Array | Uint32Array | Int16Array} Numbers
 * @typedef {Record<string, Float32Array>} Columns
 * @typedef {{ alpha: number, a: number, d: number, min: number, max: number, compliance: number[] }} Row one joint: modified
 *   Denavit-Hartenberg row, limits, and its compliance in urad/(N m), evenly from limit to limit
 * @typedef {{ x: number, y: number, z: number, yaw: number }} Place
 * @typedef {{
 *   number: number, place: number, plan: number, name: string, at: Place, mean: number, max: number, columns: Columns,
 *   joints: number[][], postures: string[], travel: any, cycle: number | null, cutting: number, moves: (number | null)[], ways: (Way | null)[],
 *   room: Room | null, entry: any
 * }} Case one placement with one plan
 * @typedef {{
 *   distance: Float32Array, pair: (i: number) => string, still: string[]
 * }} Room the least clearance at the points; `still`: pairs left out whose distance never changes, in words
 * @typedef {{ joints: number[][], axes: number[][], parts: { first: number, steps: number, from: number, until: number }[] }} Way how a
 *   move between segments goes: places one after the other, and its parts from rest to rest with the shares of the time between them
 * @typedef {{
 *   points: number[], betaCount: number, codes: Uint8Array, reasons: string[], scores: Float32Array, joints: Float32Array
 * }} StateMap the states of a placement: `points.length * betaCount` of them
 */

export const RAW = JSON.parse(/** @type {HTMLElement} */ (document.getElementById('data')).textContent || '{}');

/** @param {string} text @returns {Uint8Array} */
export function bytesOf(text) {
  const plain = atob(text);
  const bytes = new Uint8Array(plain.length);
  for (let k = 0; k < plain.length; k++) bytes[k] = plain.charCodeAt(k);
  return bytes;
}

/** @param {string} text @returns {Float32Array} */
export const singlesOf = (text) => new Float32Array(bytesOf(text).buffer);

/** Whole numbers of seven bits a byte, the sign in bit 0. @param {string} text @returns {() => number} the next of them */
function varintsOf(text) {
  const bytes = bytesOf(text);
  let at = 0;
  return () => {
    let value = 0;
    let scale = 1;
    for (;;) {
      const byte = bytes[at++];
      value += (byte & 127) * scale;
      if (byte < 128) break;
      scale *= 128;
    }
    return value % 2 ? -(value + 1) / 2 : value / 2;
  };
}

/** A sequence from its second differences. */
class Sequence {
  constructor() {
    this.last = 0;
    this.step = 0;
    this.isNew = true;
  }
  restart() {
    this.last = 0;
    this.step = 0;
    this.isNew = true;
  }
  /** @param {number} surprise */
  next(surprise) {
    /** @type {number} */
    const value = this.last + this.step + surprise;
    this.step = this.isNew ? 0 : value - this.last;
    this.isNew = false;
    this.last = value;
    return value;
  }
}

/** @param {Record<string, any>} packed @returns {Columns} */
export function columnsOf(packed) {
  return Object.fromEntries(
    Object.entries(packed).map(([name, text]) => [name, typeof text === 'string' ? singlesOf(text) : text]),
  );
}

/** @param {any} entry @returns {StateMap} */
export function mapOf(entry) {
  const betaCount = entry.beta_count;
  const codes = new Uint8Array(entry.points.length * betaCount);
  const nextRun = varintsOf(entry.codes);
  for (let row = 0; row < codes.length;) {
    const [count, code] = [nextRun(), nextRun()];
    codes.fill(code, row, (row += count));
  }
  const scores = new Float32Array(codes.length).fill(NaN);
  const joints = new Float32Array(codes.length * 6).fill(NaN);
  const [nextScore, nextAngle] = [varintsOf(entry.scores), varintsOf(entry.joints)];
  const score = new Sequence();
  const angles = Array.from({ length: 6 }, () => new Sequence());
  for (let row = 0; row < codes.length; row++) {
    const isFirst = row % betaCount === 0;
    if (isFirst) score.restart();
    if (isFirst || codes[row] !== codes[row - 1]) angles.forEach((angle) => angle.restart());
    if (codes[row] >= 16) {
      score.restart();
      continue;
    }
    scores[row] = score.next(nextScore()) * entry.score_step_mm;
    for (let j = 0; j < 6; j++) joints[6 * row + j] = angles[j].next(nextAngle()) * entry.angle_step_deg;
  }
  return { points: entry.points, betaCount, codes, reasons: entry.reasons, scores, joints };
}

export const IS_SCORE = RAW.command === 'score';

/** What lines of the summary are about that are to be seen before the figures are believed. */
export const DOUBTS = new Set(['INTERRUPTED', 'NOT CHECKED', 'WARNING']);

/** What is stated of each case, best placement first. @returns {any[]} */
function caseEntries() {
  const { document } = RAW;
  if (!IS_SCORE) return document.cases;
  return ['best', 'worst'].map((plan, k) => ({
    ...document[plan],
    placement: document.placement,
    orientation: document.orientation,
    case: k + 1,
  }));
}

const CASE_NAMES = IS_SCORE
  ? ['This placement', 'This placement, worst plan']
  : ['Best placement', 'Best placement, worst plan', 'Worst placement', 'Worst placement, worst plan'];

/** The same where there is little room. */
export const SHORT_NAMES = IS_SCORE ? ['Best plan', 'Worst plan'] : ['Best', 'Best, worst plan', 'Worst', 'Worst, worst plan'];

/** @type {Row[]} */
export const ROWS = RAW.robot.rows.map((/** @type {any} */ row) => ({
  alpha: row.alpha_deg,
  a: row.a_mm,
  d: row.d_mm,
  min: row.min_deg,
  max: row.max_deg,
  compliance: row.compliance_urad_per_nm,
}));

/** How joint 3 counts in the sum of joints 2 and 3: how far the forearm is turned against the base. */
export const FOLD = Math.cos((ROWS[2].alpha * Math.PI) / 180) < 0 ? -1 : 1;

/** The range of that sum and whether a parallelogram drives axis 3, where anything joins the two. @type {{ linkage: boolean, min: number, max: number } | null} */
export const JOINED = RAW.robot.axes_2_3
  ? { linkage: RAW.robot.axes_2_3.linkage, min: RAW.robot.axes_2_3.sum_min_deg, max: RAW.robot.axes_2_3.sum_max_deg }
  : null;

/** How the controller counts the joints, where it is known. @type {{ at_zero_deg: number[], sign: number[], a3_by_a2: number } | null} */
const CONTROLLER = RAW.robot.controller ?? null;

/** What joints are called where their angles are shown, and whose angles these are. */
export const JOINT_NAMES = ROWS.map((_, j) => `${CONTROLLER ? 'A' : 'θ'}${j + 1}`);
export const JOINT_ANGLES = CONTROLLER ? 'as the controller counts them' : 'of the rows of the robot file';

/** The limits of joints by their rows, in the order in which the angles that are shown grow. deg */
export const ENDS = ROWS.map(({ min, max }, j) => (CONTROLLER && CONTROLLER.sign[j] < 0 ? [max, min] : [min, max]));

/** The angles that the controller shows, those of the rows where it is not known. deg @param {number[]} joints */
export function shownAngles(joints) {
  if (!CONTROLLER) return joints;
  const { at_zero_deg: atZero, sign, a3_by_a2: level } = CONTROLLER;
  const shown = joints.map((angle, j) => atZero[j] + sign[j] * angle);
  shown[2] += level * sign[1] * joints[1];
  return shown;
}

/** Numbers in rows of so many. @param {string} text @param {number} rows @returns {number[][]} */
function rowsOf(text, rows) {
  const all = singlesOf(text);
  const wide = all.length / rows;
  return Array.from({ length: rows }, (_, k) => Array.from(all.subarray(wide * k, wide * (k + 1))));
}

/** @param {any} entry @returns {Way | null} null where a move is straight in joint space */
function wayOf(entry) {
  if (!entry) return null;
  const places = 1 + entry.steps.reduce((/** @type {number} */ sum, /** @type {number} */ steps) => sum + steps, 0);
  let [first, from] = [0, 0];
  const parts = entry.steps.map((/** @type {number} */ steps, /** @type {number} */ k) => {
    const part = { first, steps, from, until: from + entry.time_shares[k] };
    [first, from] = [first + steps, part.until];
    return part;
  });
  return { joints: rowsOf(entry.joints_deg, places), axes: rowsOf(entry.axes, places), parts };
}

/** @param {Record<string, any>} columns @param {any} changing what is known without pairs that stand still @returns {Room | null} */
function roomOf(columns, changing) {
  if (!columns.clearance_mm) return null;
  if (!changing) return { distance: columns.clearance_mm, pair: (i) => columns.nearest_pair[i], still: [] };
  const numbers = singlesOf(changing.pair);
  return {
    distance: singlesOf(changing.clearance_mm),
    pair: (i) => changing.pairs[numbers[i]] ?? '',
    still: changing.still.map((/** @type {any} */ of) => `${of.pair} ${of.distance_mm.toFixed(1)}`),
  };
}

/** A case of its entry and its table. @param {any} entry @param {number} k @param {Columns} columns @param {any[]} ways @param {any} [changing] @returns {Case} */
export function caseOf(entry, k, columns, ways, changing) {
  const joints = Array.from(columns.point, (_, i) => [1, 2, 3, 4, 5, 6].map((j) => columns[`theta${j}_deg`][i]));
  const at = entry.placement;
  return {
    number: entry.case,
    place: k >> 1,
    plan: k & 1,
    name: CASE_NAMES[k],
    at: { x: at.x_mm, y: at.y_mm, z: at.z_mm, yaw: at.yaw_deg },
    mean: entry.mean_mm,
    max: entry.max_mm,
    columns,
    joints,
    postures: entry.postures.map(String),
    // Of runs of older versions not known.
    travel: entry.joint_travel || null,
    cycle: entry.cycle_s,
    cutting: entry.cutting_s,
    moves: (entry.transfers || []).map((/** @type {any} */ move) => move.duration_s),
    ways: ways.map(wayOf),
    room: roomOf(columns, changing),
    entry,
  };
}

/** @type {Case[]} */
export const CASES = caseEntries().map((entry, k) => caseOf(entry, k, columnsOf(RAW.plans[k]), RAW.moves ? RAW.moves[k] : [], RAW.clearances?.[k]));

/** The words of a posture, which results of older versions do not state. @param {number | string} posture @returns {string | undefined} */
export const wordsOf = (posture) => (RAW.posture_words ?? RAW.document.posture_words)?.[+posture - 1];

/** A posture with its words. @param {number | string} posture */
export const postureText = (posture) => {
  const words = wordsOf(posture);
  return words ? `posture ${posture} (${words})` : `posture ${posture}`;
};

/** How many path points are drawn. */
export const COUNT = CASES[0].joints.length;

/** @param {string} text @returns {number[][]} */
function vectorsOf(text) {
  const all = singlesOf(text);
  return Array.from({ length: all.length / 3 }, (_, i) => [all[3 * i], all[3 * i + 1], all[3 * i + 2]]);
}

/**
 * The task in the workpiece frame; `scored` are the directions that count, with the roots of their weights; `steps` are those of all points,
 * also where fewer are drawn.
 */
export const TASK = {
  position: vectorsOf(RAW.task.position_mm),
  feed: vectorsOf(RAW.task.feed),
  axis: vectorsOf(RAW.task.axis),
  scored: RAW.task.scored.map(vectorsOf),
  moment: RAW.task.moment_nm ? vectorsOf(RAW.task.moment_nm) : null,
  steps: singlesOf(RAW.task.step_s),
};

/**
 * What the path removes of its stock, where the run has one: at each drawn point the mean force over a turn in the workpiece frame, in N,
 * and numbers by the names of `page-data.json`, NaN where nothing is cut.
 * @type {{ force: number[][], columns: Columns } | null}
 */
export const REMOVAL = (() => {
  if (!RAW.removal) return null;
  const { force_n, stock: _, ...packed } = RAW.removal;
  return { force: vectorsOf(force_n), columns: columnsOf(packed) };
})();

/** @type {StateMap[]} */
export const MAPS = RAW.maps.map(mapOf);

export const LIMITS = { inverse: RAW.limits.min_inverse_condition, deflection: RAW.limits.max_deflection_mm };
