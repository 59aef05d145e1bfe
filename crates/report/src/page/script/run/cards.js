// Cards for what the run has: the summary, warnings and notes first of all, then what the search and the proofs say.

import { chartCard, legendOf } from '../draw/chart.js';
import { card, el, folded } from '../draw/dom.js';
import { fixed } from '../draw/scale.js';
import { FORCES } from './arrows.js';
import { alongPath, limitAt } from './charts.js';
import { CASES, COUNT, DOUBTS, ENDS, IS_SCORE, JOINT_NAMES, RAW, ROWS, SHORT_NAMES, singlesOf } from './data.js';
import { leanMapCard } from './lean-map.js';
import { jointSharesCard, originsCard } from './origins.js';
import { pathPoint } from './path.js';
import { smallTable } from './small-table.js';
import { current, onChange, set } from './state.js';
import { HAS_OTHERS, besideJoints, byJointOnPlan } from './yielding.js';
/** @import { Series } from '../draw/chart-data.js' */
/** @import { Case } from './data.js' */

/** The result in a few lines, as the terminal has it; a line that is about nothing goes on with the one before. */
function inShort() {
  const lines = RAW.document.summary ?? [];
  const rows = lines.map((/** @type {{about: string, text: string}} */ { about, text }) => [about ? el('dt', { 'data-level': DOUBTS.has(about) ? 'doubt' : null }, about) : null, el('dd', {}, about === 'held by' ? withBounds(text) : text)]);
  return lines.length ? [el('dl.short', { id: 'short' }, ...rows.flat())] : [];
}

/** What the result is in short and its warnings are in the open; notes are folded on the screen, and on paper those on how it was computed are left to the file. */
export function messages() {
  const list = (/** @type {string[]} */ said) => el('ul', {}, ...said.map((text) => el('li', {}, text)));
  const { notes, warnings } = RAW.document;
  const certificate = RAW.certificate?.warnings || [];
  const all = [...warnings, ...certificate.filter((/** @type {string} */ text) => !warnings.includes(text))];
  const parts = inShort();
  if (all.length)
    parts.push(
      el(
        'div.warnings',
        { role: 'note' },
        el('b', {}, all.length === 1 ? 'Warning' : `${all.length} warnings`),
        list(all),
      ),
    );
  if (notes.length) {
    const summary = el(
      'summary',
      {},
      notes.length === 1 ? '1 note' : `${notes.length} notes`,
      ' on what the result rests on',
    );
    const fold = folded(summary, list(notes));
    /** @type {string[]} */
    const computed = RAW.computed_notes ?? [];
    fold.querySelectorAll('li').forEach((note) => note.classList.toggle('screen', computed.includes(note.textContent ?? '')));
    if (computed.length) fold.append(el('p.paper', {}, `How it was computed (${computed.length} of these notes): notes.txt`));
    parts.push(fold);
  }
  return parts.length
    ? el('section.card.messages', { 'aria-label': 'Summary, warnings and notes', id: 'messages' }, ...parts)
    : null;
}

/** What is moved, by how much, where a gain is in a unit. @type {Record<string, [number, string]>} */
const MOVES = {
  'mm per mm': [100, '100 mm'],
  'mm per deg': [10, '10°'],
  'mm per deg/mm': [0.1, '0.1°/mm'],
  'mm per deg/s': [10, '10°/s'],
  'mm per 0.01': [1, '0.01'],
};

/** Names for the keys of the files. @type {Record<string, string>} */
const BOUND_NAMES = {
  'cell.x_mm': 'x of the cell',
  'cell.y_mm': 'y of the cell',
  'cell.z_mm': 'z of the cell',
  'cell.yaw_deg': 'yaw of the cell',
  'constraints.min_inverse_condition': 'conditioning of the arm',
  'redundancy.max_beta_rate_deg_per_mm': 'turn of the spindle about its axis along the path',
  'redundancy.max_spindle_turn_deg_per_mm': 'turn of the spindle in space along the path',
  'redundancy.max_spindle_turn_deg_per_s': 'turn of the spindle in time',
  'constraints.max_deflection_mm': 'largest deflection of a point',
  'constraints.min_base_distance_mm': 'distance of the path from axis 1',
  'lean.lead_deg': 'lead of the tool',
  'lean.tilt_deg': 'tilt of the tool',
  'lean.max_lean_deg': 'lean of the tool',
  'lean.scallop_mm': 'scallop height',
  'lean.step_over_mm': 'step over',
  'lean.contact_tolerance_mm': 'contact off the path',
  'limit of axes 2+3': 'sum of joints 2 and 3',
};

