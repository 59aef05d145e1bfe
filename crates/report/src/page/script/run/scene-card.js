// The card of the view: its switches, its words, and the keys that turn it.

import { choice, el } from '../draw/dom.js';
import { giving } from '../draw/downloads.js';
import { fixed } from '../draw/scale.js';
import { ILLUSTRATED } from './bodies.js';
import { COLOURINGS } from './colour.js';
import { wordsOf } from './data.js';
import { AXES } from './external-axes.js';
import { LAYERS, sceneIn } from './scene.js';
import { reasonText } from './map.js';
import { FACTORS, MAGNIFIED } from './path-mesh.js';
import { chosenState, current, onChange, onScene, set, state } from './state.js';
import { HAS_BLOCK } from './surroundings.js';
/** @import { Scene } from './scene.js' */

/** Gives the view as it is now, as the address of a picture; the card of the scene puts it in. */
let picture = () => '';

/** That address. */
export const viewPicture = () => picture();

/** What is seen at a place of the window; the card of the scene puts it in. @type {Scene['ray']} */
let ray = () => ({ from: [0, 0, 0], along: [0, 0, 1] });

/** That ray. @param {number} x @param {number} y */
export const viewRay = (x, y) => ray(x, y);

/** The scale of the colours of the path, and what it is coloured by where there is something to choose from. */
function colouring() {
  const legend = el('div.legend');
  const pick = choice(
    'Colour of the path',
    COLOURINGS.map(({ name }) => name),
    () => state.colouring,
    (colouring) => set({ colouring }),
    onChange,
  );
  onChange(() => legend.replaceChildren(COLOURINGS[state.colouring].ramp()));
  return el('div.tags.colouring', {}, COLOURINGS.length > 1 ? pick : null, legend);
}

/** How many times too large errors are drawn. */
function factorSlider() {
  const words = el('output');
  const slider = /** @type {HTMLInputElement} */ (
    el('input', {
      type: 'range',
      id: 'magnified',
      min: 0,
      max: FACTORS.length - 1,
      step: 1,
      'aria-label': 'How many times too large errors are drawn',
      oninput: () => set({ magnified: FACTORS[+slider.value] }),
      // Its keys are its own, and no steps along the path.
      onkeydown: (/** @type {KeyboardEvent} */ event) => event.stopPropagation(),
    })
  );
  onChange(() => {
    const factor = state.magnified ?? MAGNIFIED;
    words.textContent = `×${factor}`;
    slider.value = String(FACTORS.indexOf(factor));
    slider.setAttribute('aria-valuetext', `${factor} times`);
  });
  return el('label.chip.factor', {}, 'errors', slider, words);
}

/** The card with the view, its switches and its words. */
export function sceneCard() {
  const view = el('div.view');
  const [title, where] = [el('h2'), el('div.sub')];
  const host = el(
    'section.card.scene',
    { 'aria-label': 'The cell in three dimensions', id: 'scene' },
    view,
    el('div.tl', {}, title, where),
  );
  const scene = sceneIn(view);
  picture = scene.picture;
  ray = scene.ray;
  const views = [
    ['cell', '3-D'],
    ['top', 'Top'],
    ['front', 'Front'],
    ['tool', 'Tool'],
  ].map(([name, text]) =>
    el('button.chip', { type: 'button', 'data-view': name, onclick: () => scene.view(name) }, text),
  );
  const layers = LAYERS.map(({ name, words: text, isOff }) => {
    const box = /** @type {HTMLInputElement} */ (
      el('input', {
        type: 'checkbox',
        checked: !isOff,
        'data-layer': name,
        onchange: () => scene.layer(name, box.checked),
      })
    );
    return el('label.chip', {}, box, text);
  });
  const words = [
    ILLUSTRATED ? `Shapes of ${ILLUSTRATED} are illustrations made from the robot’s rows` : '',
    HAS_BLOCK ? 'the block is the extent of the path' : '',
    AXES.length ? 'external axes show how they move, not their looks' : '',
  ];
  host.append(
    el('div.tr', {}, ...views),
    el('div.bl', {}, colouring(), el('div.tags', {}, ...layers, factorSlider()), el('div.sub', {}, words.filter(Boolean).join('; '))),
  );
  view.tabIndex = 0;
  view.setAttribute('role', 'img');
  view.setAttribute('aria-label', 'Robot, spindle, path and cell; arrow keys turn the view, plus and minus zoom');
  view.addEventListener('keydown', (event) => {
    const turn = { ArrowLeft: [-25, 0], ArrowRight: [25, 0], ArrowUp: [0, 25], ArrowDown: [0, -25] }[event.key];
    if (turn) scene.turn(turn[0], turn[1]);
    else if (event.key === '+' || event.key === '=') scene.zoom(0.85);
    else if (event.key === '-') scene.zoom(1 / 0.85);
    else return;
    event.preventDefault();
    event.stopPropagation();
  });
  onScene(() => {
    const { name, at, entry } = current();
    const lies = entry.orientation ? `, part “${entry.orientation}”` : '';
    const words = `x ${fixed(at.x, 1)}  y ${fixed(at.y, 1)}  z ${fixed(at.z, 1)} mm, yaw ${fixed(at.yaw, 1)}°${lies}`;
    if (title.textContent !== name) title.textContent = name;
    if (where.textContent !== words) where.textContent = words;
  });
  // A state that is not allowed: the arm stays where it was, in grey, and the view says why.
  const refusal = el('div.refusal', { id: 'refusal', hidden: true });
  host.append(refusal);
  onChange(() => {
    const chosen = chosenState();
    const isRefused = chosen !== null && !chosen.isAllowed;
    view.classList.toggle('refused', isRefused);
    refusal.hidden = !isRefused;
    refusal.textContent = isRefused ? `Not allowed at point ${chosen.point}, β ${fixed(chosen.beta, 1)}°: ${reasonText(chosen.reason)}` : '';
  });
  // Its figures are those of the plan that is shown.
  const rows = () => {
    const { columns } = current();
    // The words of postures stand in the document, once for all rows.
    const withWords = (/** @type {string} */ name) => (name === 'posture' && wordsOf(1) ? [name, 'posture_words'] : [name]);
    const heads = Object.keys(columns).flatMap(withWords);
    const at = (/** @type {string} */ name, /** @type {number} */ i) =>
      name === 'posture_words' ? wordsOf(columns.posture[i])?.replaceAll(', ', '; ') : columns[name][i];
    return [heads, ...Array.from(columns.point, (_, i) => heads.map((name) => at(name, i)))];
  };
  return giving(host, { rows, picture: viewPicture });
}
