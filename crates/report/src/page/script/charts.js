// The charts along the path: deflection by direction, joints within their limits, conditioning, and clearance where it is known.

/** Deflections to choose from: words and columns. @type {[string, string][]} */
const DEFLECTIONS = /** @type {[string, string][]} */ ([
  ['wall', 'normal_mm'],
  ['surface', 'surface_mm'],
  ['axis', 'axial_mm'],
  ['total', 'total_mm'],
]).filter(([, column]) => column in CASES[0].columns);
let deflection = Math.max(
  0,
  DEFLECTIONS.findIndex(([name]) => name === DIRECTION),
);

/** Pointing to a chart moves the tool there. @param {number} x */
const moveTo = (x) => {
  pause();
  set({ t: Math.round(x) });
};

/** Says in the words of a card what its chart marks of a state that is chosen in the map. @param {HTMLElement} out @param {string} usual @param {() => string} told */
function sayChosen(out, usual, told) {
  const words = /** @type {HTMLElement} */ (out.querySelector('.sub'));
  onChange(() => {
    const chosen = chosenState();
    words.textContent = !chosen ? usual : `${usual}; ${chosen.isAllowed ? told() : 'the chosen state is not allowed'}`;
  });
  return out;
}

/** Of a state chosen in the map nothing is marked where only the plans have it. */
const notOfChosen = () => (state.chosen ? [NaN] : null);

/** @param {string} label @param {Partial<ChartWants> & { lines: () => Line[], range: () => [number, number] }} wants */
const alongPath = (label, wants) =>
  lineChart({
    label: `${label} along the path`,
    xRange: () => [0, Math.max(1, COUNT - 1)],
    xText: (x) => `point ${pathPoint(clamp(Math.round(x), 0, COUNT - 1))}`,
    breaks: () => RUNS.slice(1).map(([first]) => first - 0.5),
    cursor: () => state.t,
    onPoint: moveTo,
    ...wants,
  });

/** The case with the same plan at the other placement, and that with the other plan here. @returns {[Case | undefined, Case]} */
function beside() {
  const of = current();
  const find = (/** @type {number} */ place, /** @type {number} */ plan) =>
    CASES.find((one) => one.place === place && one.plan === plan);
  return [find(1 - of.place, of.plan), /** @type {Case} */ (find(of.place, 1 - of.plan))];
}

/** This case and those beside it as lines. @param {(of: Case) => Numbers} column @param {boolean} withPlan @returns {Line[]} */
function linesBeside(column, withPlan) {
  const [there, other] = beside();
  const lines = [];
  if (there) lines.push({ name: 'other placement', y: column(there), colour: '--soft', width: 1, dash: [3, 3] });
  const [own, else_] = current().plan ? ['--bad', '--good'] : ['--good', '--bad'];
  if (withPlan) lines.push({ name: 'other plan', y: column(other), colour: else_, width: 1, dash: [5, 3] });
  lines.push({ name: 'this case', y: column(current()), colour: withPlan ? own : '--accent', width: 2.2 });
  return lines;
}

/** Ticks at whole path points. @param {number} low @param {number} high */
const pointTicks = (low, high) => ticksBetween(low, high, 5).filter((x) => Number.isInteger(x) && x < COUNT);

function deflectionCard() {
  const absolute = (/** @type {Case} */ of) =>
    of.columns[DEFLECTIONS[deflection][1]].map((mm) => Math.max(Math.abs(mm), SCALE[0] / 100));
  const range = () => {
    const most = CASES.reduce((sum, of) => absolute(of).reduce((a, b) => Math.max(a, b), sum), 0);
    return /** @type {[number, number]} */ ([Math.min(SCALE[0], most / 100), Math.max(SCALE[1], most)]);
  };
  const isScored = () => DEFLECTIONS[deflection][0] === DIRECTION;
  const chart = alongPath('Deflection', {
    lines: () => linesBeside(absolute, true),
    range,
    log: true,
    xTicks: pointTicks,
    xText: pointText,
    digits: 4,
    chosen: () => {
      const chosen = chosenState();
      if (!chosen) return null;
      return [chosen.isAllowed && isScored() ? Math.max(chosen.score, SCALE[0] / 100) : NaN];
    },
  });
  const parts = choice(
    'Direction of the deflection',
    DEFLECTIONS.map(([name]) => name),
    () => deflection,
    (k) => {
      deflection = k;
      chart.refresh();
      set({});
    },
  );
  const told = () => (isScored() ? `dot: ${SCORED} error of the chosen state` : 'of the chosen state the scored error alone is known');
  const out = sayChosen(card('Deflection', '', chart.host), 'mm, logarithmic', told);
  /** @type {HTMLElement} */ (out.firstChild).append(parts);
  return out;
}

