// What is shown now, and who has to be told when it changes.

import { clamp } from '../draw/scale.js';
import { CASES, COUNT, MAPS } from './data.js';
import { jointsAt } from './kinematics.js';
/** @import { StateMap } from './data.js' */

/**
 * @typedef {{ column: number, beta: number }} Chosen a state of the map: number of its column and of its angle
 * @typedef {{
 *   chosen: Chosen | null, case: number, t: number, hover: number | null, colouring: number, magnified: number | null, isHeld: boolean
 * }} State magnified: how many times too large errors are drawn, null for what suits the run; isHeld: whether something is being moved by hand
 * @typedef {{ theme?: boolean, size?: boolean, scene?: boolean, renewed?: boolean }} Look what changes without the state; `renewed` where
 *   the case is the same and what is known of it is not
 * @typedef {Look & { case?: boolean, path?: boolean, beyond?: boolean }} Changes path: how it is drawn; beyond: more than the view of the cell
 */

/** @type {State} */
export const state = { case: 0, t: 0, chosen: null, hover: null, colouring: 0, magnified: null, isHeld: false };

/** @type {((changes: Changes) => void)[]} */
const listeners = [];
/** @type {((changes: Changes) => void)[]} */
const sceneListeners = [];
/** @type {Changes} */
let changes = { case: true, theme: true, size: true, beyond: true };
let frame = 0;

/** Steps shown so far, those of them beyond the view of the cell, and the time that they took in JavaScript, for measurements. */
export const steps = { count: 0, beyond: 0, ms: 0 };

/** @param {(changes: Changes) => void} listener */
export const onChange = (listener) => void listeners.push(listener);

/** @param {(changes: Changes) => void} listener told also where nothing but the view of the cell changes */
export const onScene = (listener) => void sceneListeners.push(listener);

function show() {
  cancelAnimationFrame(frame);
  frame = 0;
  const [now, begun] = [changes, performance.now()];
  changes = {};
  if (now.beyond) {
    listeners.forEach((listener) => listener(now));
    steps.beyond++;
  }
  sceneListeners.forEach((listener) => listener(now));
  steps.count++;
  steps.ms += performance.now() - begun;
}

/** Changes the state; what shows it is drawn in the next frame, or at once. @param {Partial<State> & Look} to @param {boolean} [atOnce] */
export function set(to, atOnce = false) {
  const { theme, size: resized, scene, renewed, isHeld, ...next } = to;
  if (next.case !== undefined && next.case !== state.case) {
    changes.case = true;
    state.chosen = null;
  }
  if (next.colouring !== undefined && next.colouring !== state.colouring) changes.path = true;
  if (next.magnified !== undefined && next.magnified !== state.magnified) changes.path = true;
  if (next.t !== undefined) {
    next.t = clamp(next.t, 0, COUNT - 1);
    if (next.chosen === undefined) next.chosen = null;
  }
  if (renewed) {
    changes.case = changes.renewed = true;
    forgetters.forEach((forget) => forget());
  }
  changes.theme ||= theme;
  changes.size ||= resized;
  changes.scene ||= scene;
  changes.beyond ||= !scene || theme || resized || renewed || Object.keys(next).length > 0;
  Object.assign(state, next, isHeld === undefined ? {} : { isHeld });
  if (atOnce) show();
  else frame ||= requestAnimationFrame(show);
}

/** The case that is shown. */
export const current = () => CASES[state.case];

/** The drawn path point nearest to where the tool is. */
export const currentPoint = () => Math.round(state.t);

/** The map of the placement that is shown, if there is one. @returns {StateMap | undefined} */
export const currentMap = () => MAPS[current().place];

/** What the map says of a state. @param {StateMap} map @param {Chosen} at */
export function mapState(map, at) {
  const row = at.column * map.betaCount + at.beta;
  const code = map.codes[row];
  const isAllowed = code < 16;
  return {
    point: map.points[at.column],
    beta: -180 + (360 * at.beta) / map.betaCount,
    isAllowed,
    score: map.scores[row],
    posture: code,
    reason: isAllowed ? '' : map.reasons[code - 16],
    joints: Array.from(map.joints.subarray(6 * row, 6 * row + 6)),
  };
}

/** The state that is chosen in the map, where one is. */
export function chosenState() {
  const map = currentMap();
  return state.chosen && map ? mapState(map, state.chosen) : null;
}

/** The joint angles that are shown: those of the state chosen in the map where the arm may take it, else those of the plan. */
export function currentJoints() {
  const chosen = chosenState();
  return chosen?.isAllowed ? chosen.joints : jointsAt(current(), state.t);
}

/** @type {(() => void)[]} what was computed of cases is forgotten */
const forgetters = [];

/** What depends on the case alone, computed once for each. @template T @param {() => T} make @returns {() => T} */
export function remembered(make) {
  /** @type {Map<number, T>} */
  const known = new Map();
  forgetters.push(() => known.clear());
  return () => {
    let found = known.get(state.case);
    if (found === undefined) {
      found = make();
      known.set(state.case, found);
    }
    return found;
  };
}
