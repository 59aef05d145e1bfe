// The part is followed: at every move the best plan on the grid of the run, at rest the map and all that `stead score` states.

import { CASES, RAW } from '../run/data.js';
import { set } from '../run/state.js';
import { blankMap, putAnswer, putColumns } from './answers.js';
import { paced } from './pace.js';
import { onPlace, place } from './place.js';
import { Refusal, ask } from './server.js';

/** @typedef {{ isFeasible: boolean, isWhole: boolean, isFollowing: boolean, answer: any, reasons: string[] }} Shown */

/** What is shown of the place now. @type {Shown} */
export const shown = { isFeasible: CASES[0].columns.score_mm.some((score) => score > 0), isWhole: false, isFollowing: true, answer: null, reasons: [] };

/** @type {(() => void)[]} */
const watchers = [];
/** @param {() => void} watch told of every answer, before it is drawn */
export const onAnswer = (watch) => void watchers.push(watch);
const tell = () => watchers.forEach((watch) => watch());

/** Between the last move and what takes longer. ms */
const REST_MS = 200;
/** An answer that takes longer is waited for in view of the user. ms */
const LATE_MS = 150;

/** The number of the last place asked about, and of that whose answer is shown. */
let [wanted, answered] = [0, -1];
let isAsking = false;
let isAtRest = false;
let [restTimer, lateTimer] = [0, 0];

const asked = (/** @type {number} */ id) => ({ ...place, id });
const isCurrent = (/** @type {any} */ answer) => !answer.is_superseded && answer.version === RAW.live.state.version;

/** Draws part and arm; while the part is moved, no more often than leaves time for the figures. */
const drawScene = paced(() => set({ scene: true }), 2);
const renew = () => isAtRest && set({ renewed: true });
/** Draws charts, map and path anew: at rest alone. */
const redraw = paced(renew, 1);
/** The same for columns of the map, of which more come. */
const redrawMeanwhile = paced(renew, 5);

/** @param {any} answer */
function show(answer) {
  answered = answer.id;
  Object.assign(shown, {
    isFeasible: answer.feasible,
    isWhole: answer.is_whole,
    isFollowing: answer.id !== wanted,
    answer,
    reasons: answer.reasons ?? [],
  });
  inTime();
  if (answer.feasible) putAnswer(answer, 0, 'This placement');
  moveCase();
  tell();
  if (answer.is_whole) redraw();
  else seen(drawScene);
}

/** The part is drawn where it is, whatever is known of it. */
function moveCase() {
  for (const of of CASES.slice(0, 2)) of.at = { x: place.x_mm, y: place.y_mm, z: place.z_mm, yaw: place.yaw_deg };
}

/** Does something when the figures of now are on the screen. @param {() => void} then */
const seen = (then) => requestAnimationFrame(() => setTimeout(then));

/** What goes wrong with a request is said where the figures are. @param {unknown} error */
function failed(error) {
  inTime();
  Object.assign(shown, { isFeasible: false, reasons: [error instanceof Refusal ? error.message : 'the session does not answer'], isFollowing: false });
  tell();
}

async function preview() {
  isAsking = true;
  const id = wanted;
  try {
    const answer = await ask('/preview', asked(id));
    if (isCurrent(answer) && answer.id > answered) show(answer);
  } catch (error) {
    if (id === wanted) failed(error);
  }
  isAsking = false;
  if (id !== wanted) void preview();
  else restTimer = window.setTimeout(rest, REST_MS);
}

/** @param {number} id */
async function map(id) {
  blankMap();
  for (let from = /** @type {number | null} */ (0); from !== null && id === wanted; ) {
    const answer = await ask('/map', { ...asked(id), from });
    if (id !== wanted || !isCurrent(answer)) return;
    from = putColumns(answer);
    (from === null ? redraw : redrawMeanwhile)();
  }
}

async function rest() {
  const id = wanted;
  isAtRest = true;
  try {
    const columns = map(id);
    const answer = await ask('/whole', asked(id));
    if (id === wanted && isCurrent(answer)) show(answer);
    await columns;
  } catch (error) {
    if (id === wanted) failed(error);
  }
}

function inTime() {
  clearTimeout(lateTimer);
  lateTimer = 0;
}

function late() {
  lateTimer = 0;
  tell();
  drawScene();
}

/** Begins to follow the part. */
export function follow() {
  const moved = () => {
    wanted++;
    clearTimeout(restTimer);
    isAtRest = false;
    shown.isFollowing = true;
    moveCase();
    // What is drawn before the answer is there would be in its way.
    if (!isAsking) void preview();
    lateTimer ||= window.setTimeout(late, LATE_MS);
  };
  onPlace(moved);
  moved();
}
