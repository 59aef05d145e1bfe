// Numbers along an axis. Inside a plot, a logarithmic axis counts in powers of ten.

/**
 * The place of a value along an axis.
 * @param {Axis} axis
 * @param {number} value
 */
function along(axis, value) {
  return axis.is_log ? Math.log10(value) : value;
}

/**
 * A number with as many digits as are read.
 * @param {number} value
 */
function shown(value) {
  const rounded = Number(value.toPrecision(5));
  return rounded !== 0 && Math.abs(rounded) < 1e-3 ? rounded.toExponential() : String(rounded);
}

/**
 * The value at a place of an axis as it is shown: a name where the axis has names.
 * @param {Axis} axis
 * @param {number} place
 */
function shownAt(axis, place) {
  return axis.names?.[Math.round(place)] ?? shown(axis.is_log ? 10 ** place : place);
}

/**
 * The places of ticks between two places, about so many, each with its label.
 * @param {Axis} axis
 * @param {number} from
 * @param {number} to
 * @param {number} count
 * @returns {{at: number, label: string}[]}
 */
function ticks(axis, from, to, count) {
  const span = to - from;
  if (axis.names) {
    const step = Math.max(1, Math.ceil(span / count));
    const list = [];
    for (let k = Math.max(0, Math.ceil(from)); k <= to && k < axis.names.length; k += step) list.push({ at: k, label: axis.names[k] });
    return list;
  }
  if (axis.is_log && span > 0.9) {
    const list = [];
    const within = span > 2.5 ? [1] : [1, 2, 5];
    for (let power = Math.floor(from); power <= to; power += Math.max(1, Math.round(span / count))) {
      for (const factor of within) {
        const at = power + Math.log10(factor);
        if (at >= from && at <= to) list.push({ at, label: shown(factor * 10 ** power) });
      }
    }
    return list;
  }
  const list = [];
  const rough = span / count;
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = [1, 2, 5, 10].map(factor => factor * power).find(step => step >= rough) ?? rough;
  for (let k = Math.ceil(from / step); k * step <= to + 1e-9 * span; k++) {
    // What is rounded to nothing is nothing.
    const at = Math.abs(k * step) < 1e-9 * span ? 0 : k * step;
    list.push({ at, label: axis.is_log ? shown(10 ** at) : String(Number(at.toPrecision(12))) });
  }
  return list;
}

/**
 * The smallest and the largest number, with room beside them; 0 to 1 of none.
 * @param {number[]} values
 * @param {number} room
 * @returns {[number, number]}
 */
function extent(values, room) {
  let [low, high] = [Infinity, -Infinity];
  for (const value of values) {
    if (value < low) low = value;
    if (value > high) high = value;
  }
  if (low > high) return [0, 1];
  if (low === high) return [low - Math.max(Math.abs(low) * 0.1, 1e-9), high + Math.max(Math.abs(high) * 0.1, 1e-9)];
  return [low - room * (high - low), high + room * (high - low)];
}
