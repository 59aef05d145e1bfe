// The case and the point that are shown, in the address: `#case=1&point=26`.

import { CASES, COUNT } from './data.js';
import { pathPoint } from './path.js';
import { currentPoint, onChange, set, state } from './state.js';

/** The drawn point nearest to a path point. @param {number} asked */
function drawnPoint(asked) {
  let best = 0;
  for (let i = 0; i < COUNT; i++) if (Math.abs(pathPoint(i) - asked) < Math.abs(pathPoint(best) - asked)) best = i;
  return best;
}

/** Shows what the address says, as far as there is such a case and such a point. */
function follow() {
  const said = new URLSearchParams(location.hash.slice(1));
  const number = (/** @type {string} */ name) => (/^\d+$/.test(said.get(name) ?? '') ? Number(said.get(name)) : null);
  const [one, point] = [number('case'), number('point')];
  const place = CASES.findIndex((of) => of.number === one);
  if (place >= 0) set({ case: place });
  if (point !== null) set({ t: drawnPoint(point) });
}

/** Keeps the address and what is shown together. */
export function linked() {
  follow();
  addEventListener('hashchange', follow);
  let waiting = 0;
  let isFirst = true;
  onChange(() => {
    // A page that is opened keeps its address until something is chosen.
    if (isFirst) return void (isFirst = false);
    clearTimeout(waiting);
    waiting = setTimeout(() => {
      const to = `#case=${CASES[state.case].number}&point=${pathPoint(currentPoint())}`;
      // A step is no page to go back to.
      if (location.hash !== to) history.replaceState(null, '', to);
    }, 400);
  });
}
