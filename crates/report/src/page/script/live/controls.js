// The part by numbers and keys: fields, external axes, orientation, and the steps back and forth.

import { card, choice, el } from '../draw/dom.js';
import { fixed } from '../draw/scale.js';
import { RAW } from '../run/data.js';
import { AXES } from '../run/external-axes.js';
import { hand } from './drag.js';
import { onAnswer } from './follow.js';
import { canRedo, canUndo, goTo, move, onPlace, place, redo, remember, undo } from './place.js';
/** @import { Place } from './place.js' */

/** @type {[keyof Place & ('x_mm' | 'y_mm' | 'z_mm' | 'yaw_deg'), string, number][]} */
const FIELDS = [
  ['x_mm', 'x mm', 1],
  ['y_mm', 'y mm', 1],
  ['z_mm', 'z mm', 1],
  ['yaw_deg', 'yaw °', 0.5],
];

/** Keys that move the part: which coordinate, and by how much. @type {Record<string, [typeof FIELDS[number][0], number]>} */
const KEYS = {
  ArrowLeft: ['x_mm', -1],
  ArrowRight: ['x_mm', 1],
  ArrowDown: ['y_mm', -1],
  ArrowUp: ['y_mm', 1],
  PageDown: ['z_mm', -1],
  PageUp: ['z_mm', 1],
  '[': ['yaw_deg', 0.5],
  ']': ['yaw_deg', -0.5],
};

/** A field of a number that is moved as it is typed. @param {string} id @param {string} name @param {number} step @param {() => number} get @param {(value: number) => void} put @param {Record<string, any>} [more] */
function numberField(id, name, step, get, put, more = {}) {
  const field = /** @type {HTMLInputElement} */ (el('input', { type: 'number', id, step: 'any', ...more }));
  let isTyping = false;
  field.addEventListener('focus', () => (isTyping = false));
  field.addEventListener('keydown', (event) => {
    const by = { ArrowUp: step, ArrowDown: -step }[event.key];
    if (!by) return;
    event.preventDefault();
    remember();
    put(get() + by * (event.shiftKey ? 10 : 1));
  });
  field.addEventListener('input', () => {
    const value = field.valueAsNumber;
    field.setAttribute('aria-invalid', String(!Number.isFinite(value)));
    if (!Number.isFinite(value)) return;
    if (!isTyping) remember();
    isTyping = true;
    put(value);
  });
  field.addEventListener('blur', () => {
    isTyping = false;
    field.removeAttribute('aria-invalid');
    show();
  });
  const show = () => {
    if (!isTyping) field.value = fixed(get(), 3).replace('–', '').replace(/\.?0+$/, '') || '0';
  };
  // While the part is held, with the figures: what is drawn before them would be in their way.
  onPlace((isMoving) => isMoving || show());
  onAnswer(show);
  show();
  return el('label.field', {}, el('span', {}, name), field);
}

/** The position of an axis, where it stands still along the path; of one that moves its first. @param {number} k */
const axisAt = (k) => place.external_axes?.positions[0][k] ?? 0;

/** @param {number} k @param {number} at */
function moveAxis(k, at) {
  const row = AXES.map((_, j) => (j === k ? at : axisAt(j)));
  move({ external_axes: { for_each: 'path', positions: [row] } }, true);
}

function axisFields() {
  return AXES.map((axis, k) => {
    const [low, high] = axis.range;
    const name = `${axis.name} ${axis.isRail ? 'mm' : '°'}`;
    const slider = /** @type {HTMLInputElement} */ (
      el('input', { type: 'range', min: low, max: high, step: 'any', 'aria-label': `${axis.name}, ${fixed(low, 0)} to ${fixed(high, 0)}` })
    );
    let isHeld = false;
    slider.addEventListener('pointerdown', () => (isHeld = false));
    slider.addEventListener('input', () => {
      if (!isHeld) remember();
      isHeld = true;
      moveAxis(k, slider.valueAsNumber);
    });
    slider.addEventListener('change', () => (isHeld = false));
    onPlace(() => (slider.value = String(axisAt(k))));
    slider.value = String(axisAt(k));
    const moves = el('span.sub');
    onPlace(() => (moves.textContent = place.external_axes && place.external_axes.for_each !== 'path' ? 'moves along the path; a change holds it still' : ''));
    return el('div.axis', {}, numberField(`axis-field-${k + 1}`, name, 1, () => axisAt(k), (at) => moveAxis(k, at), { min: low, max: high }), slider, moves);
  });
}

function orientationChoice() {
  /** @type {string[]} */
  const names = RAW.live.orientations;
  if (names.length < 2) return null;
  return choice(
    'Orientation of the part',
    names,
    () => Math.max(0, names.indexOf(place.orientation ?? '')),
    (k) => goTo({ ...place, orientation: names[k] }),
    (refresh) => onPlace(refresh),
  );
}

/** The card that moves the part. */
export function controlsCard() {
  const fields = FIELDS.map(([key, name, step]) => numberField(`field-${key}`, name, step, () => place[key], (value) => move({ [key]: value })));
  const ways = choice('What dragging the part does', ['Move', 'Lift', 'Turn'], () => ['move', 'lift', 'turn'].indexOf(hand.way), (k) => {
    hand.way = /** @type {const} */ (['move', 'lift', 'turn'])[k];
  });
  const [back, ahead] = [
    el('button.chip', { type: 'button', id: 'undo', onclick: undo }, 'Undo'),
    el('button.chip', { type: 'button', id: 'redo', onclick: redo }, 'Redo'),
  ];
  const steps = () => {
    /** @type {any} */ (back).disabled = !canUndo();
    /** @type {any} */ (ahead).disabled = !canRedo();
  };
  onPlace(steps);
  steps();
  const onkeydown = (/** @type {KeyboardEvent} */ event) => {
    const [key, by] = KEYS[event.key] ?? [];
    if (!key || event.ctrlKey || event.metaKey || event.altKey) return;
    event.preventDefault();
    event.stopPropagation();
    if (!event.repeat) remember();
    move({ [key]: place[key] + (by ?? 0) * (event.shiftKey ? 10 : 1) });
  };
  const pad = el('div.pad', { id: 'part', tabindex: 0, role: 'application', 'aria-label': 'The part: arrow keys move it in x and y, Page Up and Down lift it, brackets turn it; with shift ten times as far', onkeydown },
    'Arrows, Page ↑ ↓, [ ] move the part from here');
  return card(
    'Part',
    'drag it in the view; shift lifts, alt turns',
    el('div.row', {}, ways, back, ahead),
    el('div.fields', {}, ...fields),
    pad,
    el('div.row', {}, orientationChoice()),
    ...axisFields(),
  );
}

/** Undo and redo by the usual keys, wherever no text is typed. @param {KeyboardEvent} event */
export function onUndoKey(event) {
  if (!(event.ctrlKey || event.metaKey) || event.altKey) return;
  const key = event.key.toLowerCase();
  if (key === 'z') (event.shiftKey ? redo : undo)();
  else if (key === 'y') redo();
  else return;
  event.preventDefault();
}
