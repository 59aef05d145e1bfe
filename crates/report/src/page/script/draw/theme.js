// Colours: those of the theme, which is dark or light, and the scale of values.

import { el } from './dom.js';
import { clamp, mix } from './scale.js';

/** @type {(() => void)[]} */
const listeners = [];
const prefersDark = matchMedia('(prefers-color-scheme: dark)');
prefersDark.addEventListener('change', () => listeners.forEach((listener) => listener()));

/** @param {() => void} listener told when the theme has changed */
export const onTheme = (listener) => void listeners.push(listener);

/** Whether the page is dark now. */
export function isDark() {
  const chosen = document.documentElement.dataset.theme;
  return chosen ? chosen === 'dark' : prefersDark.matches;
}

/** Dark or light, the other one. */
export function turnTheme() {
  document.documentElement.dataset.theme = isDark() ? 'light' : 'dark';
  listeners.forEach((listener) => listener());
}

/** The button that does so. */
export const themeButton = () =>
  el(
    'button.icon',
    { type: 'button', id: 'theme', 'aria-label': 'Light or dark', title: 'Light or dark (D)', onclick: turnTheme },
    '◐',
  );

// light-dark() is resolved only in a real property: an element that is never shown reads it.
const probe = el('i', { hidden: true });
document.documentElement.append(probe);
/** @type {Map<string, string>} */
const known = new Map();

/** A colour of the theme as the browser writes it. @param {string} name of a custom property */
export function themeColour(name) {
  const key = `${name} ${isDark()}`;
  let found = known.get(key);
  if (!found) {
    probe.style.color = `var(${name})`;
    found = getComputedStyle(probe).color;
    known.set(key, found);
  }
  return found;
}

/** The same as numbers to 1. @param {string} name @returns {number[]} */
export const themeRgb = (name) =>
  (themeColour(name).match(/[\d.]+/g) || ['0', '0', '0']).slice(0, 3).map((part) => +part / 255);

/** The custom property of a colour of a chart: its place among the colours of series, or its name. @param {number | string} colour */
export const propertyOf = (colour) => (typeof colour === 'string' ? colour : `--j${1 + (colour % 6)}`);

const VIRIDIS = [
  0x440154, 0x482475, 0x414487, 0x355f8d, 0x2a788e, 0x21918c, 0x22a884, 0x44bf70, 0x7ad151, 0xbddf26, 0xfde725,
].map((hex) => [hex >> 16, (hex >> 8) & 255, hex & 255]);

/** The colour map viridis (Smith and van der Walt). @param {number} t from 0 to 1 @returns {number[]} red, green, blue to 255 */
export function viridis(t) {
  const at = clamp(t, 0, 1) * 10;
  const k = Math.min(9, Math.floor(at));
  return mix(VIRIDIS[k], VIRIDIS[k + 1], at - k).map(Math.round);
}

/** @param {number[]} rgb */
export const cssOf = (rgb) => `rgb(${rgb.join(',')})`;
