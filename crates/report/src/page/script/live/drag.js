// The part taken by the pointer: moved in the plane, lifted, or turned about the vertical.

import { CASES } from '../run/data.js';
import { axesAt, carriedBy, workpieceFrame } from '../run/external-axes.js';
import { inverseOf, less, moved, turned } from '../run/linear.js';
import { EXTENT, PATH_SIZE } from '../run/path-mesh.js';
import { viewRay } from '../run/scene-card.js';
import { set, state } from '../run/state.js';
import { blockBox } from '../run/surroundings.js';
import { move, place, remember } from './place.js';
/** @import { Ray } from '../run/camera.js' */
/** @import { Vec } from '../run/linear.js' */

/** @typedef {'move' | 'lift' | 'turn'} Way */

/** What dragging the part does. @type {{ way: Way }} */
export const hand = { way: 'move' };

/** Movements as they happen, where the browser tells; else as often as it draws, which may be seldom. */
const MOVES = 'onpointerrawupdate' in window ? 'pointerrawupdate' : 'pointermove';

/** Where a ray meets the part, along it; null where it passes. @param {Ray} ray @returns {number | null} */
function hit(ray) {
  const frame = inverseOf(workpieceFrame(CASES[0], state.t));
  const [from, along] = [moved(frame, ray.from), turned(frame, ray.along)];
  const [low, high] = blockBox();
  const margin = 0.06 * PATH_SIZE;
  let [near, far] = [0, Infinity];
  for (let k = 0; k < 3; k++) {
    const ends = [Math.min(low[k], EXTENT[k][0]) - margin, Math.max(high[k], EXTENT[k][1]) + margin].map((end) => (end - from[k]) / along[k]);
    near = Math.max(near, Math.min(...ends));
    far = Math.min(far, Math.max(...ends));
  }
  return near <= far ? near : null;
}

/** Where a ray meets a level. @param {Ray} ray @param {number} z @returns {Vec | null} */
function onLevel({ from, along }, z) {
  const at = (z - from[2]) / along[2];
  return Number.isFinite(at) && at > 0 ? from.map((value, k) => value + at * along[k]) : null;
}

/** Lets the part be taken in a view. @param {HTMLElement} view */
export function draggable(view) {
  /** @type {{ pointer: number, x: number, y: number, way: Way, at: Vec, distance: number, start: Vec, yaw: number, last: Vec | null, turned: number } | null} */
  let held = null;
  const wayOf = (/** @type {PointerEvent} */ event) => (event.shiftKey ? 'lift' : event.altKey || event.ctrlKey ? 'turn' : hand.way);
  const stop = (/** @type {Event} */ event) => {
    event.stopPropagation();
    event.preventDefault();
  };
  view.addEventListener(
    'pointerdown',
    (event) => {
      if (held || event.button !== 0 || !(event.target instanceof HTMLCanvasElement)) return;
      const ray = viewRay(event.clientX, event.clientY);
      const distance = hit(ray);
      if (distance === null) return;
      stop(event);
      view.focus();
      event.target.setPointerCapture(event.pointerId);
      remember();
      set({ scene: true, isHeld: true });
      const at = ray.from.map((value, k) => value + distance * ray.along[k]);
      const start = [place.x_mm, place.y_mm, place.z_mm];
      held = { pointer: event.pointerId, x: event.clientX, y: event.clientY, way: wayOf(event), at, distance, start, yaw: place.yaw_deg, last: null, turned: 0 };
    },
    { capture: true },
  );
  const follow = (/** @type {PointerEvent} */ event) => {
    if (held?.pointer !== event.pointerId) return;
    stop(event);
    const by = event.type === MOVES && dragged(held, event, view);
    if (by) move(by, true);
  };
  new Set([MOVES, 'pointermove']).forEach((type) => view.addEventListener(type, /** @type {any} */ (follow), { capture: true }));
  const end = (/** @type {PointerEvent} */ event) => {
    if (held?.pointer !== event.pointerId) return;
    stop(event);
    held = null;
    set({ scene: true, isHeld: false });
    move({});
  };
  view.addEventListener('pointerup', end, { capture: true });
  view.addEventListener('pointercancel', end, { capture: true });
  // A finger on the part moves it, and does not scroll.
  view.addEventListener(
    'touchstart',
    (event) => {
      const finger = event.touches[0];
      if (event.touches.length === 1 && hit(viewRay(finger.clientX, finger.clientY)) !== null) event.preventDefault();
    },
    { passive: false },
  );
  view.addEventListener('pointermove', (event) => {
    if (!held && event.target instanceof HTMLCanvasElement && event.pointerType === 'mouse' && !event.buttons)
      event.target.style.cursor = hit(viewRay(event.clientX, event.clientY)) === null ? '' : 'move';
  });
}

/** What a drag has come to. @param {any} held @param {PointerEvent} event @param {HTMLElement} view */
function dragged(held, event, view) {
  // Axes that carry the part have turned its directions.
  const back = inverseOf(carriedBy('workpiece', axesAt(CASES[0], state.t)));
  if (held.way === 'lift') {
    const scale = (held.distance * 0.63) / Math.max(view.clientHeight, 1);
    const [x, y, z] = turned(back, [0, 0, (held.y - event.clientY) * scale]);
    return { x_mm: held.start[0] + x, y_mm: held.start[1] + y, z_mm: held.start[2] + z };
  }
  const at = onLevel(viewRay(event.clientX, event.clientY), held.at[2]);
  if (!at) return null;
  if (held.way === 'turn') {
    const origin = moved(workpieceFrame(CASES[0], state.t), [0, 0, 0]);
    const [from, to] = [less(held.last ?? held.at, origin), less(at, origin)];
    held.last = at;
    held.turned += (Math.atan2(from[0] * to[1] - from[1] * to[0], from[0] * to[0] + from[1] * to[1]) * 180) / Math.PI;
    return { yaw_deg: held.yaw + held.turned };
  }
  const [x, y, z] = turned(back, less(at, held.at));
  return { x_mm: held.start[0] + x, y_mm: held.start[1] + y, z_mm: held.start[2] + z };
}