/** A bound in words, and whether it is the upper one: of the angle of a joint that which the controller shows. @param {string} bound @param {boolean} isUpper @returns {[string, boolean]} */
function boundName(bound, isUpper) {
  const [, shapes] = bound.match(/^(?:collision\.clearance_mm|keep_out) of (.*)$/) ?? [];
  const joint = Number(bound.match(/^limit of joint (\d)$/)?.[1]) - 1;
  if (shapes) return [`distance of ${shapes}`, isUpper];
  return joint >= 0 ? [`angle ${JOINT_NAMES[joint]}`, isUpper === ENDS[joint][0] < ENDS[joint][1]] : [BOUND_NAMES[bound] ?? bound, isUpper];
}

/** A line of the summary with its bounds in words: there they are keys of the files. @param {string} text */
const withBounds = (text) =>
  text.replace(/([^,;]+?) \((upper|lower)\)/g, (_, bound, side) => {
    const [name, isUpper] = boundName(bound.trim(), side === 'upper');
    return `${bound.match(/^ */)?.[0]}${isUpper ? 'upper' : 'lower'} limit of ${name}`;
  });

/** A bound as a sentence: which it is, and what moving it would do. @param {any} bound @param {boolean} isWorst @returns {[string, string]} */
function boundWords({ bound, side, gain, unit }, isWorst) {
  const [name, isUpper] = boundName(bound, side === 'upper');
  const [factor, much] = MOVES[unit] ?? [1, `1 (${unit})`];
  // What is asked less of moves a lower bound down and an upper one up.
  const way = isUpper ? 'more' : 'less';
  const effect = Math.abs(gain * factor);
  const size = effect < 0.0005 ? 'less than 0.001' : fixed(effect, 3);
  return [`${isUpper ? 'Upper' : 'Lower'} limit: ${name}`, `would ${isWorst ? 'add' : 'save'} ${size} mm for ${much} ${way}`];
}

/** What holds the best and the worst placement. */
function boundsCard() {
  const held = CASES.filter((of) => of.plan === 0 && of.entry.active_bounds?.length);
  if (!held.length) return null;
  const rows = held.flatMap((of) =>
    of.entry.active_bounds.map((/** @type {any} */ bound) => [of.place ? 'Worst' : 'Best', ...boundWords(bound, of.place === 1)]),
  );
  return card(
    'What holds the placements',
    'to first order; the file has the keys',
    smallTable(['Placement', 'Held by', 'What moving it would do'], rows),
  );
}

/** The setups that were searched, the best first. */
function setupsCard() {
  const setups = RAW.document.setups;
  if (!setups?.length) return null;
  const axes = setups[0].external_axes?.axes ?? [];
  const hasOrientation = setups.some((/** @type {any} */ one) => one.orientation !== undefined);
  const mm = (/** @type {number | null} */ value) => (value === null ? '–' : fixed(value, 4));
  const at = (/** @type {any} */ one, /** @type {number} */ k) => {
    const all = (one.external_axes?.positions ?? []).map((/** @type {number[]} */ row) => row[k]);
    const [least, most] = [Math.min(...all), Math.max(...all)].map((end) => fixed(end, 1));
    return least === most ? least : `${least} … ${most}`;
  };
  const sorted = [...setups].sort((a, b) => (a.best_objective_mm ?? Infinity) - (b.best_objective_mm ?? Infinity));
  const hasWorst = setups.some((/** @type {any} */ one) => one.worst_objective_mm !== null);
  const rows = sorted.map((one) => [
    ...(hasOrientation ? [one.orientation ?? '–'] : []),
    ...axes.map((/** @type {any} */ _, /** @type {number} */ k) => at(one, k)),
    mm(one.best_objective_mm),
    ...(hasWorst ? [mm(one.worst_objective_mm)] : []),
  ]);
  const heads = [
    ...(hasOrientation ? ['Part'] : []),
    ...axes.map((/** @type {any} */ axis) => `${axis.name} ${axis.unit}`),
    'Best mm',
    ...(hasWorst ? ['Worst mm'] : []),
  ];
  return card('Setups that were searched', 'objective of the best placement in each, the best first', smallTable(heads, rows));
}

