// Elements and numbers as text. What comes from the input is text and never markup.

/**
 * An element with attributes, listeners (`onclick`) and children.
 * @param {string} name tag, with classes behind dots
 * @param {Record<string, any>} [attributes]
 * @param {...(Node | string | number | null | undefined)} children
 * @returns {HTMLElement}
 */
function el(name, attributes = {}, ...children) {
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

/** @param {number | null | undefined} value @param {number} digits */
function fixed(value, digits = 3) {
  return value === null || value === undefined || !Number.isFinite(value) ? '–' : value.toFixed(digits).replace(/^-(0\.?0*)$/, '$1');
}

/** What the lines of a chart are. @param {Line[]} lines */
const legendOf = (lines) =>
  el(
    'div.legend',
    {},
    ...lines.map(({ name, colour }) => {
      const swatch = el('span.swatch');
      swatch.style.background = `var(${colour})`;
      return el('span', {}, swatch, name);
    }),
  );

/** A number by its three leading figures. @param {number} value */
const figures = (value) =>
  value === 0 ? '0' : Math.abs(value) >= 1e-3 ? String(+value.toPrecision(3)) : value.toExponential(2);

/** A card with a heading. @param {string} title @param {string} hint @param {...(Node | string)} children */
const card = (title, hint, ...children) =>
  el(
    'section.card',
    { 'aria-label': title },
    el('div.head', {}, el('h2', {}, title), el('span.sub', {}, hint)),
    ...children,
  );

/** Buttons of which one is chosen. @param {string} label @param {string[]} names @param {() => number} get @param {(k: number) => void} put */
function choice(label, names, get, put) {
  const buttons = names.map((name, k) => el('button', { role: 'radio', type: 'button', onclick: () => put(k) }, name));
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
    put(next);
    refresh();
    buttons[next].focus();
  };
  onChange(refresh);
  return el('div.choice', { role: 'radiogroup', 'aria-label': label, onkeydown }, ...buttons);
}
