// The table of cases: a row selects its case.

import { card, el } from '../draw/dom.js';
import { fixed } from '../draw/scale.js';
import { cssOf } from '../draw/theme.js';
import { colourOf } from './colour.js';
import { CASES, RAW, postureText } from './data.js';
import { AXES, PART_TURNS } from './external-axes.js';
import { onChange, set, state } from './state.js';
/** @import { Case } from './data.js' */
/** @import { ExternalAxis } from './external-axes.js' */

/** Postures in a few characters: repeated ones are counted. @param {string[]} postures */
function posturesText(postures) {
  /** @type {[string, number][]} */
  const runs = [];
  for (const posture of postures) {
    const last = runs[runs.length - 1];
    if (last && last[0] === posture) last[1]++;
    else runs.push([posture, 1]);
  }
  const text = runs
    .map(([posture, count]) => (count > 2 ? `${posture}×${count}` : Array(count).fill(posture).join(' ')))
    .join(' ');
  return text.length > 40 ? `${postures.length} segments` : text;
}

/** Where an external axis stands along a plan: one position, or the least and the largest. @param {Case} of @param {ExternalAxis} axis */
function positionsText(of, axis) {
  const at = of.columns[axis.column];
  const [least, most] = [at.reduce((a, b) => Math.min(a, b)), at.reduce((a, b) => Math.max(a, b))].map((end) => fixed(end, 1));
  return least === most ? least : `${least} … ${most}`;
}

export function casesCard() {
  const worst = CASES.reduce((most, of) => Math.max(most, of.mean), 0) || 1;
  const figures_ = RAW.document.reference?.case_mm;
  const heads = [
    'Case',
    'Mean',
    'Largest',
    'Ratio',
    ...(figures_ ? ['Published'] : []),
    'x, y, z mm',
    'Yaw',
    ...(PART_TURNS ? ['Part'] : []),
    ...AXES.map((axis) => `${axis.name} ${axis.isRail ? 'mm' : 'deg'}`),
    'Postures',
    ...(CASES[0].travel === null ? [] : ['Joint travel', 'Largest step']),
    'Cycle',
  ];
  const rows = CASES.map((of, k) => {
    const bar = el('span.bar2');
    bar.style.width = `${(of.mean / worst) * 60}px`;
    bar.style.background = cssOf(colourOf(of.mean));
    const { x, y, z, yaw } = of.at;
    const ratio = CASES[0].mean > 1e-6 ? fixed(of.mean / CASES[0].mean, 2) : '–';
    const cells = [
      el('td.words.breaks', {}, el('button', { type: 'button', onclick: () => set({ case: k }) }, of.name)),
      el('td.words', {}, bar, `${fixed(of.mean, 4)} mm`),
      el('td', {}, fixed(of.max)),
      el('td', {}, ratio),
      ...(figures_ ? [el('td', {}, String(figures_[k]))] : []),
      el('td', {}, [x, y, z].map((value) => fixed(value, 1)).join(', ')),
      el('td', {}, `${fixed(yaw, 1)}°`),
      ...(PART_TURNS ? [el('td', {}, of.entry.orientation || '–')] : []),
      ...AXES.map((axis) => el('td.breaks', {}, positionsText(of, axis))),
      el('td', { title: [...new Set(of.postures)].sort().map(postureText).join('; ') }, posturesText(of.postures)),
      ...(of.travel === null ? [] : [of.travel.total_deg, of.travel.max_step_deg].map((angle) => el('td', {}, `${fixed(angle, 0)}°`))),
      el('td', {}, of.cycle === null ? '–' : `${fixed(of.cycle, 1)} s`),
    ];
    return el('tr', { 'data-case': k + 1, onclick: () => set({ case: k }) }, ...cells);
  });
  onChange(({ case: isOther }) => {
    if (isOther) rows.forEach((row, k) => row.setAttribute('aria-selected', String(k === state.case)));
  });
  const head = el(
    'thead',
    {},
    el('tr', {}, ...heads.map((name, k) => el(k < 2 ? 'th.words' : 'th', { scope: 'col' }, name))),
  );
  const table = el('table', { id: 'cases' }, el('caption.sr', {}, 'The cases'), head, el('tbody', {}, ...rows));
  const out = card('Cases', 'a row shows its case', table);
  out.classList.add('scroll');
  out.tabIndex = 0;
  return out;
}