/** The three points of a case that deflect most, away from each other. */
function worstPointsCard() {
  const host = el('div.worst-points');
  const near = Math.max(1, Math.round(COUNT / 30));
  const shares = (/** @type {number} */ i) => {
    const parts = [...byJointOnPlan(current(), i), ...(HAS_OTHERS ? [besideJoints(current(), i)] : [])];
    const all = parts.reduce((a, b) => a + b, 0);
    return parts.map((part) => fixed(all ? (part / all) * 100 : 0, 0));
  };
  onChange(({ case: isOther }) => {
    if (!isOther) return;
    const { columns } = current();
    const order = Array.from(columns.score_mm.keys()).sort((a, b) => columns.score_mm[b] - columns.score_mm[a]);
    /** @type {number[]} */
    const chosen = [];
    for (const i of order) {
      if (chosen.length < 3 && chosen.every((other) => Math.abs(other - i) > near)) chosen.push(i);
    }
    const rows = chosen.map((i) => [
      el('button.chip', { type: 'button', onclick: () => set({ t: i }) }, `point ${pathPoint(i)}`),
      String(columns.segment[i]),
      fixed(columns.score_mm[i], 3),
      fixed(columns.total_mm[i], 3),
      fixed(FORCES[i], 0),
      ...shares(i),
    ]);
    const joints = ROWS.map((_, j) => `A${j + 1} %`);
    const heads = ['Go to', 'Segment', 'Scored mm', 'Whole mm', 'Force N', ...joints, ...(HAS_OTHERS ? ['Other %'] : [])];
    host.replaceChildren(smallTable(heads, rows));
  });
  const hint = 'the three that deflect most, apart from each other, and what each joint gives of the scored part';
  return card('Worst points of this case', hint, host);
}

/** The genetic searches, generation by generation. */
function convergenceCard() {
  if (!RAW.convergence) return null;
  const columns = RAW.convergence;
  const [generation, best] = [singlesOf(columns.generation), singlesOf(columns.best_mm)];
  const of = (/** @type {string} */ search) =>
    columns.search
      .map((/** @type {string} */ name, /** @type {number} */ k) => (name === search ? k : -1))
      .filter((/** @type {number} */ k) => k >= 0);
  /** @param {string} search @param {string} color @returns {Series} */
  const line = (search, color) => ({
    name: `${search} so far`,
    style: search === 'best' ? 'line' : 'dashed',
    x: of(search).map((/** @type {number} */ k) => generation[k]),
    y: of(search).map((/** @type {number} */ k) => best[k]),
    color,
    width: 2,
  });
  const series = [line('best', '--good'), line('worst', '--bad')].filter((one) => one.y.length);
  const values = series.flatMap((one) => Array.from(one.y)).filter(Number.isFinite);
  if (!values.length) return null;
  const out = chartCard({
    title: 'Search',
    detail: series.length > 1 ? 'best and worst objective over generations' : 'best objective over generations',
    x: { label: 'generation', is_log: false },
    y: { label: 'objective (mm)', is_log: false, range: [0, Math.max(.../** @type {number[]} */ (values)) * 1.05] },
    series,
  });
  out.classList.add('search');
  return out;
}

/** How far the placements can be from the best and the worst possible. */
function certificateCard() {
  const found = RAW.certificate;
  if (!found) return null;
  const sides = /** @type {[string, any, string | null][]} */ ([
    ['Best', found.best, found.best_reason],
    ['Worst', found.worst, found.worst_reason],
  ]);
  const rows = [];
  const words = found.sentence ? [String(found.sentence)] : [];
  for (const [name, side, reason] of sides) {
    if (side) {
      const gap = `${fixed(side.gap_percent, 3)} %`;
      rows.push([name, fixed(side.value_mm, 4), fixed(side.bound_mm, 4), gap, String(side.open_boxes)]);
      words.push(`${name}: left out of the bound: ${side.limits_relaxed.join('; ') || 'nothing'}.`);
      words.push(...openRegion(name));
    }
    if (reason) words.push(`${name}: ${reason}.`);
  }
  const heads = ['Placement', 'Found mm', 'Bound mm', 'Gap', 'Open boxes'];
  const said = words.map((text) => el('p.sub', {}, text));
  const table = rows.length ? [smallTable(heads, rows)] : [];
  return card('Certificate', `a gap of ${found.gap_percent_asked} % was asked for`, ...table, ...said);
}

/** Where a better or a worse placement is not excluded. @param {string} name @returns {string[]} */
function openRegion(name) {
  const region = RAW.open_region?.[name.toLowerCase()];
  if (!region) return [];
  const span = (/** @type {string} */ key, /** @type {string} */ unitText) => `${fixed(region[key][0], 1)} to ${fixed(region[key][1], 1)}${unitText}`;
  return [
    `${name}: not excluded within ${span('radius_mm', ' mm')} from the axis of joint 1, z ${span('z_mm', ' mm')}, yaw less azimuth ${span('yaw_less_azimuth_deg', '°')}.`,
  ];
}

