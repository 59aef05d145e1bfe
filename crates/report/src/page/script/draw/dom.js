// Elements, whose texts are always text and never markup, and the parts that every page is made of.

/**
 * An element with attributes, listeners (`onclick`) and children.
 * @param {string} name tag, with classes behind dots
 * @param {Record<string, any>} [attributes]
 * @param {...(Node | string | number | null | undefined)} children
 * @returns {HTMLElement}
 */
export function el(name, attributes = {}, ...children) {
  const [tag, ...classes] = name.split('.');
  const made = document.createElement(tag);
  if (classes.length) made.className = classes.join(' ');
  for (const [key, value] of Object.entries(attributes)) {
    if (key.startsWith('on')) made.addEventListener(key.slice(2), value);
    else if (value !== null && value !== undefined && value !== false)
      made.setAttribute(key, value === true ? '' : String(value));
  }
  for (const child of children) {
    if (child !== null && child !== undefined) made.append(child instanceof Node ? child : String(child));
  }
  return made;
}

/** @param {Record<string, any>} [attributes] @returns {HTMLCanvasElement} a canvas that is not read out */
export const canvasOf = (attributes = {}) =>
  /** @type {HTMLCanvasElement} */ (el('canvas', { 'aria-hidden': 'true', ...attributes }));

/** @param {HTMLCanvasElement} canvas */
export const contextOf = (canvas) => /** @type {CanvasRenderingContext2D} */ (canvas.getContext('2d'));

/** A card with a heading. @param {string} title @param {string} hint @param {...(Node | string)} children */
export const card = (title, hint, ...children) =>
  el(
    'section.card',
    { 'aria-label': title },
    el('div.head', {}, el('h2', {}, title), el('span.sub', {}, hint)),
    ...children,
  );

/** What is folded on the screen and open on paper, where it would be left out. @param {...(Node | string)} children its summary first */
export function folded(...children) {
  const fold = /** @type {HTMLDetailsElement} */ (el('details', {}, ...children));
  let wasOpen = false;
  addEventListener('beforeprint', () => ([wasOpen, fold.open] = [fold.open, true]));
  addEventListener('afterprint', () => void (fold.open = wasOpen));
  return fold;
}

/**
 * Buttons of which one is chosen, by click and arrow keys.
 * @param {string} label @param {string[]} names @param {() => number} get @param {(k: number) => void} put
 * @param {(refresh: () => void) => void} [watch] told how to show a choice that something else has made
 */
export function choice(label, names, get, put, watch) {
  const choose = (/** @type {number} */ k) => {
    put(k);
    refresh();
  };
  const buttons = names.map((name, k) =>
    el('button', { role: 'radio', type: 'button', onclick: () => choose(k) }, name),
  );
  const refresh = () =>
    buttons.forEach((button, k) => {
      button.setAttribute('aria-checked', String(get() === k));
      button.tabIndex = get() === k ? 0 : -1;
    });
  const onkeydown = (/** @type {KeyboardEvent} */ event) => {
    const step = { ArrowRight: 1, ArrowDown: 1, ArrowLeft: -1, ArrowUp: -1 }[event.key];
    if (!step) return;
    event.preventDefault();
    event.stopPropagation();
    const next = (get() + step + names.length) % names.length;
    choose(next);
    buttons[next].focus();
  };
  refresh();
  watch?.(refresh);
  return el('div.choice', { role: 'radiogroup', 'aria-label': label, onkeydown }, ...buttons);
}
