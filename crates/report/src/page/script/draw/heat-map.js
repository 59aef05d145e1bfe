// Values over two axes as colours.

import { seriesColour, seriesKey } from './chart.js';
import { canvasOf, contextOf, el } from './dom.js';
import { plotCard } from './plot.js';
import { along, figures, shown, shownAt, ticks } from './scale.js';
import { cssOf, viridis } from './theme.js';
/** @import { Axis, HeatMap } from './chart-data.js' */
/** @import { Hit, Plot, View } from './plot.js' */

/**
 * The scale of colours with ticks at round values, and what is said of values above its end.
 * @param {Axis} axis whose `range` the colours span @param {number} largest of all values that are shown @param {number[]} [marks] where not as usual
 */
export function rampOf(axis, largest, marks) {
  const ramp = canvasOf({ class: 'ramp', width: 170, height: 9 });
  const g = contextOf(ramp);
  for (let x = 0; x < 170; x++) {
    g.fillStyle = cssOf(viridis(x / 169));
    g.fillRect(x, 0, 1, 9);
  }
  const [low, high] = axis.range ?? [0, 1];
  const [from, to] = [low, high].map((end) => along(axis, end));
  const place = (/** @type {number} */ value) => (along(axis, value) - from) / (to - from || 1);
  const between = ticks(axis, low, high, 3).map(({ at }) => at).filter((at) => place(at) > 0.24 && place(at) < 0.76);
  const labels = (marks ?? [low, ...between, high]).map((value) => {
    const label = el('i', {}, shown(value));
    label.style.left = `${100 * place(value)}%`;
    return label;
  });
  // What is no more than rounding is not above.
  const above = largest > high * 1.0001 ? `; above ${shown(high)} the last colour, largest ${figures(largest)}` : '';
  return el('span.scale', {}, el('span.marks', {}, ramp, ...labels), `${axis.label}${above}`);
}

/**
 * A pixel for each cell, the highest row first.
 * @param {number} across @param {number} up @param {(column: number, row: number) => number[] | null} colour
 */
export function cellsOf(across, up, colour) {
  const image = new ImageData(across, up);
  for (let row = 0; row < up; row++) {
    for (let column = 0; column < across; column++) {
      const found = colour(column, row);
      if (found) image.data.set([...found, 255], ((up - 1 - row) * across + column) * 4);
    }
  }
  const canvas = canvasOf({ width: across, height: up });
  contextOf(canvas).putImageData(image, 0, 0);
  return canvas;
}

/** Draws cells over all that there is, or a part. @param {Plot} plot @param {CanvasRenderingContext2D} g @param {HTMLCanvasElement} cells @param {View} [part] */
export function drawCells(plot, g, cells, part = plot.drawing.home) {
  const { x0, x1, y0, y1 } = part;
  const [left, upper] = [plot.pixelX(x0), plot.pixelY(y1)];
  g.imageSmoothingEnabled = false;
  g.drawImage(cells, left, upper, plot.pixelX(x1) - left, plot.pixelY(y0) - upper);
}

/** A heat map as a card. @param {HeatMap} card */
export function heatMapCard(card) {
  const [across, up] = [card.columns.length, card.rows.length];
  const step = (/** @type {number[]} */ list) => list.length > 1 ? (list[list.length - 1] - list[0]) / (list.length - 1) : 1;
  const [dx, dy] = [step(card.columns), step(card.rows)];
  const part = {
    x0: card.columns[0] - dx / 2, x1: card.columns[across - 1] + dx / 2, y0: card.rows[0] - dy / 2, y1: card.rows[up - 1] + dy / 2,
  };
  const [[x0, x1], [y0, y1]] = [card.x.range ?? [part.x0, part.x1], card.y.range ?? [part.y0, part.y1]];
  const level = (/** @type {number} */ value) => (value - card.range[0]) / (card.range[1] - card.range[0] || 1);
  const cells = cellsOf(across, up, (column, row) => {
    const value = card.values[row * across + column];
    return value === null ? null : viridis(level(value));
  });
  /** @param {number} column @param {number} row @returns {Hit | null} */
  const hitOf = (column, row) => {
    if (column < 0 || row < 0 || column >= across || row >= up) return null;
    const value = card.values[row * across + column];
    const [x, y] = [card.columns[column], card.rows[row]];
    const where = `${card.x.label} ${shownAt(card.x, x)}\n${card.y.label} ${shownAt(card.y, y)}`;
    return { x, y, text: `${where}\n${value === null ? card.blank : `${shown(value)} ${card.unit}`}` };
  };
  const largest = card.values.reduce((/** @type {number} */ most, value) => Math.max(most, value ?? most), card.range[0]);
  const keys = [rampOf({ label: card.unit, is_log: false, range: card.range }, largest), el('span', {}, `blank: ${card.blank}`)];
  const names = new Map((card.outlines ?? []).map(outline => [outline.color, outline.label.split(',')[0]]));
  for (const [color, name] of names) keys.push(seriesKey({ name, color, style: 'line' }));
  const { section } = plotCard(card, () => ({
    x: card.x,
    y: card.y,
    home: { x0, x1, y0, y1 },
    isEven: card.is_even,
    name: `${card.title}: ${card.unit} over ${card.x.label} and ${card.y.label}`,
    draw: (plot, g) => {
      drawCells(plot, g, cells, part);
      if (card.is_written) write(plot, g, card, level, [dx, dy]);
      for (const { color, low, high } of card.outlines ?? []) {
        g.lineWidth = 2;
        g.strokeStyle = seriesColour(color);
        const [x, y] = [plot.pixelX(low[0]), plot.pixelY(high[1])];
        g.strokeRect(x, y, plot.pixelX(high[0]) - x, plot.pixelY(low[1]) - y);
      }
    },
    find: (plot, x, y) => hitOf(Math.floor((plot.placeX(x) - part.x0) / dx), Math.floor((plot.placeY(y) - part.y0) / dy)),
    rows: () => [
      [card.x.label, card.y.label, card.unit],
      ...card.values.map((value, k) => [shownAt(card.x, card.columns[k % across]), shownAt(card.y, card.rows[Math.floor(k / across)]), value]),
    ],
    list: () => card.values.flatMap((value, k) => {
      const hit = value === null ? null : hitOf(k % across, Math.floor(k / across));
      return hit ? [hit] : [];
    }),
  }), keys);
  if (card.is_even) section.classList.add('tall');
  return section;
}

/**
 * The value in each field that has room for it.
 * @param {Plot} plot
 * @param {CanvasRenderingContext2D} g
 * @param {HeatMap} card
 * @param {(value: number) => number} level
 * @param {[number, number]} size
 */
function write(plot, g, card, level, [dx, dy]) {
  const [width, height] = [plot.pixelX(dx) - plot.pixelX(0), plot.pixelY(0) - plot.pixelY(dy)];
  if (height < 14) return;
  g.textAlign = 'center';
  g.textBaseline = 'middle';
  card.values.forEach((value, k) => {
    if (value === null) return;
    const text = String(Number(value.toPrecision(3)));
    if (g.measureText(text).width > width - 4) return;
    g.fillStyle = level(value) > 0.6 ? '#111' : '#fff';
    g.fillText(text, plot.pixelX(card.columns[k % card.columns.length]), plot.pixelY(card.rows[Math.floor(k / card.columns.length)]));
  });
}
