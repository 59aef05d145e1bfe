// Where the part stands, and the steps that led there.

import { RAW } from '../run/data.js';
import { keptOver } from './tab.js';

/**
 * @typedef {{ for_each: string, positions: number[][] }} Axes
 * @typedef {{ x_mm: number, y_mm: number, z_mm: number, yaw_deg: number, orientation: string | null, external_axes: Axes | null }} Place
 */

/** @param {any} entry as results state it @returns {Place} */
export const placeOf = ({ placement_exact: at, orientation, external_axes: axes }) => ({
  x_mm: at.x_mm,
  y_mm: at.y_mm,
  z_mm: at.z_mm,
  yaw_deg: at.yaw_deg,
  orientation: orientation ?? null,
  external_axes: axes ? { for_each: axes.for_each, positions: axes.positions } : null,
});

/** Where the part is now. @type {Place} */
export const place = placeOf(RAW.live.place);

/** @type {((isMoving: boolean) => void)[]} */
const watchers = [];
/** @param {(isMoving: boolean) => void} watch told of every move; `isMoving` while the part is held */
export const onPlace = (watch) => void watchers.push(watch);

/** @type {{ back: Place[], ahead: Place[] }} */
const steps = { back: [], ahead: [] };
const STEPS = 200;

const before = keptOver('place', () => ({ place, steps }));
if (before) {
  Object.assign(place, before.place);
  Object.assign(steps, before.steps);
}

const copy = () => ({ ...place });
/** @param {Place} to */
function put(to) {
  Object.assign(place, to);
  watchers.forEach((watch) => watch(false));
}

/** Remembers the place as it is, to come back to. */
export function remember() {
  steps.back.push(copy());
  if (steps.back.length > STEPS) steps.back.shift();
  steps.ahead.length = 0;
}

/** Moves the part; what moves it step by step remembers the first place itself. @param {Partial<Place>} to @param {boolean} [isMoving] */
export function move(to, isMoving = false) {
  Object.assign(place, to);
  place.yaw_deg = ((((place.yaw_deg + 180) % 360) + 360) % 360) - 180;
  watchers.forEach((watch) => watch(isMoving));
}

/** Goes to a place, from which one can come back. @param {Place} to */
export function goTo(to) {
  remember();
  put(to);
}

export const canUndo = () => steps.back.length > 0;
export const canRedo = () => steps.ahead.length > 0;

export function undo() {
  const to = steps.back.pop();
  if (!to) return;
  steps.ahead.push(copy());
  put(to);
}

export function redo() {
  const to = steps.ahead.pop();
  if (!to) return;
  steps.back.push(copy());
  put(to);
}

/** Whether two places are the same. @param {Place} a @param {Place} b */
export const isSame = (a, b) => JSON.stringify(a) === JSON.stringify(b);
