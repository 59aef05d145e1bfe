// The figures of where the tool is: tiles, and a gauge for each joint.

import { card, el } from '../draw/dom.js';
import { giving } from '../draw/downloads.js';
import { clamp, fixed } from '../draw/scale.js';
import { FORCES, forceParts } from './arrows.js';
import { JOINT_COLOURS } from './colour.js';
import { ENDS, FOLD, JOINED, JOINT_ANGLES, JOINT_NAMES, LIMITS, ROWS, shownAngles } from './data.js';
import { AXES, axesAt } from './external-axes.js';
import { reasonText } from './map.js';
import { SCORED } from './path-mesh.js';
import { chosenState, current, currentJoints, currentPoint, onChange, state } from './state.js';

/** How far the forearm is turned against the base. deg @param {number[]} joints */
const sumOf = (joints) => joints[1] + FOLD * joints[2];

export function tiles() {
  const make = (/** @type {string} */ id, /** @type {string} */ name) => {
    const [value, unit_, more] = [el('span', { id }), el('span.u'), el('div.d', { id: `${id}-more` })];
    const tile = el('div.tile', {}, el('div.k', {}, name), el('div.v', {}, value, unit_), more);
    const show_ = (/** @type {string} */ number, /** @type {string} */ unitText, /** @type {string} */ words) => {
      [value.textContent, unit_.textContent, more.textContent] = [number, unitText, words];
    };
    return { tile, show: show_ };
  };
  const here = make('here', `${SCORED[0].toUpperCase()}${SCORED.slice(1)} error here`);
  const mean = make('mean', 'Mean of this case');
  const kappa = make('kappa', '1/κ here');
  const limit = make('limit', 'To the nearest limit');
  const lean = make('lean', 'Lean of the tool here');
  lean.tile.classList.add('wide');
  onChange(() => {
    const of = current();
    const i = currentPoint();
    const columns = of.columns;
    const chosen = chosenState();
    lean.tile.hidden = !columns.lead_deg;
    if (chosen) lean.show('–', '', 'along plans only');
    else if (columns.lead_deg) {
      const [feed, left, axis] = forceParts(of, i).map((part) => fixed(part, 0));
      const angles = `lead ${fixed(columns.lead_deg[i], 1)}°, tilt ${fixed(columns.tilt_deg[i], 1)}°`;
      lean.show(angles, '', `force ${fixed(FORCES[i], 0)} N: ${feed} along the feed, ${left} to its left, ${axis} along the axis of the path`);
    }
    if (!chosen) {
      const more = `total ${fixed(columns.total_mm[i])} mm`;
      here.show(fixed(columns.score_mm[i]), 'mm', more);
      kappa.show(fixed(columns.inverse_condition[i]), '', `limit ${LIMITS.inverse}`);
    } else {
      here.show(
        chosen.isAllowed ? fixed(chosen.score) : '–',
        'mm',
        chosen.isAllowed ? 'chosen in the map' : reasonText(chosen.reason),
      );
      kappa.show('–', '', 'along plans only');
    }
    mean.show(fixed(of.mean), 'mm', `largest ${fixed(of.max)} mm`);
    if (chosen && !chosen.isAllowed) return limit.show('–', '', 'state not allowed');
    const joints = currentJoints();
    const gaps = ROWS.map((row, j) => Math.min(joints[j] - row.min, row.max - joints[j]));
    if (JOINED) gaps.push(Math.min(sumOf(joints) - JOINED.min, JOINED.max - sumOf(joints)));
    const nearest = gaps.indexOf(Math.min(...gaps));
    limit.show(fixed(gaps[nearest], 1), '°', nearest < ROWS.length ? `joint ${nearest + 1}` : 'joints 2+3');
  });
  return el('div.tiles', {}, here.tile, mean.tile, kappa.tile, limit.tile, lean.tile);
}

