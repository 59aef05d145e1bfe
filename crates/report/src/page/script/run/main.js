// The page from its parts.

import { el } from '../draw/dom.js';
import { withDownloads } from '../draw/downloads.js';
import { furtherCards, messages } from './cards.js';
import { casesCard } from './cases.js';
import { chartCards } from './charts.js';
import { CASES, MAPS, RAW, shownAngles } from './data.js';
import { axesAt, meets } from './external-axes.js';
import { loadsCard } from './loads.js';
import { header } from './header.js';
import { framesOf, jointsAt } from './kinematics.js';
import { linked } from './link.js';
import { mapCard } from './map.js';
import { gauges, tiles } from './readings.js';
import { printed } from './printed.js';
import { sceneCard, viewPicture } from './scene-card.js';
import { sheetCard } from './sheet.js';
import { set, state, steps } from './state.js';
import { onKey, transport } from './transport.js';
import { besideJoints, byJointHere, byJointOnPlan } from './yielding.js';

function footer() {
  const key = (/** @type {string[]} */ names, /** @type {string} */ words) =>
    el('span.keys', {}, ...names.flatMap((name) => [el('kbd', {}, name), ' ']), words);
  const { document: said } = RAW;
  const count = (/** @type {number | undefined} */ n, /** @type {string} */ words) =>
    n ? `, ${n.toLocaleString('en')} ${words}` : '';
  const run = `stead ${RAW.version}${said.seed === undefined ? '' : `, seed ${said.seed}`}${count(said.evaluations, 'placements')}${count(said.states, 'states')}`;
  const inputs = RAW.inputs.map((/** @type {any} */ input) =>
    el(
      'span',
      {},
      `${input.name.replace(/^(\.\.\/)+/, '')} `,
      el('code', { title: input.sha256 }, input.sha256.slice(0, 8)),
    ),
  );
  const reference = said.reference?.source ? el('span', {}, `reference: ${said.reference.source}`) : null;
  return el(
    'footer',
    {},
    key(['←', '→'], 'point'),
    key(['⇧', '←', '→'], 'segment'),
    key(['space'], 'play'),
    key(CASES.length > 2 ? ['1', '–', '4'] : ['1', '2'], 'case'),
    key(['Esc'], 'back to the plan'),
    key(['D'], 'dark'),
    el('span', {}, run),
    ...inputs,
    reference,
  );
}

function main() {
  document.body.append(
    el(
      'main.wrap',
      {},
      sheetCard(),
      header(),
      messages(),
      printed(),
      transport(),
      el('div.main', {}, sceneCard(), el('div.right', {}, tiles(), mapCard())),
      chartCards(),
      loadsCard(),
      el('div.low', {}, casesCard(), gauges()),
      furtherCards(),
      footer(),
    ),
  );
  withDownloads(document.body);
  addEventListener('keydown', onKey);
  linked();
  set({}, true);
  const observer = new ResizeObserver(() => set({ size: true }));
  document.querySelectorAll('.view').forEach((host) => observer.observe(host));
  // For measurements and tests: what is shown, and when it first was.
  const of = { framesOf, jointsAt, shownAngles, axesAt, meets, byJointOnPlan, byJointHere, besideJoints };
  const shown = { state, set, steps, cases: CASES, maps: MAPS, ...of, picture: viewPicture, first: 0 };
  requestAnimationFrame(() =>
    requestAnimationFrame(() => {
      shown.first = performance.now();
    }),
  );
  Object.assign(window, { stead: shown });
}

main();
