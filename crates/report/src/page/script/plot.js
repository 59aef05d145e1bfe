// Canvases for charts: a still one and one above it for what moves, in CSS pixels.

/**
 * @typedef {{ left: number, right: number, top: number, bottom: number }} Margins
 * @typedef {{
 *   host: HTMLElement, still: CanvasRenderingContext2D, top: CanvasRenderingContext2D, surface: HTMLCanvasElement,
 *   tip: HTMLElement, width: number, height: number, margins: Margins
 * }} Plot
 */

/** @param {string} label @param {Margins} margins @param {string} [classes] @returns {Plot} */
function plotWith(label, margins, classes = 'plot') {
  const [below, above] = [0, 1].map(() => /** @type {HTMLCanvasElement} */ (el('canvas', { 'aria-hidden': 'true' })));
  const tip = el('div.tip', { role: 'status' });
  const host = el(`div.${classes}`, { role: 'img', 'aria-label': label }, below, above, tip);
  const context = (/** @type {HTMLCanvasElement} */ canvas) =>
    /** @type {CanvasRenderingContext2D} */ (canvas.getContext('2d'));
  return { host, still: context(below), top: context(above), surface: above, tip, width: 0, height: 0, margins };
}

/** Takes the size of the plot's place. @param {Plot} plot @returns {boolean} whether it has changed */
function fit(plot) {
  const box = plot.host.getBoundingClientRect();
  const ratio = devicePixelRatio;
  const [width, height] = [Math.round(box.width * ratio), Math.round(box.height * ratio)];
  const canvas = plot.still.canvas;
  if (canvas.width === width && canvas.height === height) return false;
  for (const context of [plot.still, plot.top]) {
    [context.canvas.width, context.canvas.height] = [width, height];
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
  }
  [plot.width, plot.height] = [box.width, box.height];
  return true;
}

/** @param {CanvasRenderingContext2D} context @param {Plot} plot */
function clear(context, plot) {
  context.clearRect(0, 0, plot.width, plot.height);
  context.font = `11px ${getComputedStyle(document.body).fontFamily}`;
  context.lineWidth = 1;
  context.setLineDash([]);
  context.globalAlpha = 1;
}

/** @param {CanvasRenderingContext2D} context @param {[number, number][]} points */
function stroke(context, points) {
  context.beginPath();
  points.forEach(([x, y], k) => (k ? context.lineTo(x, y) : context.moveTo(x, y)));
  context.stroke();
}

/** Shows words beside the pointer, within the plot. @param {Plot} plot @param {string} text @param {number} x @param {number} y */
function say(plot, text, x, y) {
  plot.tip.textContent = text;
  plot.tip.style.opacity = text ? '1' : '0';
  if (!text) return;
  const half = plot.tip.offsetWidth / 2 + 4;
  plot.tip.style.left = `${clamp(x, half, Math.max(half, plot.width - half))}px`;
  plot.tip.style.top = `${Math.max(y - 10, plot.tip.offsetHeight)}px`;
}

/** Round numbers between two, about so many. @param {number} low @param {number} high @param {number} count */
function ticksBetween(low, high, count = 4) {
  const rough = (high - low) / count || 1;
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = [1, 2, 2.5, 5, 10].map((factor) => factor * power).find((one) => one >= rough * 0.999) || rough;
  const out = [];
  for (let k = Math.ceil(low / step - 1e-9); k * step <= high + 1e-9 * step; k++) out.push(+(k * step).toPrecision(12));
  return out;
}

/** Powers of ten between two. @param {number} low @param {number} high */
function decadesBetween(low, high) {
  const out = [];
  for (let k = Math.ceil(Math.log10(low) - 1e-9); 10 ** k <= high * (1 + 1e-9); k++) out.push(10 ** k);
  return out;
}
