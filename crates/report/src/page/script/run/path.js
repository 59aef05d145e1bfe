// The path: its segments, and when the tool is where.

import { CASES, COUNT, TASK } from './data.js';
/** @import { Case } from './data.js' */

export const SEGMENT = CASES[0].columns.segment;

/** First and last drawn point of each segment. @type {[number, number][]} */
export const RUNS = [];
for (let i = 0; i < COUNT; i++) {
  if (i === 0 || SEGMENT[i] !== SEGMENT[i - 1]) RUNS.push([i, i]);
  RUNS[RUNS.length - 1][1] = i;
}

/** Whether the arm moves over from one segment to the next behind a point. @param {number} i */
export const isMove = (i) => i + 1 < COUNT && SEGMENT[i] !== SEGMENT[i + 1];

/** The number of a drawn point in the path, which may have more. @param {number} i */
export const pathPoint = (i) => CASES[0].columns.point[i];

/** A move whose time is not known takes this long here. */
const UNKNOWN_MOVE_S = 1;

/** Times of the drawn points: the cut at the feed that is held, and the moves between segments. @param {Case} of @returns {number[]} */
export function timesOf(of) {
  const cut = TASK.steps.reduce((sum, step) => sum + step, 0);
  const scale = cut > 0 && of.cutting > 0 ? of.cutting / cut : 1;
  const out = [0];
  for (let i = 1; i < COUNT; i++) {
    let step = 0;
    if (isMove(i - 1)) {
      step = Math.max(0.15, of.moves[SEGMENT[i - 1] - 1] ?? UNKNOWN_MOVE_S);
    } else {
      for (let k = pathPoint(i - 1) + 1; k <= pathPoint(i); k++) step += TASK.steps[k] * scale;
    }
    out.push(out[i - 1] + step);
  }
  return out;
}
