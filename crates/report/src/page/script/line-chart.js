// A line chart over anything: linear or logarithmic, zoomed by dragging across, read by pointing.

/**
 * @typedef {{ name: string, x?: Numbers, y: Numbers, colour: string, width?: number, dash?: number[] }} Line y over x, or over its index; NaN breaks it
 * @typedef {{
 *   label: string, lines: () => Line[], range: () => [number, number], log?: boolean, xRange: () => [number, number],
 *   limits?: () => number[], breaks?: () => number[], xTicks?: (low: number, high: number) => number[], xText?: (x: number) => string,
 *   digits?: number, unit?: string, endNames?: boolean, cursor?: () => number | null, onPoint?: (x: number) => void, zoomable?: boolean,
 *   chosen?: () => Numbers | null
 * }} ChartWants chosen: what is marked at the cursor in place of the values of the solid lines, in their order
 */

/** @param {ChartWants} wants @returns {{ host: HTMLElement, refresh: () => void }} */
function lineChart(wants) {
  const plot = plotWith(wants.label, { left: 44, right: wants.endNames ? 30 : 10, top: 8, bottom: 22 });
  const { margins } = plot;
  /** @type {[number, number] | null} */
  let zoom = null;
  let drag = /** @type {[number, number] | null} */ (null);
  let isStale = true;
  /** What is drawn until it is stale: the lines, and the ends of the axis upwards. */
  let lines = /** @type {Line[]} */ ([]);
  let [lowest, highest] = [0, 1];
  const scale = wants.log ? Math.log10 : (/** @type {number} */ v) => v;
  const xs = () => zoom || wants.xRange();
  const xOf = (/** @type {number} */ x) => {
    const [low, high] = xs();
    return margins.left + ((x - low) / (high - low || 1)) * (plot.width - margins.left - margins.right);
  };
  const xAt = (/** @type {number} */ pixel) => {
    const [low, high] = xs();
    return low + ((pixel - margins.left) / Math.max(1, plot.width - margins.left - margins.right)) * (high - low);
  };
  const yOf = (/** @type {number} */ value) => {
    const share = (clamp(scale(value), lowest, highest) - lowest) / (highest - lowest || 1);
    return plot.height - margins.bottom - share * (plot.height - margins.top - margins.bottom);
  };

  const drawStill = () => {
    const g = plot.still;
    clear(g, plot);
    const [low, high] = wants.range();
    [lowest, highest] = [scale(low), scale(high)];
    lines = wants.lines();
    const bottom = plot.height - margins.bottom;
    g.textBaseline = 'middle';
    g.textAlign = 'right';
    for (const tick of wants.log ? decadesBetween(low, high) : ticksBetween(low, high)) {
      g.strokeStyle = themeColour('--grid');
      stroke(g, [
        [margins.left, Math.round(yOf(tick)) + 0.5],
        [plot.width - margins.right, Math.round(yOf(tick)) + 0.5],
      ]);
      g.fillStyle = themeColour('--soft');
      g.fillText(String(tick), margins.left - 7, yOf(tick));
    }
    g.textAlign = 'center';
    const [left, right] = xs();
    for (const tick of (wants.xTicks || ((a, b) => ticksBetween(a, b, 5)))(left, right)) {
      g.fillText(wants.xText ? wants.xText(tick) : String(tick), xOf(tick), plot.height - 10);
    }
    g.save();
    g.beginPath();
    g.rect(margins.left, 0, plot.width - margins.left - margins.right, plot.height);
    g.clip();
    g.strokeStyle = themeColour('--line');
    for (const x of wants.breaks ? wants.breaks() : [])
      stroke(g, [
        [xOf(x), margins.top],
        [xOf(x), bottom],
      ]);
    g.strokeStyle = themeColour('--bad');
    g.setLineDash([5, 4]);
    g.lineWidth = 1.2;
    for (const y of wants.limits ? wants.limits() : [])
      stroke(g, [
        [margins.left, yOf(y)],
        [plot.width, yOf(y)],
      ]);
    for (const line of lines) {
      g.strokeStyle = themeColour(line.colour);
      g.lineWidth = line.width || 1.6;
      g.lineJoin = 'round';
      g.setLineDash(line.dash || []);
      drawLine(g, line);
    }
    g.restore();
    if (wants.endNames) nameEnds(g);
  };

  /** Many points to a pixel are drawn by the lowest and the highest of them. @param {CanvasRenderingContext2D} g @param {Line} line */
  const drawLine = (g, line) => {
    const stops = new Set(wants.breaks ? wants.breaks().map(Math.ceil) : []);
    g.beginPath();
    let isOpen = false;
    let pixel = -Infinity;
    let [least, most] = [0, 0];
    for (let k = 0; k < line.y.length; k++) {
      const x = line.x ? line.x[k] : k;
      const y = line.y[k];
      if (!line.x && stops.has(k)) isOpen = false;
      if (!Number.isFinite(y)) {
        isOpen = false;
        continue;
      }
      const [px, py] = [xOf(x), yOf(y)];
      if (!isOpen) g.moveTo(px, py);
      else if (px - pixel >= 0.5) g.lineTo(px, py);
      else if (py < least || py > most) g.lineTo(pixel, py);
      if (!isOpen || px - pixel >= 0.5) [pixel, least, most] = [px, py, py];
      else [least, most] = [Math.min(least, py), Math.max(most, py)];
      isOpen = true;
    }
    g.stroke();
  };

  const nameEnds = (/** @type {CanvasRenderingContext2D} */ g) => {
    g.textAlign = 'left';
    g.font = `600 ${g.font}`;
    let last = -99;
    const ends = lines.map((line) => ({ line, y: yOf(line.y[line.y.length - 1]) })).sort((a, b) => a.y - b.y);
    for (const { line, y } of ends) {
      last = Math.max(y, last + 12);
      g.fillStyle = themeColour(line.colour);
      g.fillText(line.name, plot.width - margins.right + 6, last);
    }
  };

  const drawTop = () => {
    const g = plot.top;
    clear(g, plot);
    const at = wants.cursor ? wants.cursor() : null;
    if (at !== null) {
      g.strokeStyle = themeColour('--ink');
      stroke(g, [
        [xOf(at), margins.top],
        [xOf(at), plot.height - margins.bottom],
      ]);
      const chosen = wants.chosen ? wants.chosen() : null;
      for (const [k, line] of lines.filter(({ dash, x }) => !dash && !x).entries()) {
        const y = chosen ? chosen[k] : line.y[Math.round(at)];
        if (!Number.isFinite(y)) continue;
        g.fillStyle = themeColour('--card');
        g.beginPath();
        g.arc(xOf(at), yOf(y), 5, 0, 7);
        g.fill();
        g.fillStyle = themeColour(line.colour);
        g.beginPath();
        g.arc(xOf(at), yOf(y), 3.4, 0, 7);
        g.fill();
      }
    }
    if (drag) {
      g.fillStyle = themeColour('--accent');
      g.globalAlpha = 0.15;
      g.fillRect(
        Math.min(...drag),
        margins.top,
        Math.abs(drag[1] - drag[0]),
        plot.height - margins.top - margins.bottom,
      );
    }
  };

  const refresh = () => {
    isStale = true;
    redraw();
  };
  const redraw = () => {
    if (fit(plot) || isStale) drawStill();
    isStale = false;
    drawTop();
  };
  onChange((changed) => {
    isStale ||= Boolean(changed.case || changed.theme);
    redraw();
  });

  const read = (/** @type {number} */ x) => {
    const words = lines.map((line) => {
      const index = line.x ? nearestIndex(line.x, x) : Math.round(x);
      return `${line.name}  ${fixed(line.y[index], wants.digits ?? 3)}`;
    });
    return [wants.xText ? wants.xText(x) : fixed(x, 0), ...words].join('\n');
  };
  const { surface } = plot;
  surface.style.cursor = wants.onPoint ? 'ew-resize' : 'crosshair';
  const [min, max] = [() => xs()[0], () => xs()[1]];
  const pointed = (/** @type {PointerEvent} */ event) => {
    const box = surface.getBoundingClientRect();
    const pixel = event.clientX - box.left;
    const x = clamp(xAt(pixel), min(), max());
    say(plot, read(x), xOf(x), margins.top + 70);
    if (drag) {
      drag[1] = clamp(pixel, margins.left, plot.width - margins.right);
      drawTop();
    } else if (event.buttons && wants.onPoint) wants.onPoint(x);
  };
  surface.addEventListener('pointermove', pointed);
  surface.addEventListener('pointerdown', (event) => {
    surface.setPointerCapture(event.pointerId);
    if (wants.zoomable) {
      const pixel = clamp(
        event.clientX - surface.getBoundingClientRect().left,
        margins.left,
        plot.width - margins.right,
      );
      drag = [pixel, pixel];
    } else pointed(event);
  });
  surface.addEventListener('pointerup', () => {
    if (drag && Math.abs(drag[1] - drag[0]) > 6) {
      const ends = drag.map(xAt).sort((a, b) => a - b);
      zoom = [ends[0], ends[1]];
    }
    drag = null;
    refresh();
  });
  surface.addEventListener('dblclick', () => {
    zoom = null;
    refresh();
  });
  surface.addEventListener('pointerleave', () => say(plot, '', 0, 0));
  return { host: plot.host, refresh };
}

/** @param {Numbers} all ascending or not @param {number} x */
function nearestIndex(all, x) {
  let best = 0;
  for (let k = 1; k < all.length; k++) if (Math.abs(all[k] - x) < Math.abs(all[best] - x)) best = k;
  return best;
}
