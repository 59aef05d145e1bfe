// Title, the one sentence that says what is at stake, and the switches of case and theme.

import { choice, el } from '../draw/dom.js';
import { fixed } from '../draw/scale.js';
import { onTheme, themeButton } from '../draw/theme.js';
import { CASES, IS_SCORE, RAW } from './data.js';
import { SCORED } from './path-mesh.js';
import { current, onChange, set } from './state.js';

const TITLE = document.title.replace(/ · stead$/, '');

/** The verdict: what placing well or badly comes to. @returns {HTMLElement} */
function verdict() {
  const strong = (/** @type {string} */ text) => el('b', {}, text);
  const mm = (/** @type {number} */ k) => strong(`${fixed(CASES[k].mean, 3)} mm`);
  const times_ = (/** @type {number} */ k) =>
    CASES[0].mean > 1e-6 ? [': ', strong(`${fixed(CASES[k].mean / CASES[0].mean, 1)} times`), ' as much'] : [''];
  const out = IS_SCORE
    ? el(
        'p',
        {},
        `At this placement the ${SCORED} is off by `,
        mm(0),
        ' in the mean with the best plan of the spindle angle, by ',
        mm(1),
        ' with the worst',
        ...times_(1),
        '.',
      )
    : el(
        'p',
        {},
        `At the best placement in the cell the ${SCORED} is off by `,
        mm(0),
        ' in the mean',
        ...(CASES[2]
          ? [', at the worst by ', mm(2), ...times_(2), ' for the same robot, tool and cut.']
          : ['; the worst was not looked for.']),
      );
  const { document: said } = RAW;
  // A part that is balanced to little says little of what the tool does.
  const whole = CASES[0].entry.deflection_mm?.total.mean;
  if (whole > 5 * CASES[0].mean)
    out.append(' That is the part that is scored; the whole deflection is ', strong(`${fixed(whole, 3)} mm`), ' in the mean.');
  if (said.interrupted) out.append(' The search was stopped before its end: this is the best result so far.');
  if (RAW.thinned)
    out.append(` Drawn with ${RAW.thinned.shown} of ${RAW.thinned.points} path points; the figures are of all.`);
  return out;
}

/** Which case of a study this is, and the way back to it. */
function caseOfStudy() {
  const { study_case: of } = RAW;
  if (!of) return null;
  const values = of.values.map((/** @type {[string, string]} */ [axis, value]) => `${axis} = ${value}`);
  const words = [`case ${of.number} of `, el('a', { href: of.report, id: 'study' }, `the study ${of.study}`), values.length ? `: ${values.join(', ')}` : ''];
  return el('p.case', {}, ...words);
}

export function header() {
  const pick = (/** @type {number} */ place, /** @type {number} */ plan) =>
    set({ case: CASES.findIndex((one) => one.place === place && one.plan === plan) });
  const places = choice(
    'Placement',
    ['Best place', 'Worst place'],
    () => current().place,
    (k) => pick(k, current().plan),
    onChange,
  );
  const plans = choice(
    'Plan of the spindle angle',
    ['Best plan', 'Worst plan'],
    () => current().plan,
    (k) => pick(current().place, k),
    onChange,
  );
  const count = RAW.task.points;
  const segments = RAW.task.segments;
  const what = `${RAW.robot.name} · ${count} path point${count === 1 ? '' : 's'}, ${segments} segment${segments === 1 ? '' : 's'}`;
  onTheme(() => set({ theme: true }));
  return el(
    'header',
    {},
    el('div', {}, el('h1', {}, TITLE, el('small', {}, what)), caseOfStudy(), verdict()),
    el('div.tools', {}, CASES.length > 2 ? places : null, plans, themeButton()),
  );
}
