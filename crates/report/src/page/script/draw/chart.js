// Curves, dots and intervals over two axes.

import { el } from './dom.js';
import { Plot, disc, plotCard, stroke } from './plot.js';
import { along, clamp, extent, fixed, shown, shownAt } from './scale.js';
import { propertyOf, themeColour } from './theme.js';
/** @import { Axis, Chart, Mark, Numbers, Series } from './chart-data.js' */
/** @import { Drawing, Hit } from './plot.js' */

/**
 * @typedef {object} Reading how a chart is read at a place across, all its series at once, where a place across means something
 * @property {number} [digits] decimals of the values
 * @property {() => number} at the place that is marked
 * @property {() => Numbers | null} [chosen] what is marked there in place of the values of the solid curves, in their order
 * @property {(x: number) => void} onPoint what pointing to a place does
 * @property {boolean} [hasNames] whether the names of the series stand at their ends
 */

/** The colour of a series now. @param {number | string} colour */
export const seriesColour = (colour) => themeColour(propertyOf(colour));

/** @param {Series} series */
const isCurve = (series) => series.style === 'line' || series.style === 'dashed';

/** The sign of a series with its name. @param {Pick<Series, 'name' | 'color' | 'style'>} series */
export function seriesKey({ name, color, style }) {
  const sign = el(`i.swatch.${style === 'line' || style === 'dashed' ? style : 'dot'}`);
  sign.style.setProperty('--sign', `var(${propertyOf(color)})`);
  return el('span', {}, sign, name);
}

/** @param {Series[]} series */
export const legendOf = (series) => series.filter(({ name }) => name).map(seriesKey);

/** A chart as a card. @param {Chart} chart */
export function chartCard(chart) {
  const { section } = plotCard(chart, () => drawingOf(chart), legendOf(chart.series));
  if (chart.is_wide) section.classList.add('wide');
  if (chart.is_even) section.classList.add('tall');
  return section;
}

/** A chart that is read across, and made anew at each `refresh`. @param {HTMLElement} host @param {() => Chart} make @param {Reading} reading */
export const chartPlot = (host, make, reading) =>
  new Plot(host, () => {
    const chart = make();
    return { ...drawingOf(chart), ...readAcross(chart, reading) };
  });

/** The places of the points of a chart, null for none. @param {Chart} chart */
const placesOf = (chart) =>
  chart.series.map((series) => Array.from(series.y, (y, k) => place(chart, series.x ? series.x[k] : k, y)));

/** @param {Chart} chart @param {number | null} x @param {number | null} y @returns {[number, number] | null} */
function place(chart, x, y) {
  if (x === null || y === null) return null;
  const [across, up] = [along(chart.x, x), along(chart.y, y)];
  return Number.isFinite(across) && Number.isFinite(up) ? [across, up] : null;
}

/** @param {Axis} axis @param {() => [number, number]} found */
const endsOf = (axis, found) =>
  axis.range ? /** @type {[number, number]} */ (axis.range.map((end) => along(axis, end))) : found();