/** How the objective answers to the stiffness of each joint, and what force errors would do. */
function sensitivityCard() {
  const known = CASES.filter((of) => of.entry.objective_by_stiffness?.length);
  const rows = known.map((of) => [
    SHORT_NAMES[of.number - 1],
    ...of.entry.objective_by_stiffness.map((/** @type {any} */ joint) => fixed(joint.percent_per_percent, 3)),
  ]);
  const what = '% of the objective per % of stiffness';
  const isFull = known[0]?.entry.objective_by_stiffness[0].spring !== undefined;
  const force = RAW.document.sensitivity;
  if (!rows.length && !force) return null;
  const parts = [];
  if (isFull) parts.push(springTable(what, known, rows));
  else if (rows.length) parts.push(smallTable([what, 'A1', 'A2', 'A3', 'A4', 'A5', 'A6'], rows));
  if (force) {
    const share_ = fixed(force.force_uncertainty * 100, 0);
    parts.push(
      el(
        'p.sub',
        {},
        `With force errors of ${share_} % the best placement moves by ${fixed(force.distance_mm, 1)} mm and ${fixed(force.turn_deg, 1)}°.`,
      ),
    );
  }
  return card('Sensitivity', 'to the stiffness of the joints and to the force', ...parts);
}

/** Of a full set, a row for each spring. @param {string} what @param {Case[]} known @param {string[][]} columns name and figures of each case */
function springTable(what, known, columns) {
  const springs = known[0].entry.objective_by_stiffness.map((/** @type {any} */ of, /** @type {number} */ k) => [
    of.spring,
    ...columns.map((column) => column[k + 1]),
  ]);
  return smallTable([what, ...columns.map(([name]) => name)], springs);
}

/** What the plans come to at the feed that the arm holds, where it is known how the forces change with the feed. */
function heldFeedCard() {
  const known = CASES.filter((of) => of.entry.at_held_feed);
  if (!known.length) return null;
  const rows = known.map((of) => {
    const { at_held_feed: held, mean_mm, max_mm } = of.entry;
    const figures_ = [mean_mm, max_mm, held.mean_mm, held.max_mm].map((mm) => fixed(mm, 4));
    return [SHORT_NAMES[of.number - 1], String(held.slowed_segments), ...figures_];
  });
  return card(
    'At the programmed and at the held feed',
    'a slower cut takes less force',
    smallTable(['Plan', 'Slower segments', 'Programmed: mean mm', 'Largest mm', 'Held: mean mm', 'Largest mm'], rows),
  );
}

/** What each stiffness set makes of the best placement. */
function setsCard() {
  const sets = RAW.document.stiffness_sets;
  if (!sets) return null;
  const rows = sets.sets.map((/** @type {any} */ one) => [
    one.robot,
    fixed(one.mean_mm, 4),
    fixed(one.best_alone_mm, 4),
    one.regret === null ? '–' : `${fixed(one.regret * 100, 2)} %`,
  ]);
  return card(
    'Stiffness sets',
    'the best placement under each',
    smallTable(['Robot file', 'Mean mm', 'Best alone mm', 'Regret'], rows),
  );
}

/** Critical depth of cut along the path. */
function stabilityCard() {
  const said = RAW.document.stability;
  if (!said || !RAW.depths) return null;
  const depths = RAW.depths.map((/** @type {any} */ columns) => singlesOf(columns.critical_depth_mm));
  const most = Math.max(said.max_depth_mm || 0, said.axial_depth_mm) * 1.1;
  const names = (IS_SCORE ? ['best plan', 'worst plan'] : ['best placement', 'worst placement']).slice(0, depths.length);
  /** @type {Series[]} */
  const series = depths.map((/** @type {Float32Array} */ y, /** @type {number} */ k) => ({
    name: names[k],
    style: k ? 'dashed' : 'line',
    y,
    color: k ? '--bad' : '--good',
    width: 2,
  }));
  const y = { label: 'mm', is_log: false, range: /** @type {[number, number]} */ ([0, most]) };
  const chart = alongPath('Critical depth', () => ({ y, series, marks: [limitAt(said.axial_depth_mm)] }));
  const words = names.map((name, k) => {
    const one = k ? said.worst : said.best;
    return `${name}: ${one.stable ? 'stable at every point' : `chatters at ${one.points_that_chatter} points`}`;
  });
  return card(
    'Critical depth of cut',
    `mm; the cut is ${said.axial_depth_mm} mm deep, no line: stable beyond ${said.max_depth_mm} mm. ${words.join('; ')}`,
    chart.host,
    el('div.legend', {}, ...legendOf(series)),
  );
}

export function furtherCards() {
  const cards = [
    worstPointsCard(),
    leanMapCard(),
    jointSharesCard(),
    setupsCard(),
    originsCard(),
    heldFeedCard(),
    boundsCard(),
    sensitivityCard(),
    setsCard(),
    certificateCard(),
    stabilityCard(),
    convergenceCard(),
  ].filter(Boolean);
  // What scrolls can be reached by keys.
  onChange(({ size: resized }) => {
    if (!resized) return;
    for (const one of /** @type {HTMLElement[]} */ (cards)) {
      if (one.scrollWidth > one.clientWidth) one.tabIndex = 0;
      else one.removeAttribute('tabindex');
    }
  });
  return cards.length ? el('div.further', {}, .../** @type {HTMLElement[]} */ (cards)) : null;
}
