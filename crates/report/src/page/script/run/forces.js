// The forces along the path, as arrows and as a chart.

import { legendOf } from '../draw/chart.js';
import { card, choice, el } from '../draw/dom.js';
import { clamp, fixed } from '../draw/scale.js';
import { alongPath } from './charts.js';
import { COUNT, REMOVAL, TASK } from './data.js';
import { add, size, times } from './linear.js';
import { lathe, mesh } from './mesh.js';
import { PATH_SIZE } from './path-mesh.js';
import { RUNS } from './path.js';
import { currentPoint, onChange, set, state } from './state.js';
/** @import { Series } from '../draw/chart-data.js' */
/** @import { Mesh } from './mesh.js' */

/** No more arrows than this: a longer path has one at every so many points. */
const MOST_ARROWS = 100;
/** Length of the longest arrow, over the size of the path. */
const LONGEST = 0.2;
const ARROW = [214, 72, 58];

/** Sizes of the forces at the drawn points, in N. */
const SIZES = REMOVAL ? REMOVAL.force.map(size) : [];

/** The largest force of a drawn point, in N. */
export const LARGEST_FORCE = SIZES.reduce((a, b) => Math.max(a, b), 0);

/** What the workpiece does to the tool, as arrows from the tool centre point in the workpiece frame. @returns {Mesh} */
export function forceArrows() {
  const out = mesh();
  if (!REMOVAL || !LARGEST_FORCE) return out;
  const scale = (LONGEST * PATH_SIZE) / LARGEST_FORCE;
  const thin = clamp(PATH_SIZE * 0.003, 0.5, 2.5);
  const stride = Math.ceil(COUNT / MOST_ARROWS);
  for (const [first, last] of RUNS) {
    for (let i = first; i <= last; i += stride) {
      const length = SIZES[i] * scale;
      if (length < 4 * thin) continue;
      const neck = length - Math.min(8 * thin, length / 2);
      const profile = /** @type {[number, number][]} */ ([
        [0, thin],
        [neck, thin],
        [neck, 2.6 * thin],
        [length, 0],
      ]);
      lathe(out, TASK.position[i], add(TASK.position[i], times(REMOVAL.force[i], scale)), profile, 8, ARROW);
    }
  }
  return out;
}

/** @typedef {{ name: string, unit: string, digits: number, curves: [string, ArrayLike<number>, string, 'line' | 'dashed'][] }} Reading a chart: its curves by name, values and colour */

/** @returns {Reading[]} what can be seen along the path */
function readings() {
  if (!REMOVAL) return [];
  const of = REMOVAL.columns;
  return [
    {
      name: 'force',
      unit: 'N',
      digits: 1,
      curves: [
        ['largest in a turn', of.largest_n, '--soft', 'dashed'],
        ['of it, edges', of.edge_n, '--j3', 'line'],
        ['of it, chips', of.chip_n, '--j2', 'line'],
        ['mean over a turn', SIZES, '--accent', 'line'],
      ],
    },
    { name: 'moment', unit: 'N m', digits: 3, curves: [['mean over a turn', of.moment_nm, '--accent', 'line']] },
    { name: 'removed', unit: 'mm³/mm', digits: 2, curves: [['removed', of.removed_mm3_per_mm, '--accent', 'line']] },
    {
      name: 'height',
      unit: 'mm',
      digits: 2,
      curves: [
        ['lowest that cuts', of.lowest_mm, '--j2', 'line'],
        ['highest', of.highest_mm, '--accent', 'line'],
      ],
    },
    {
      name: 'angle',
      unit: '°',
      digits: 0,
      curves: [
        ['a tooth enters', of.entry_deg, '--j2', 'line'],
        ['it leaves', of.exit_deg, '--accent', 'line'],
      ],
    },
    { name: 'chip', unit: 'µm', digits: 1, curves: [['thickest', of.chip_um, '--accent', 'line']] },
  ];
}

/** @returns {HTMLElement | null} where the run has a stock */
export function forcesCard() {
  if (!REMOVAL) return null;
  const all = readings();
  const highest = REMOVAL.columns.highest_mm;
  let shown = 0;
  /** @returns {Series[]} */
  const series = () =>
    all[shown].curves.map(([name, values, color, style]) => ({
      name,
      y: Array.from(values),
      color,
      style,
      width: style === 'dashed' ? 1 : 2,
    }));
  const make = () => {
    const values = all[shown].curves.flatMap(([, list]) => Array.from(list)).filter(Number.isFinite);
    const [least, most] = values.reduce(([a, b], value) => [Math.min(a, value), Math.max(b, value)], [0, 0]);
    const range = /** @type {[number, number]} */ ([least, most > least ? most + 0.05 * (most - least) : least + 1]);
    return { y: { label: all[shown].unit, is_log: false, range }, series: series() };
  };
  const chart = alongPath('Forces of the cut', make, { digits: 1, chosen: () => (state.chosen ? [NaN] : null) });
  const legend = el('div.legend', {}, ...legendOf(series()));
  const parts = choice(
    'What is seen of the cut',
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
  const out = card('Forces of the cut', '', chart.host, legend);
  out.style.marginTop = '14px';
  parts.style.flexWrap = 'wrap';
  /** @type {HTMLElement} */ (out.firstChild).append(parts);
  const words = /** @type {HTMLElement} */ (out.querySelector('.sub'));
  onChange(() => {
    const i = currentPoint();
    const isCutting = Number.isFinite(highest[i]);
    const { unit, digits, curves } = all[shown];
    const value = curves[curves.length - 1][1][i];
    words.textContent = isCutting ? `${unit}; here ${fixed(value, digits)}` : `${unit}; nothing is cut here`;
  });
  return out;
}
