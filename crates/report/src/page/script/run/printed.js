// What is printed in place of what moves: best and worst placement side by side, and the map of the best.

import { el } from '../draw/dom.js';
import { PLOTS } from '../draw/plot.js';
import { fixed } from '../draw/scale.js';
import { CASES } from './data.js';
import { viewPicture } from './scene-card.js';
import { currentMap, set, state } from './state.js';

/** The legend of the map, its canvases as pictures. */
function legend() {
  const shown = document.querySelector('.mapbox .legend');
  const copy = /** @type {HTMLElement | undefined} */ (shown?.cloneNode(true));
  const drawn = shown?.querySelectorAll('canvas') ?? [];
  copy?.querySelectorAll('canvas').forEach((blank, k) => {
    const { width, height } = drawn[k].getBoundingClientRect();
    blank.replaceWith(el('img', { src: drawn[k].toDataURL(), alt: '', width, height }));
  });
  return copy;
}

/** The case as it is printed: its picture with its figures below. @param {number} number */
function pictured(number) {
  set({ case: number, t: 0 }, true);
  const { name, mean, max, at } = CASES[number];
  const place = `x ${fixed(at.x, 1)}, y ${fixed(at.y, 1)}, z ${fixed(at.z, 1)} mm, yaw ${fixed(at.yaw, 2)}°`;
  return el(
    'figure',
    {},
    el('img', { src: viewPicture(), alt: '' }),
    el('figcaption', {}, el('b', {}, name), `: mean ${fixed(mean, 3)} mm, largest ${fixed(max, 3)} mm; ${place}`),
  );
}

/** The part of the page that is only printed. */
export function printed() {
  const host = el('section.printed', { 'aria-hidden': 'true' });
  /** @type {{ case: number, t: number, chosen: any } | null} */
  let before = null;
  addEventListener('beforeprint', () => {
    before ??= { case: state.case, t: state.t, chosen: state.chosen };
    set({ theme: true }, true);
    const worst = CASES.findIndex((of) => of.place === 1);
    const pair = (worst < 0 ? [0] : [0, worst]).map(pictured);
    set({ case: 0, t: 0 }, true);
    const [map, key] = [currentMap() && PLOTS.get(/** @type {Element} */ (document.getElementById('map'))), legend()];
    const parts = [el('div.pair', {}, ...pair)];
    if (map && key) {
      const title = 'Deflection map of the best placement: spindle angle β over path point';
      parts.push(el('figure.charted', {}, el('figcaption', {}, el('b', {}, title)), el('img', { src: map.picture(), alt: '' }), key));
    }
    host.replaceChildren(...parts);
  });
  addEventListener('afterprint', () => {
    if (!before) return;
    host.replaceChildren();
    set({ ...before, theme: true });
    before = null;
  });
  return host;
}
