// Colours: one logarithmic scale of deflections for everything, and those of the theme.

const VIRIDIS = [
  0x440154, 0x482475, 0x414487, 0x355f8d, 0x2a788e, 0x21918c, 0x22a884, 0x44bf70, 0x7ad151, 0xbddf26, 0xfde725,
].map((hex) => [hex >> 16, (hex >> 8) & 255, hex & 255]);

/** @param {number} t from 0 to 1 @returns {number[]} red, green, blue to 255 */
function viridis(t) {
  const at = clamp(t, 0, 1) * 10;
  const k = Math.min(9, Math.floor(at));
  return mix(VIRIDIS[k], VIRIDIS[k + 1], at - k).map(Math.round);
}

/** The ends of the scale in mm: three decades, moved so that the largest score is within. @type {[number, number]} */
const SCALE = (() => {
  const largest = CASES.reduce((most, of) => Math.max(most, of.max), 0);
  let high = 5;
  while (largest > high) high *= 10;
  while (largest < high / 50 && high > 5e-3) high /= 10;
  return [high / 1000, high];
})();

/** @param {number} mm @returns {number} from 0 to 1 along the scale */
const level = (mm) => Math.log(Math.max(Math.abs(mm), SCALE[0]) / SCALE[0]) / Math.log(SCALE[1] / SCALE[0]);

/** @param {number} mm */
const colourOf = (mm) => viridis(level(mm));

/** @param {number[]} rgb */
const cssOf = (rgb) => `rgb(${rgb.join(',')})`;

function isDark() {
  const asked = document.documentElement.dataset.theme;
  return asked ? asked === 'dark' : matchMedia('(prefers-color-scheme: dark)').matches;
}

// light-dark() is resolved only in a real property: an element that is never shown reads it.
const probe = document.createElement('i');
probe.hidden = true;
document.documentElement.append(probe);
/** @type {Map<string, string>} */
const themeColours = new Map();

/** A colour of the theme as the browser writes it. @param {string} name of a custom property */
function themeColour(name) {
  const key = `${name} ${isDark()}`;
  let found = themeColours.get(key);
  if (!found) {
    probe.style.color = `var(${name})`;
    found = getComputedStyle(probe).color;
    themeColours.set(key, found);
  }
  return found;
}

/** The same as numbers to 1. @param {string} name @returns {number[]} */
const themeRgb = (name) =>
  (themeColour(name).match(/[\d.]+/g) || ['0', '0', '0']).slice(0, 3).map((part) => +part / 255);

const JOINT_COLOURS = ['--j1', '--j2', '--j3', '--j4', '--j5', '--j6'];
