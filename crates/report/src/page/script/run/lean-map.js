// The map over lead and tilt: for every lean at one point the deflection with the best angle about the tool axis.

import { canvasOf, contextOf, el } from '../draw/dom.js';
import { rampOf } from '../draw/heat-map.js';
import { disc, plotCard } from '../draw/plot.js';
import { fixed, percentile, rounded } from '../draw/scale.js';
import { cssOf, themeColour, viridis } from '../draw/theme.js';
import { CASES, RAW, singlesOf } from './data.js';
import { hatch, reasonText } from './map.js';
import { pathPoint } from './path.js';
/** @import { Numbers } from './data.js' */
/** @import { Hit, Plot } from '../draw/plot.js' */

/** The different numbers of a column, ascending. @param {Numbers} column */
const valuesOf = (column) => [...new Set(column)].sort((a, b) => a - b);

/** Where the field of each value ends: half way to the next. @param {number[]} values */
function edgesOf(values) {
  const half = values.length > 1 ? (values[1] - values[0]) / 2 : 0.5;
  const last = values.length > 1 ? (values[values.length - 1] - values[values.length - 2]) / 2 : 0.5;
  const between = values.slice(1).map((value, k) => (value + values[k]) / 2);
  return [values[0] - half, ...between, values[values.length - 1] + last];
}

/** How the tool of the best plan leans at a path point. @param {number} point @returns {[number, number] | null} */
function planned(point) {
  const { lead_deg: lead, tilt_deg: tilt } = CASES[0].columns;
  const at = Array.from(lead ?? [], (_, i) => i).find((i) => pathPoint(i) === point);
  return at === undefined ? null : [lead[at], tilt[at]];
}

/** @returns {HTMLElement | null} where the run has this map */
export function leanMapCard() {
  const map = RAW.lean_map;
  if (!map) return null;
  const [lead, tilt, beta, score] = [map.lead_deg, map.tilt_deg, map.beta_deg, map.score_mm].map(singlesOf);
  const point = singlesOf(map.point)[0];
  const [leads, tilts] = [valuesOf(lead), valuesOf(tilt)];
  const [across, up] = [edgesOf(leads), edgesOf(tilts)];
  const scores = Array.from(score).filter(Number.isFinite);
  // In round steps from the least to what 98 of 100 do not exceed.
  const [least, common, largest] = [Math.min(...scores), percentile(scores, 0.98), Math.max(...scores)];
  const step = rounded((common - least) / 5 || 1);
  const [low, high] = [Math.floor(least / step) * step, Math.ceil(common / step) * step];
  const reasons = /** @type {string[]} */ ([...new Set(map.reason)]).filter((reason) => reason !== '');
  const own = planned(point);

  /** @param {Plot} plot @param {CanvasRenderingContext2D} g */
  const draw = (plot, g) => {
    /** @type {[number, number, number, number][][]} */
    const refused = reasons.map(() => []);
    for (let k = 0; k < lead.length; k++) {
      const [column, row] = [leads.indexOf(lead[k]), tilts.indexOf(tilt[k])];
      const [x, y] = [plot.pixelX(across[column]), plot.pixelY(up[row + 1])];
      const [width, height] = [plot.pixelX(across[column + 1]) - x, plot.pixelY(up[row]) - y];
      if (Number.isFinite(score[k])) {
        g.fillStyle = cssOf(viridis((score[k] - low) / (high - low || 1)));
        g.fillRect(x, y, width + 0.5, height + 0.5);
      } else refused[reasons.indexOf(map.reason[k])].push([x, y, width, height]);
    }
    refused.forEach((fields, k) => {
      g.save();
      g.beginPath();
      for (const field of fields) g.rect(...field);
      g.clip();
      hatch(g, k, plot.width, plot.height);
      g.restore();
    });
    if (own) {
      disc(g, plot.pixelX(own[0]), plot.pixelY(own[1]), 6, '#fff');
      disc(g, plot.pixelX(own[0]), plot.pixelY(own[1]), 4, themeColour('--good'));
    }
  };

  /** What a lean comes to, in words. @param {number} k @returns {Hit} */
  const hitOf = (k) => {
    const where = `lead ${fixed(lead[k], 1)}°, tilt ${fixed(tilt[k], 1)}°`;
    const found = Number.isFinite(score[k]);
    const pair = map.pair?.[k] ? `: ${map.pair[k]}` : '';
    const what = found ? `${fixed(score[k], 4)} mm at β ${fixed(beta[k], 1)}°` : `${reasonText(map.reason[k])}${pair}`;
    return { x: lead[k], y: tilt[k], text: `${where}\n${what}` };
  };
  const all = () => Array.from(lead, (_, k) => hitOf(k));

  const samples = reasons.map((reason, k) => {
    const sample = canvasOf({ class: 'reason', width: 18, height: 9 });
    hatch(contextOf(sample), k, 18, 9);
    return el('span', {}, sample, reasonText(reason));
  });
  const ramp = scores.length ? [rampOf({ label: 'mm', is_log: false, range: [low, high] }, largest)] : [];
  const words = `deg, point ${point}: the largest deflection of the best plan; dot: the plan`;
  const { section } = plotCard(
    { title: 'Lead and tilt', detail: words },
    () => ({
      x: { label: 'lead, deg', is_log: false },
      y: { label: 'tilt, deg', is_log: false },
      home: { x0: across[0], x1: across[leads.length], y0: up[0], y1: up[tilts.length] },
      name: `Deflection over lead and tilt at point ${point}`,
      draw,
      find: (plot, px, py) => {
        const [column, row] = [within(across, plot.placeX(px)), within(up, plot.placeY(py))];
        const k = lead.findIndex((_, k) => lead[k] === leads[column] && tilt[k] === tilts[row]);
        return k < 0 ? null : hitOf(k);
      },
      list: all,
      rows: () => [
        ['lead_deg', 'tilt_deg', 'beta_deg', 'score_mm', 'reason'],
        ...Array.from(lead, (_, k) => {
          const found = Number.isFinite(score[k]);
          return [+lead[k].toFixed(4), +tilt[k].toFixed(4), found ? +beta[k].toFixed(4) : null, found ? +score[k].toFixed(7) : null, map.reason[k]];
        }),
      ],
    }),
    [...ramp, ...samples],
  );
  section.id = 'lean-map';
  return section;
}

/** Between which of the edges a place is, from 0. @param {number[]} edges @param {number} place */
function within(edges, place) {
  return edges.findIndex((edge, k) => k + 1 < edges.length && place >= edge && place < edges[k + 1]);
}
