// The page of a placement that is moved by hand.

import { el } from '../draw/dom.js';
import { onTheme, themeButton } from '../draw/theme.js';
import { chartCards } from '../run/charts.js';
import { CASES, MAPS, RAW } from '../run/data.js';
import { axesAt } from '../run/external-axes.js';
import { framesOf, jointsAt } from '../run/kinematics.js';
import { mapCard } from '../run/map.js';
import { gauges, tiles } from '../run/readings.js';
import { sceneCard, viewPicture } from '../run/scene-card.js';
import { set, state, steps } from '../run/state.js';
import { onKey, transport } from '../run/transport.js';
import { controlsCard, onUndoKey } from './controls.js';
import { draggable } from './drag.js';
import { editsCard } from './edits.js';
import { figuresCard, titleOf } from './figures.js';
import { follow, shown } from './follow.js';
import { jobsCard, lostBanner, watchServer } from './jobs.js';
import { pinsCard } from './pins.js';
import { goTo, place } from './place.js';

function main() {
  onTheme(() => set({ theme: true }));
  const scene = sceneCard();
  // What is typed is not taken for a key of the page.
  const typed = (/** @type {KeyboardEvent} */ event) => {
    const { tagName, type } = /** @type {any} */ (event.target);
    const isTyped = tagName === 'SELECT' || (tagName === 'INPUT' && type !== 'checkbox');
    if (isTyped && !(event.ctrlKey || event.metaKey)) event.stopPropagation();
  };
  const right = el('div.right', {}, figuresCard(), controlsCard(), jobsCard());
  const low = el('div.low.live', { onkeydown: typed }, pinsCard(), editsCard());
  document.body.append(
    el(
      'main.wrap',
      {},
      el('header', {}, titleOf(), el('div.tools', {}, themeButton())),
      lostBanner(right, low),
      el('div.main', { onkeydown: typed }, scene, right),
      transport(),
      low,
      el('div.low.live', {}, el('div.right', {}, tiles(), mapCard()), gauges()),
      chartCards(),
      el('footer', {}, el('span', {}, `stead ${RAW.version}`), el('span', {}, 'This page is answered by your own machine; nothing leaves it.')),
    ),
  );
  addEventListener('keydown', (event) => {
    onUndoKey(event);
    if (!event.defaultPrevented) onKey(event);
  });
  draggable(/** @type {HTMLElement} */ (scene.querySelector('.view')));
  set({}, true);
  const observer = new ResizeObserver(() => set({ size: true }));
  document.querySelectorAll('.view').forEach((host) => observer.observe(host));
  follow();
  watchServer();
  // For measurements and tests: what is shown, and when it first was.
  const known = { state, set, steps, cases: CASES, maps: MAPS, framesOf, jointsAt, axesAt, picture: viewPicture, shown, place, goTo, first: 0 };
  requestAnimationFrame(() =>
    requestAnimationFrame(() => {
      known.first = performance.now();
    }),
  );
  Object.assign(window, { stead: known });
}

main();
