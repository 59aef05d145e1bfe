// Curves, dots and intervals over two axes.

/**
 * @param {ChartCard} card
 * @returns {HTMLElement}
 */
function chartCard(card) {
  const points = card.series.map(series => series.x.map((x, k) => place(card, x, series.y[k])));
  const ends = card.series.flatMap(series => [...(series.low ?? []), ...(series.high ?? [])]);
  const levels = (card.marks ?? []).filter(mark => mark.is_level).map(mark => along(card.y, mark.at));
  const found = points.flat().filter(point => point !== null);
  const heights = [...found.map(point => point[1]), ...ends.flatMap(end => end === null ? [] : [along(card.y, end)]), ...levels];
  const [x0, x1] = extent(found.map(point => point[0]), card.series.every(series => isCurve(series)) ? 0 : 0.05);
  const [y0, y1] = extent(heights.filter(Number.isFinite), 0.06);
  /** @param {number} s @param {number} k @returns {Hit | null} */
  const hitOf = (s, k) => {
    const [series, point] = [card.series[s], points[s][k]];
    if (!point) return null;
    const interval = series.low && series.high ? `, ${shown(series.low[k] ?? NaN)} to ${shown(series.high[k] ?? NaN)}` : '';
    const values = `${card.x.label} ${shownAt(card.x, point[0])}\n${card.y.label} ${shownAt(card.y, point[1])}${interval}`;
    const text = [card.series.length > 1 ? series.name : '', series.labels?.[k] ?? '', values].filter(Boolean).join('\n');
    return { x: point[0], y: point[1], text, link: series.links?.[k] };
  };
  const { section } = plotCard(card, {
    x: card.x,
    y: card.y,
    home: { x0, x1, y0, y1 },
    isEven: card.is_even,
    name: `${card.title}: ${card.y.label} over ${card.x.label}`,
    draw: (plot, g) => {
      for (const mark of card.marks ?? []) drawMark(plot, g, card, mark);
      card.series.forEach((series, s) => drawSeries(plot, g, card, series, points[s]));
    },
    find: (plot, x, y) => {
      // What lies across counts for more: a curve is read at the pointer.
      let [best, nearest] = [/** @type {Hit | null} */ (null), 40 ** 2];
      points.forEach((list, s) => list.forEach((point, k) => {
        if (!point) return;
        const [dx, dy] = [plot.pixelX(point[0]) - x, plot.pixelY(point[1]) - y];
        const distance = dx * dx + dy * dy * (isCurve(card.series[s]) ? 0.2 : 1);
        if (distance < nearest) [best, nearest] = [hitOf(s, k), distance];
      }));
      return best;
    },
    list: () => points.flatMap((list, s) => list.map((_, k) => hitOf(s, k))).flatMap(hit => hit ? [hit] : []),
  }, card.series.filter(series => series.name).map(series => seriesKey(series)));
  if (card.is_wide) section.classList.add('wide');
  if (card.is_even) section.classList.add('tall');
  return section;
}

/** @param {Series} series */
function isCurve(series) {
  return series.style === 'line' || series.style === 'dashed';
}

/**
 * @param {ChartCard} card
 * @param {number | null} x
 * @param {number | null} y
 * @returns {[number, number] | null}
 */
function place(card, x, y) {
  if (x === null || y === null) return null;
  const [across, up] = [along(card.x, x), along(card.y, y)];
  return Number.isFinite(across) && Number.isFinite(up) ? [across, up] : null;
}

/**
 * The sign of a series with its name.
 * @param {Series} series
 */
function seriesKey(series) {
  const sign = element('i', { class: `swatch ${isCurve(series) ? series.style : 'dot'}` });
  const paint = () => sign.style.setProperty('--sign', seriesColour(series.color));
  paint();
  themeListeners.push(paint);
  return element('span', {}, sign, series.name);
}

/**
 * @param {Plot} plot
 * @param {CanvasRenderingContext2D} g
 * @param {ChartCard} card
 * @param {Mark} mark
 */
function drawMark(plot, g, card, mark) {
  g.strokeStyle = themeColour('--soft');
  g.fillStyle = themeColour('--soft');
  g.lineWidth = 1.2;
  g.setLineDash([5, 4]);
  g.beginPath();
  if (mark.is_level) {
    const y = plot.pixelY(along(card.y, mark.at));
    g.moveTo(plot.left, y);
    g.lineTo(plot.right, y);
    g.textAlign = 'right';
    g.textBaseline = 'bottom';
    g.fillText(mark.label, plot.right - 6, y - 3);
  } else {
    const x = plot.pixelX(along(card.x, mark.at));
    g.moveTo(x, plot.upper);
    g.lineTo(x, plot.lower);
    g.textAlign = 'left';
    g.textBaseline = 'top';
    g.fillText(mark.label, x + 4, plot.upper + 4);
  }
  g.stroke();
  g.setLineDash([]);
}

/**
 * @param {Plot} plot
 * @param {CanvasRenderingContext2D} g
 * @param {ChartCard} card
 * @param {Series} series
 * @param {([number, number] | null)[]} points
 */
function drawSeries(plot, g, card, series, points) {
  g.strokeStyle = g.fillStyle = seriesColour(series.color);
  g.lineWidth = 1.6;
  g.lineJoin = 'round';
  if (isCurve(series)) {
    g.setLineDash(series.style === 'dashed' ? [5, 4] : []);
    g.beginPath();
    let isDown = false;
    for (const point of points) {
      if (point) g[isDown ? 'lineTo' : 'moveTo'](plot.pixelX(point[0]), plot.pixelY(point[1]));
      isDown = point !== null;
    }
    g.stroke();
    g.setLineDash([]);
    return;
  }
  points.forEach((point, k) => {
    if (!point) return;
    const [x, y] = [plot.pixelX(point[0]), plot.pixelY(point[1])];
    const [low, high] = [series.low?.[k], series.high?.[k]];
    if (low != null && high != null) {
      const [a, b] = [plot.pixelY(along(card.y, low)), plot.pixelY(along(card.y, high))];
      g.beginPath();
      for (const end of [a, b]) {
        g.moveTo(x - 5, end);
        g.lineTo(x + 5, end);
      }
      g.moveTo(x, a);
      g.lineTo(x, b);
      g.stroke();
    }
    g.beginPath();
    g.arc(x, y, series.style === 'rings' ? 6 : 3, 0, 2 * Math.PI);
    if (series.style === 'rings') g.stroke();
    else g.fill();
  });
}