/** @param {Chart} chart @returns {Drawing} */
function drawingOf(chart) {
  const points = placesOf(chart);
  const marks = chart.marks ?? [];
  const found = points.flat().filter((point) => point !== null);
  const [x0, x1] = endsOf(chart.x, () => extent(found.map((point) => point[0]), chart.series.every(isCurve) ? 0 : 0.05));
  const [y0, y1] = endsOf(chart.y, () => {
    const ends = chart.series.flatMap(({ low, high }) => [...Array.from(low ?? []), ...Array.from(high ?? [])]);
    const levels = marks.filter((mark) => mark.is_level).map((mark) => along(chart.y, mark.at));
    const heights = [...found.map((point) => point[1]), ...ends.map((end) => along(chart.y, end ?? NaN)), ...levels];
    return extent(heights.filter(Number.isFinite), 0.06);
  });
  const breaks = marks.filter((mark) => mark.kind === 'break').map((mark) => along(chart.x, mark.at));
  /** @param {number} s @param {number} k @returns {Hit | null} */
  const hitOf = (s, k) => {
    const [series, point] = [chart.series[s], points[s][k]];
    if (!point) return null;
    const interval =
      series.low && series.high ? `, ${shown(series.low[k] ?? NaN)} to ${shown(series.high[k] ?? NaN)}` : '';
    const values = `${chart.x.label} ${shownAt(chart.x, point[0])}\n${chart.y.label} ${shownAt(chart.y, point[1])}${interval}`;
    const text = [chart.series.length > 1 ? series.name : '', series.labels?.[k] ?? '', values].filter(Boolean).join('\n');
    return { x: point[0], y: point[1], text, link: series.links?.[k] };
  };
  return {
    x: chart.x,
    y: chart.y,
    home: { x0, x1, y0, y1 },
    isEven: chart.is_even,
    name: `${chart.title}: ${chart.y.label} over ${chart.x.label}`,
    draw: (plot, g) => {
      for (const mark of marks) drawMark(plot, g, chart, mark);
      chart.series.forEach((series, s) => {
        g.strokeStyle = g.fillStyle = seriesColour(series.color);
        g.lineWidth = series.width ?? 1.6;
        if (isCurve(series)) drawCurve(plot, g, series, points[s], breaks);
        else drawPoints(plot, g, chart, series, points[s]);
      });
    },
    find: (plot, x, y) => {
      // What lies across counts for more: a curve is read at the pointer.
      let [best, nearest] = [/** @type {Hit | null} */ (null), 40 ** 2];
      points.forEach((list, s) =>
        list.forEach((point, k) => {
          if (!point) return;
          const [dx, dy] = [plot.pixelX(point[0]) - x, plot.pixelY(point[1]) - y];
          const distance = dx * dx + dy * dy * (isCurve(chart.series[s]) ? 0.2 : 1);
          if (distance < nearest) [best, nearest] = [hitOf(s, k), distance];
        }),
      );
      return best;
    },
    list: () => points.flatMap((list, s) => list.map((_, k) => hitOf(s, k))).flatMap((hit) => (hit ? [hit] : [])),
    rows: () => rowsOf(chart),
  };
}

/** The figures of a chart: a column for each series where all have the same places across, else a row for each point. @param {Chart} chart */
function rowsOf(chart) {
  const { x, y, series } = chart;
  const at = (/** @type {number} */ place) => x.names?.[place] ?? place;
  if (series.every((one) => !one.x)) {
    const count = Math.max(0, ...series.map((one) => one.y.length));
    const row = (/** @type {number} */ k) => [at(k), ...series.map((one) => one.y[k] ?? null)];
    return [[x.label, ...series.map(({ name }) => (name ? `${name} (${y.label})` : y.label))], ...Array.from({ length: count }, (_, k) => row(k))];
  }
  const rows = series.flatMap((one) =>
    Array.from(one.y, (value, k) => [one.name, at(one.x?.[k] ?? k), value, one.low?.[k] ?? null, one.high?.[k] ?? null, one.labels?.[k] ?? null]),
  );
  return [['series', x.label, y.label, 'from', 'to', 'what'], ...rows];
}

/**
 * How a chart looks and answers that is read across: little around it, a mark where it is read, and no zoom.
 * @param {Chart} chart @param {Reading} reading @returns {Partial<Drawing>}
 */
function readAcross(chart, reading) {
  const margins = { left: 44, right: reading.hasNames ? 30 : 10, top: 8, bottom: 22 };
  const [low, high] = chart.x.range ?? [0, 1];
  const at = (/** @type {Plot} */ plot, /** @type {number} */ x) => clamp(Math.round(plot.placeX(x)), low, high);
  return {
    name: chart.title,
    margins,
    frame: (plot, g) => {
      plot.axes(g, false);
      if (reading.hasNames) nameEnds(plot, g, chart);
    },
    drawOver: (plot, g) => {
      const [now, chosen] = [reading.at(), reading.chosen?.()];
      const x = plot.pixelX(now);
      g.strokeStyle = themeColour('--ink');
      stroke(g, [x, plot.upper], [x, plot.lower]);
      chart.series.filter(({ style, x }) => style === 'line' && !x).forEach((series, k) => {
        const y = (chosen ?? series.y)[chosen ? k : Math.round(now)];
        if (y === null || !Number.isFinite(y)) return;
        const { y0, y1 } = plot.view;
        const height = plot.pixelY(clamp(along(chart.y, y), y0, y1));
        disc(g, x, height, 5, themeColour('--card'));
        disc(g, x, height, 3.4, seriesColour(series.color));
      });
    },
    find: (plot, pixel) => {
      const x = at(plot, pixel);
      const words = chart.series.map((series) => `${series.name}  ${fixed(series.y[x], reading.digits ?? 3)}`);
      return { x, y: null, text: [`${chart.x.label} ${shownAt(chart.x, x)}`, ...words].join('\n') };
    },
    list: undefined,
    onPoint: (plot, pixel) => reading.onPoint(at(plot, pixel)),
  };
}

