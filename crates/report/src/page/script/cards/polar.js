// Deviations from a reference circle over the angle.

import { seriesColour } from '../draw/chart.js';
import { choice, el } from '../draw/dom.js';
import { disc, plotCard, stroke } from '../draw/plot.js';
import { shown } from '../draw/scale.js';
import { themeColour } from '../draw/theme.js';
/** @import { Polar, PolarChoice } from '../draw/chart-data.js' */
/** @import { Hit, Plot } from '../draw/plot.js' */

/** Where the reference circle is drawn, and how far the largest deviation goes from it, in radii of the plot. */
const [REFERENCE, SWING] = [0.68, 0.26];

/**
 * @param {Polar} card
 * @returns {HTMLElement}
 */
export function polarCard(card) {
  let chosen = card.choices[0];
  const radius = (/** @type {number} */ deviation) => {
    const largest = Math.max(...chosen.band.map(Math.abs)) || 1;
    return REFERENCE + SWING * deviation / largest;
  };
  /** @param {number} k @returns {Hit | null} */
  const hitOf = k => {
    const deviation = chosen.deviations[k];
    if (deviation === null || deviation === undefined) return null;
    const [angle, r] = [card.angles[k] * Math.PI / 180, radius(deviation)];
    const left = card.excluded[k] ? ', left out' : '';
    const text = `point ${k}${left}\nangle ${shown(card.angles[k])} deg\ndeviation ${shown(deviation)} ${card.unit}`;
    return { x: r * Math.cos(angle), y: r * Math.sin(angle), text };
  };
  const said = el('span.sub', { role: 'status' }, chosen.detail);
  const made = plotCard(card, () => ({
    x: { label: '', is_log: false },
    y: { label: '', is_log: false },
    home: { x0: -1.06, x1: 1.06, y0: -1.06, y1: 1.06 },
    isEven: true,
    margins: { left: 4, right: 4, top: 4, bottom: 4 },
    frame: () => {},
    name: `${card.title}: deviation in ${card.unit} over the angle`,
    draw: (plot, g) => drawPolar(plot, g, card, chosen, radius),
    find: (plot, x, y) => {
      let [best, nearest] = [-1, 40 ** 2];
      card.angles.forEach((_, k) => {
        const hit = hitOf(k);
        if (!hit) return;
        const distance = (plot.pixelX(hit.x) - x) ** 2 + (plot.pixelY(hit.y ?? 0) - y) ** 2;
        if (distance < nearest) [best, nearest] = [k, distance];
      });
      return best < 0 ? null : hitOf(best);
    },
    rows: () => [
      ['point', 'angle (deg)', ...card.choices.map(({ name }) => `deviation ${name} (${card.unit})`), 'left out'],
      ...card.angles.map((angle, k) => [k, angle, ...card.choices.map(({ deviations }) => deviations[k]), card.excluded[k] ? 'yes' : 'no']),
    ],
    list: () => card.angles.flatMap((_, k) => hitOf(k) ?? []),
  }), [said]);
  made.section.classList.add('tall');
  const names = card.choices.map(({ name }) => name);
  const group = choice('Reference circle', names, () => card.choices.indexOf(chosen), (k) => {
    chosen = card.choices[k];
    said.textContent = chosen.detail;
    made.plot.draw();
  });
  made.section.querySelector('.head')?.after(group);
  return made.section;
}

/**
 * @param {Plot} plot
 * @param {CanvasRenderingContext2D} g
 * @param {Polar} card
 * @param {PolarChoice} chosen
 * @param {(deviation: number) => number} radius
 */
function drawPolar(plot, g, card, chosen, radius) {
  const [cx, cy] = [plot.pixelX(0), plot.pixelY(0)];
  const scale = plot.pixelX(1) - cx;
  const ring = (/** @type {number} */ r) => {
    g.beginPath();
    g.arc(cx, cy, Math.max(0, r * scale), 0, 2 * Math.PI);
    g.stroke();
  };
  g.lineWidth = 1;
  g.strokeStyle = themeColour('--grid');
  g.fillStyle = themeColour('--soft');
  g.textAlign = 'center';
  g.textBaseline = 'middle';
  for (let angle = 0; angle < 360; angle += 30) {
    const [c, s] = [Math.cos(angle * Math.PI / 180), Math.sin(angle * Math.PI / 180)];
    stroke(g, [cx, cy], [cx + 0.96 * scale * c, cy - 0.96 * scale * s]);
    g.fillText(`${angle}°`, cx + 1.01 * scale * c, cy - 1.01 * scale * s);
  }
  g.strokeStyle = themeColour('--soft');
  ring(REFERENCE);
  g.strokeStyle = themeColour('--bad');
  g.setLineDash([5, 4]);
  chosen.band.forEach(deviation => ring(radius(deviation)));
  g.setLineDash([]);
  g.strokeStyle = seriesColour(0);
  g.lineWidth = 1.4;
  const order = card.angles.map((_, k) => k).filter(k => !card.excluded[k]).sort((a, b) => card.angles[a] - card.angles[b]);
  g.beginPath();
  order.forEach((k, n) => {
    const [angle, r] = [card.angles[k] * Math.PI / 180, radius(chosen.deviations[k] ?? 0) * scale];
    g[n ? 'lineTo' : 'moveTo'](cx + r * Math.cos(angle), cy - r * Math.sin(angle));
  });
  g.closePath();
  g.stroke();
  card.angles.forEach((degrees, k) => {
    const [angle, r] = [degrees * Math.PI / 180, radius(chosen.deviations[k] ?? 0) * scale];
    const colour = card.excluded[k] ? themeColour('--soft') : seriesColour(0);
    disc(g, cx + r * Math.cos(angle), cy - r * Math.sin(angle), 2.2, colour);
  });
}
