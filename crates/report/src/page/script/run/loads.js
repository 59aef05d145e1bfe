// Force and deflection along the path, as a chart; with a stock also what the cut is.

import { legendOf } from '../draw/chart.js';
import { card, choice, el } from '../draw/dom.js';
import { fixed } from '../draw/scale.js';
import { FORCES, forceParts } from './arrows.js';
import { alongPath } from './charts.js';
import { REMOVAL } from './data.js';
import { current, currentPoint, onChange, set, state } from './state.js';
/** @import { Series } from '../draw/chart-data.js' */

/**
 * @typedef {{
 *   name: string, unit: string, digits: number, isOfCut?: boolean, curves: () => [string, ArrayLike<number>, string, 'line' | 'dashed'][]
 * }} Reading a chart: its curves by name, values and colour, the one that is read last; `isOfCut`: known only where something is cut
 */

/** @returns {Reading[]} what is known of every run */
function ofAll() {
  const part = (/** @type {number} */ k) => FORCES.map((_, i) => forceParts(current(), i)[k]);
  return [
    {
      name: 'force',
      unit: 'N',
      digits: 1,
      curves: () => [
        ['along the feed', part(0), '--j2', 'line'],
        ['to its left', part(1), '--j3', 'line'],
        ['along the tool axis', part(2), '--j4', 'line'],
        ['size', FORCES, '--accent', 'dashed'],
      ],
    },
    {
      name: 'deflection',
      unit: 'mm',
      digits: 4,
      curves: () => {
        const { feed_mm, normal_mm, axial_mm, total_mm } = current().columns;
        return [
          ['along the feed', feed_mm, '--j2', 'line'],
          ['to its left', normal_mm, '--j3', 'line'],
          ['along the tool axis', axial_mm, '--j4', 'line'],
          ['size', total_mm, '--accent', 'dashed'],
        ];
      },
    },
  ];
}

/** @returns {Reading[]} what is known of the cut, where the run has a stock */
function ofCut() {
  if (!REMOVAL) return [];
  const of = REMOVAL.columns;
  /** @param {string} name @param {string} unitText @param {number} digits @param {[string, ArrayLike<number>, string, 'line' | 'dashed'][]} curves @returns {Reading} */
  const reading = (name, unitText, digits, curves) => ({ name, unit: unitText, digits, isOfCut: true, curves: () => curves });
  return [
    reading('cutting', 'N', 1, [
      ['largest in a turn', of.largest_n, '--soft', 'dashed'],
      ['of it, edges', of.edge_n, '--j3', 'line'],
      ['of it, chips', of.chip_n, '--j2', 'line'],
      ['mean over a turn', FORCES, '--accent', 'line'],
    ]),
    reading('moment', 'N m', 3, [['mean over a turn', of.moment_nm, '--accent', 'line']]),
    reading('removed', 'mm³/mm', 2, [['removed', of.removed_mm3_per_mm, '--accent', 'line']]),
    reading('height', 'mm', 2, [
      ['lowest that cuts', of.lowest_mm, '--j2', 'line'],
      ['highest', of.highest_mm, '--accent', 'line'],
    ]),
    reading('angle', '°', 0, [
      ['a tooth enters', of.entry_deg, '--j2', 'line'],
      ['it leaves', of.exit_deg, '--accent', 'line'],
    ]),
    reading('chip', 'µm', 1, [['thickest', of.chip_um, '--accent', 'line']]),
  ];
}

export function loadsCard() {
  const all = [...ofCut(), ...ofAll()];
  const highest = REMOVAL?.columns.highest_mm;
  let shown = 0;
  /** @returns {Series[]} */
  const series = () =>
    all[shown].curves().map(([name, values, color, style]) => ({
      name,
      y: Array.from(values),
      color,
      style,
      width: style === 'dashed' ? 1.4 : 2,
    }));
  const make = () => {
    const made = series();
    const values = made.flatMap(({ y }) => Array.from(y, (value) => value ?? NaN)).filter(Number.isFinite);
    const [least, most] = values.reduce(([a, b], value) => [Math.min(a, value), Math.max(b, value)], [0, 0]);
    const space = 0.05 * (most - least) || 1;
    const range = /** @type {[number, number]} */ ([least < 0 ? least - space : 0, most + space]);
    return { y: { label: all[shown].unit, is_log: false, range }, series: made };
  };
  const chart = alongPath('Force and deflection', make, { digits: 3, chosen: () => (state.chosen ? [NaN] : null) });
  const legend = el('div.legend', {}, ...legendOf(series()));
  const parts = choice(
    'What is seen along the path',
    all.map(({ name }) => name),
    () => shown,
    (k) => {
      shown = k;
      chart.refresh();
      legend.replaceChildren(...legendOf(series()));
      set({});
    },
    onChange,
  );
  const out = card('Force and deflection', '', chart.host, legend);
  out.classList.add('loads');
  /** @type {HTMLElement} */ (out.firstChild).append(parts);
  const words = /** @type {HTMLElement} */ (out.querySelector('.sub'));
  onChange(() => {
    const i = currentPoint();
    const { unit: unitText, digits, isOfCut, curves } = all[shown];
    const last = curves()[curves().length - 1][1];
    const isCutting = !isOfCut || !highest || Number.isFinite(highest[i]);
    words.textContent = isCutting ? `${unitText}; here ${fixed(last[i], digits)}` : `${unitText}; nothing is cut here`;
  });
  return out;
}