/**
 * @typedef {{
 *   name: string, low: number, high: number, unit: string, colour: string, id: string,
 *   now: () => number, used: () => number[], shown?: (value: number) => number
 * }} Gauge something that moves within a range; `used` are its values along the path, `shown` is what is written of one
 */

/** What is written of an angle of a joint, the others as they are now. @param {number} j @param {number} angle */
const shownOf = (j, angle) => shownAngles(currentJoints().map((now, k) => (k === j ? angle : now)))[j];

/** @returns {Gauge[]} the joints, and the external axes behind them */
function gaugesOf() {
  const joints = ENDS.map(([low, high], j) => ({
    name: JOINT_NAMES[j],
    low,
    high,
    unit: '°',
    colour: JOINT_COLOURS[j],
    id: `joint-${j + 1}`,
    now: () => currentJoints()[j],
    used: () => current().joints.map((angles) => angles[j]),
    shown: (/** @type {number} */ angle) => shownOf(j, angle),
  }));
  const axes = AXES.map((axis, k) => ({
    name: axis.name,
    low: axis.range[0],
    high: axis.range[1],
    unit: axis.isRail ? ' mm' : '°',
    colour: '--accent',
    id: `axis-${k + 1}`,
    now: () => axesAt(current(), state.t)[k],
    used: () => Array.from(current().columns[axis.column]),
  }));
  const sums = (JOINED ? [JOINED] : []).map((range) => ({
    name: 'θ2+θ3',
    low: range.min,
    high: range.max,
    unit: '°',
    colour: JOINT_COLOURS[2],
    id: 'joints-2-3',
    now: () => sumOf(currentJoints()),
    used: () => current().joints.map(sumOf),
  }));
  return [...joints, ...sums, ...axes];
}

export function gauges() {
  const rows = gaugesOf().map((gauge) => {
    const [range, pin, value] = [el('div.rng'), el('div.pin'), el('b', { id: gauge.id })];
    const ends = [el('span'), el('span')];
    const shown = gauge.shown ?? ((/** @type {number} */ number) => number);
    range.style.background = pin.style.background = `var(${gauge.colour})`;
    const host = el(
      'div.g',
      {},
      el('b', { title: gauge.name }, gauge.name),
      ends[0],
      el('div.rail', {}, range, pin),
      ends[1],
      value,
    );
    const share_ = (/** @type {number} */ at) => (100 * (at - gauge.low)) / (gauge.high - gauge.low || 1);
    return { gauge, host, range, pin, value, share_, shown, ends };
  });
  onChange(({ case: isOther }) => {
    rows.forEach(({ gauge, range, pin, value, share_, shown, ends }) => {
      const at = gauge.now();
      pin.style.left = `${clamp(share_(at), 0, 100)}%`;
      value.textContent = `${fixed(shown(at), 1)}${gauge.unit}`;
      [gauge.low, gauge.high].forEach((end, k) => void (ends[k].textContent = fixed(shown(end), 0)));
      if (!isOther) return;
      const [least, most] = gauge.used().map(share_).reduce(([a, b], v) => [Math.min(a, v), Math.max(b, v)], [100, 0]);
      range.style.left = `${least}%`;
      range.style.width = `${most - least}%`;
    });
  });
  const words = `deg ${JOINT_ANGLES}${JOINED ? ', θ2+θ3 of the rows' : ''}${AXES.some((axis) => axis.isRail) ? ', rails in mm' : ''}; shaded: range over the whole path`;
  const out = card(AXES.length ? 'Joints and external axes now' : 'Joints now', words, el(AXES.length ? 'div.gauges.named' : 'div.gauges', {}, ...rows.map((row) => row.host)));
  const figures = () => rows.map(({ gauge, shown }) => [gauge.name, ...[gauge.low, gauge.now(), gauge.high].map(shown)]);
  return giving(out, { rows: () => [['axis', 'from', 'now', 'to'], ...figures()] });
}