/** @param {number} x */
const pointText = (x) => String(pathPoint(clamp(Math.round(x), 0, COUNT - 1)));

/** @param {number} j @param {number} angle in % of the range of a joint */
const share = (j, angle) => ((angle - ROWS[j].min) / (ROWS[j].max - ROWS[j].min)) * 100;

function jointsCard() {
  const lines = () =>
    ROWS.map((_, j) => ({
      name: `A${j + 1}`,
      y: current().joints.map((angles) => share(j, angles[j])),
      colour: JOINT_COLOURS[j],
    }));
  const chart = alongPath('Joints', {
    lines: remembered(lines),
    range: () => [0, 100],
    xTicks: pointTicks,
    xText: pointText,
    digits: 0,
    endNames: true,
    chosen: () => {
      const chosen = chosenState();
      return chosen && chosen.joints.map((angle, j) => share(j, angle));
    },
  });
  return sayChosen(card('Joints within their limits', '', chart.host), '% of range', () => 'dots: the chosen state');
}

/** What depends on the case alone, computed once for each. @template T @param {() => T} make @returns {() => T} */
function remembered(make) {
  /** @type {Map<number, T>} */
  const known = new Map();
  return () => {
    let found = known.get(state.case);
    if (found === undefined) {
      found = make();
      known.set(state.case, found);
    }
    return found;
  };
}

function conditioningCard() {
  const column = (/** @type {Case} */ of) => of.columns.inverse_condition;
  const most = CASES.reduce((sum, of) => column(of).reduce((a, b) => Math.max(a, b), sum), LIMITS.inverse);
  const range = () => /** @type {[number, number]} */ ([0, Math.ceil(most * 10) / 10]);
  const chart = alongPath('Conditioning', {
    lines: () => linesBeside(column, false),
    range,
    limits: () => [LIMITS.inverse],
    xTicks: pointTicks,
    xText: pointText,
    chosen: notOfChosen,
  });
  return sayChosen(card('Conditioning 1/κ', '', chart.host), `limit ${LIMITS.inverse}`, () => 'along plans only');
}

/** @returns {HTMLElement | null} where the run knows clearances */
function clearanceCard() {
  if (!('clearance_mm' in CASES[0].columns)) return null;
  const column = (/** @type {Case} */ of) => of.columns.clearance_mm;
  const most = CASES.reduce((sum, of) => column(of).reduce((a, b) => (b > a ? b : a), sum), 1);
  const chart = alongPath('Clearance', {
    lines: () => linesBeside(column, false),
    range: () => [0, most],
    xTicks: pointTicks,
    xText: pointText,
    digits: 1,
    chosen: notOfChosen,
  });
  const out = card('Clearance', '', chart.host);
  const words = /** @type {HTMLElement} */ (out.querySelector('.sub'));
  onChange(() => {
    if (state.chosen) return void (words.textContent = 'mm; along plans only');
    const [clearance, pair] = [column(current())[currentPoint()], current().columns.nearest_pair[currentPoint()]];
    words.textContent = Number.isFinite(clearance) ? `mm; here ${fixed(clearance, 1)}: ${pair}` : 'mm; here nothing within 1 m';
  });
  return out;
}

function chartCards() {
  const cards = [deflectionCard(), jointsCard(), conditioningCard(), clearanceCard()];
  return el('div.charts', {}, ...cards);
}