/** @param {Plot} plot @param {CanvasRenderingContext2D} g @param {Chart} chart */
function nameEnds(plot, g, chart) {
  g.textAlign = 'left';
  g.textBaseline = 'middle';
  g.font = `600 ${g.font}`;
  let last = -99;
  const ends = chart.series.map(({ name, color, y }) => ({ name, color, y: plot.pixelY(y[y.length - 1] ?? NaN) }));
  for (const { name, color, y } of ends.sort((a, b) => a.y - b.y)) {
    last = Math.max(y, last + 12);
    g.fillStyle = seriesColour(color);
    g.fillText(name, plot.right + 6, last);
  }
}

/** @param {Plot} plot @param {CanvasRenderingContext2D} g @param {Chart} chart @param {Mark} mark */
function drawMark(plot, g, chart, mark) {
  g.strokeStyle = themeColour(mark.kind === 'limit' ? '--bad' : mark.kind === 'break' ? '--line' : '--soft');
  g.fillStyle = themeColour('--soft');
  g.lineWidth = mark.kind === 'break' ? 1 : 1.2;
  g.setLineDash(mark.kind === 'break' ? [] : [5, 4]);
  if (mark.is_level) {
    const y = plot.pixelY(along(chart.y, mark.at));
    stroke(g, [plot.left, y], [plot.right, y]);
    g.textAlign = 'right';
    g.textBaseline = 'bottom';
    g.fillText(mark.label, plot.right - 6, y - 3);
  } else {
    const x = plot.pixelX(along(chart.x, mark.at));
    stroke(g, [x, plot.upper], [x, plot.lower]);
    g.textAlign = 'left';
    g.textBaseline = 'top';
    g.fillText(mark.label, x + 4, plot.upper + 4);
  }
  g.setLineDash([]);
}

/**
 * Of many points to a pixel the lowest and the highest are drawn.
 * @param {Plot} plot @param {CanvasRenderingContext2D} g @param {Series} series @param {([number, number] | null)[]} points
 * @param {number[]} breaks
 */
function drawCurve(plot, g, series, points, breaks) {
  g.lineJoin = 'round';
  g.setLineDash(series.style === 'dashed' ? [5, 4] : []);
  g.beginPath();
  let [isOpen, pixel, least, most, next] = [false, -Infinity, 0, 0, 0];
  for (const point of points) {
    while (point && point[0] > breaks[next]) {
      next++;
      isOpen = false;
    }
    if (!point) {
      isOpen = false;
      continue;
    }
    const [x, y] = [plot.pixelX(point[0]), plot.pixelY(point[1])];
    const isNext = !isOpen || Math.abs(x - pixel) >= 0.5;
    if (!isOpen) g.moveTo(x, y);
    else if (isNext) g.lineTo(x, y);
    else if (y < least || y > most) g.lineTo(pixel, y);
    [pixel, least, most] = isNext ? [x, y, y] : [pixel, Math.min(least, y), Math.max(most, y)];
    isOpen = true;
  }
  g.stroke();
  g.setLineDash([]);
}

/**
 * @param {Plot} plot @param {CanvasRenderingContext2D} g @param {Chart} chart @param {Series} series
 * @param {([number, number] | null)[]} points
 */
function drawPoints(plot, g, chart, series, points) {
  points.forEach((point, k) => {
    if (!point) return;
    const [x, y] = [plot.pixelX(point[0]), plot.pixelY(point[1])];
    const [low, high] = [series.low?.[k], series.high?.[k]];
    if (low != null && high != null) {
      const [a, b] = [plot.pixelY(along(chart.y, low)), plot.pixelY(along(chart.y, high))];
      for (const end of [a, b]) stroke(g, [x - 5, end], [x + 5, end]);
      stroke(g, [x, a], [x, b]);
    }
    g.beginPath();
    g.arc(x, y, series.style === 'rings' ? 6 : 3, 0, 2 * Math.PI);
    if (series.style === 'rings') g.stroke();
    else g.fill();
  });
}
