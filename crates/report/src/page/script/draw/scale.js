// Numbers as text, and along an axis. Inside a plot, a logarithmic axis counts in powers of ten.

/** @import { Axis } from './chart-data.js' */

/** @param {number} v @param {number} low @param {number} high */
export const clamp = (v, low, high) => Math.min(high, Math.max(low, v));
/** @param {number[]} a @param {number[]} b @param {number} t */
export const mix = (a, b, t) => a.map((v, k) => v + (b[k] - v) * t);

/** @param {number | null | undefined} value @param {number} digits */
export function fixed(value, digits = 3) {
  return value === null || value === undefined || !Number.isFinite(value) ? '–' : value.toFixed(digits).replace(/^-(0\.?0*)$/, '$1');
}

/** A number by its three leading figures. @param {number} value */
export const figures = (value) =>
  value === 0 ? '0' : Math.abs(value) >= 1e-3 ? String(+value.toPrecision(3)) : value.toExponential(2);

/** A number with as many digits as are read. @param {number} value */
export function shown(value) {
  const rounded = +value.toPrecision(5);
  return rounded !== 0 && Math.abs(rounded) < 1e-3 ? rounded.toExponential() : String(rounded);
}

/** The place of a value along an axis. @param {Axis} axis @param {number} value */
export const along = (axis, value) => (axis.is_log ? Math.log10(value) : value);

/** The value at a place of an axis as it is shown: a name where the axis has names. @param {Axis} axis @param {number} place */
export const shownAt = (axis, place) =>
  axis.names?.[Math.round(place)] ?? shown(axis.is_log ? 10 ** place : place);

/** The smallest of 1, 2 and 5 times a power of ten that is no smaller than a number above 0, or the largest that is no larger. @param {number} value @param {'up' | 'down'} [way] */
export function rounded(value, way = 'up') {
  const power = Math.floor(Math.log10(value));
  const all = [-1, 0, 1].flatMap((k) => [1, 2, 5].map((factor) => Number(`${factor}e${power + k}`)));
  return (way === 'up' ? all.find((step) => step >= value) : all.reverse().find((step) => step <= value)) ?? value;
}

/** The value that such a share of some does not exceed; 0 of none. @param {Iterable<number>} values @param {number} share */
export function percentile(values, share) {
  const sorted = Float64Array.from(values).filter(Number.isFinite).sort();
  return sorted[Math.max(0, Math.ceil(share * sorted.length) - 1)] ?? 0;
}

/** The smallest round step that is no smaller than a number. @param {number} least */
function stepOf(least) {
  const power = 10 ** Math.floor(Math.log10(least));
  return [1, 2, 2.5, 5, 10].map((factor) => factor * power).find((step) => step >= least * 0.999) ?? least;
}

/**
 * The places of ticks between two places, about so many, each with its label.
 * @param {Axis} axis @param {number} from @param {number} to @param {number} count
 * @returns {{at: number, label: string}[]}
 */
export function ticks(axis, from, to, count) {
  const span = to - from || 1;
  const list = [];
  if (axis.names) {
    const step = Math.ceil(stepOf(Math.max(1, span / count)));
    for (let k = Math.max(0, Math.ceil(from / step) * step); k <= to && k < axis.names.length; k += step) {
      list.push({ at: k, label: axis.names[k] });
    }
  } else if (axis.is_log && span > 0.9) {
    const within = span > 2.5 ? [1] : [1, 2, 5];
    for (let power = Math.floor(from); power <= to + 1e-9; power += Math.max(1, Math.round(span / count))) {
      for (const factor of within) {
        const at = power + Math.log10(factor);
        if (at >= from - 1e-9 && at <= to + 1e-9) list.push({ at, label: shown(factor * 10 ** power) });
      }
    }
  } else {
    const step = stepOf(span / count);
    for (let k = Math.ceil(from / step - 1e-9); k * step <= to + 1e-9 * span; k++) {
      // What is rounded to nothing is nothing.
      const at = Math.abs(k * step) < 1e-9 * span ? 0 : k * step;
      list.push({ at, label: axis.is_log ? shown(10 ** at) : String(+at.toPrecision(12)) });
    }
  }
  return list;
}

/**
 * The smallest and the largest number, with space beside them; 0 to 1 of none.
 * @param {number[]} values @param {number} space a share of what is between them
 * @returns {[number, number]}
 */
export function extent(values, space) {
  let [low, high] = [Infinity, -Infinity];
  for (const value of values) {
    if (value < low) low = value;
    if (value > high) high = value;
  }
  if (low > high) return [0, 1];
  if (low === high) return [low - Math.max(Math.abs(low) * 0.1, 1e-9), high + Math.max(Math.abs(high) * 0.1, 1e-9)];
  return [low - space * (high - low), high + space * (high - low)];
}
