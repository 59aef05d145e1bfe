// Elements, whose texts are always text, and the colours of the theme.

/**
 * An element with attributes and children; strings become text.
 * @param {string} tag
 * @param {Record<string, string>} [attributes]
 * @param {...(Node | string)} children
 * @returns {HTMLElement}
 */
function element(tag, attributes = {}, ...children) {
  const made = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, value);
  made.append(...children);
  return made;
}

/** @type {(() => void)[]} */
const themeListeners = [];

const prefersDark = matchMedia('(prefers-color-scheme: dark)');

/** Whether the page is dark now. */
function isDark() {
  const chosen = document.documentElement.dataset.theme;
  return chosen ? chosen === 'dark' : prefersDark.matches;
}

/** Dark or light, the other one. */
function turnTheme() {
  document.documentElement.dataset.theme = isDark() ? 'light' : 'dark';
  for (const listener of themeListeners) listener();
}

prefersDark.addEventListener('change', () => themeListeners.forEach(listener => listener()));

// A colour that depends on the theme is resolved only in a real property: this element has it.
const probe = element('i', { hidden: '' });
document.documentElement.append(probe);

/**
 * The colour that a variable of the style has now.
 * @param {string} name
 */
function themeColour(name) {
  probe.style.color = `var(${name})`;
  return getComputedStyle(probe).color;
}

/**
 * The colour of a series.
 * @param {number} number
 */
function seriesColour(number) {
  return themeColour(`--j${1 + number % 6}`);
}

/** Points of the colour map viridis (Smith and van der Walt), an eighth apart. */
const VIRIDIS = [[68, 1, 84], [71, 44, 122], [59, 82, 139], [44, 113, 142], [33, 145, 140], [39, 173, 129], [94, 201, 98], [170, 220, 50],
  [253, 231, 37]];

/**
 * Red, green and blue at a place of the scale, from 0 to 1.
 * @param {number} place
 */
function viridis(place) {
  const at = Math.min(1, Math.max(0, place)) * 8;
  const index = Math.min(7, Math.floor(at));
  return VIRIDIS[index].map((low, k) => Math.round(low + (VIRIDIS[index + 1][k] - low) * (at - index)));
}
