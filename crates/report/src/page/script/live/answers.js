// What the server says of a place, put where the page shows a case.

import { CASES, COUNT, MAPS, caseOf, columnsOf, mapOf } from '../run/data.js';
import { PART_TURNS } from '../run/external-axes.js';
import { poseOf } from '../run/kinematics.js';
import { SEGMENT, pathPoint } from '../run/path.js';
/** @import { Case, Columns, StateMap } from '../run/data.js' */

/** Of the columns of some points those of all that are drawn, in proportion between them. @param {Columns} some @returns {Columns} */
function spread(some) {
  if (some.point.length === COUNT) return some;
  const points = some.point;
  // Of each drawn point the kept points around it, and the share of the second.
  const [low, high, share] = [new Uint32Array(COUNT), new Uint32Array(COUNT), new Float32Array(COUNT)];
  let k = 0;
  for (let i = 0; i < COUNT; i++) {
    const point = pathPoint(i);
    while (k + 1 < points.length && points[k + 1] <= point) k++;
    const isIn = (/** @type {number} */ at) => at >= 0 && at < points.length && some.segment[at] === SEGMENT[i];
    [low[i], high[i]] = [isIn(k) ? k : k + 1, isIn(k + 1) ? k + 1 : k];
    const wide = points[high[i]] - points[low[i]];
    if (!isIn(low[i]) || !isIn(high[i])) low[i] = high[i] = k;
    else if (wide > 0) share[i] = Math.min(Math.max((point - points[low[i]]) / wide, 0), 1);
  }
  return Object.fromEntries(
    Object.entries(some).map(([name, values]) => {
      if (name === 'point') return [name, Float32Array.from(low, (_, i) => pathPoint(i))];
      if (!(values instanceof Float32Array)) return [name, /** @type {any} */ (Array.from(low, (at) => values[at]))];
      const out = new Float32Array(COUNT);
      const isStep = name === 'posture' || name === 'segment' || name.startsWith('turn_');
      // Beta goes round.
      const turn = name === 'beta_deg' ? 360 : Infinity;
      for (let i = 0; i < COUNT; i++) {
        out[i] = values[low[i]];
        if (isStep) continue;
        let by = values[high[i]] - values[low[i]];
        if (Math.abs(by) > turn / 2) by -= turn * Math.round(by / turn);
        out[i] += share[i] * by;
      }
      return [name, out];
    }),
  );
}

/** The case of one plan of an answer. @param {any} answer @param {number} plan @param {number} place @param {Columns} columns @returns {Case} */
function caseIn({ document, moves }, plan, place, columns) {
  const figures = (plan === 1 && document.worst) || document.best;
  const entry = { ...figures, placement: document.placement, orientation: document.orientation, case: 2 * place + plan + 1 };
  return caseOf(entry, 2 * place + plan, columns, moves ? moves[plan] : []);
}

/** Shows an answer as the placement of a number: 0 that which is moved, 1 that which it is compared with. @param {any} answer @param {number} place @param {string} name */
export function putAnswer(answer, place, name) {
  const columns = answer.plans.map((/** @type {any} */ packed) => spread(columnsOf(packed)));
  for (const plan of [0, 1]) {
    const made = caseIn(answer, plan, place, columns[Math.min(plan, columns.length - 1)]);
    CASES[2 * place + plan] = { ...made, name: plan ? `${name}, worst plan` : name };
    if (PART_TURNS && answer.part_turn) PART_TURNS[2 * place + plan] = poseOf(answer.part_turn, [0, 0, 0]);
  }
}

/** Leaves out the placement that is compared with. */
export const dropCompared = () => void CASES.splice(2, 2);

const PENDING = 'not known yet';

/** A map whose columns are not there yet. @param {number[]} points @param {number} betaCount @returns {StateMap} */
function emptyMap(points, betaCount) {
  const count = points.length * betaCount;
  return {
    points,
    betaCount,
    codes: new Uint8Array(count).fill(16),
    reasons: [PENDING],
    scores: new Float32Array(count).fill(NaN),
    joints: new Float32Array(6 * count).fill(NaN),
  };
}

/** Nothing is known of the map of another place. */
export function blankMap() {
  const map = MAPS[0];
  if (map) MAPS[0] = emptyMap(map.points, map.betaCount);
}

/** Puts columns into the map. @param {any} answer @returns {number | null} the column to go on from */
export function putColumns({ from, all, columns }) {
  if (!all.length || !columns.points.length) return null;
  const part = mapOf(columns);
  if (MAPS[0]?.points.length !== all.length) MAPS[0] = emptyMap(all, part.betaCount);
  const map = MAPS[0];
  const numbers = part.reasons.map((reason) => {
    const known = map.reasons.indexOf(reason);
    return known < 0 ? map.reasons.push(reason) - 1 : known;
  });
  const first = from * map.betaCount;
  part.codes.forEach((code, k) => {
    map.codes[first + k] = code < 16 ? code : 16 + numbers[code - 16];
  });
  map.scores.set(part.scores, first);
  map.joints.set(part.joints, 6 * first);
  const next = from + columns.points.length;
  if (next < all.length) return next;
  // Where all columns are known, no word is needed for those that are not.
  map.reasons.shift();
  for (let k = 0; k < map.codes.length; k++) if (map.codes[k] > 16) map.codes[k]--;
  return null;
}
