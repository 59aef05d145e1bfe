// The deflection map: spindle angle over path point. Any state of it can be chosen, and the robot takes it.

import { legendOf } from '../draw/chart.js';
import { canvasOf, card, contextOf, el } from '../draw/dom.js';
import { cellsOf, drawCells } from '../draw/heat-map.js';
import { Plot, disc, stroke } from '../draw/plot.js';
import { clamp, fixed } from '../draw/scale.js';
import { themeColour } from '../draw/theme.js';
import { colourOf, errorRamp } from './colour.js';
import { CASES, COUNT, postureText } from './data.js';
import { RUNS, pathPoint } from './path.js';
import { pause } from './play.js';
import { current, currentMap, currentPoint, mapState, onChange, set, state } from './state.js';
/** @import { StateMap } from './data.js' */
/** @import { Chosen } from './state.js' */

/** Words for the reasons of the tables. @param {string} reason */
export function reasonText(reason) {
  if (reason.startsWith('joint_')) return `limit of joint ${reason.slice(6)}`;
  /** @type {Record<string, string>} */
  const words = { reach: 'out of reach', conditioning: 'near a singularity', deflection: 'deflection above its limit', lean: 'limit of the lean' };
  return words[reason] || reason.replace(/_/g, ' ');
}

/** Reasons are told apart by how they are hatched: the slope of the lines and their distance. */
const HATCHES = [
  [1, 6],
  [-1, 6],
  [1, 3],
  [-1, 3],
  [0, 5],
  [2, 5],
  [-2, 5],
  [0, 3],
];

/** @param {CanvasRenderingContext2D} g @param {number} k number of the reason @param {number} width @param {number} height */
export function hatch(g, k, width, height) {
  const [slope, gap] = HATCHES[k % HATCHES.length];
  g.strokeStyle = themeColour('--soft');
  g.globalAlpha = 0.5;
  g.lineWidth = 0.7;
  g.beginPath();
  const reach = Math.abs(slope) * height;
  if (slope === 0) {
    for (let y = 0; y < height; y += gap) {
      g.moveTo(0, y);
      g.lineTo(width, y);
    }
  } else {
    for (let x = -reach; x < width + reach; x += gap) {
      g.moveTo(x, slope > 0 ? height : 0);
      g.lineTo(x + reach, slope > 0 ? 0 : height);
    }
  }
  g.stroke();
  g.globalAlpha = 1;
}

/** The drawn point nearest to a column of a map. @param {StateMap} map @param {number} column */
function pointOfColumn(map, column) {
  const asked = map.points[column];
  let best = 0;
  for (let i = 0; i < COUNT; i++) if (Math.abs(pathPoint(i) - asked) < Math.abs(pathPoint(best) - asked)) best = i;
  return best;
}

export function mapCard() {
  const host = el('div.plot.tall', { id: 'map', tabindex: 0 });
  const legend = el('div.legend');
  const reading = el('span.sub', { id: 'map-reading', 'aria-live': 'polite' });
  const columns = () => currentMap()?.points.length || COUNT;
  // Places along the map in its columns: its points are evenly chosen of the path's.
  const columnOf = (/** @type {number} */ t) => {
    const map = currentMap();
    if (!map) return t;
    const i = Math.floor(t);
    return nearestColumn(map, pathPoint(i)) + (map.points.length === COUNT ? t - i : 0);
  };

  /** @param {Plot} plot @param {CanvasRenderingContext2D} g @param {StateMap} map */
  const drawStates = (plot, g, map) => {
    const [wide, high] = [map.points.length, map.betaCount];
    /** @type {[number, number][][]} */
    const refused = map.reasons.map(() => []);
    const cells = cellsOf(wide, high, (column, k) => {
      const row = column * high + k;
      if (map.codes[row] < 16) return colourOf(map.scores[row]);
      refused[map.codes[row] - 16].push([column, k]);
      return null;
    });
    drawCells(plot, g, cells);
    const [w, h] = [(plot.right - plot.left) / wide, (plot.lower - plot.upper) / high];
    refused.forEach((cells, k) => {
      g.save();
      g.beginPath();
      for (const [column, row] of cells) g.rect(plot.left + column * w, plot.upper + (high - 1 - row) * h, w + 0.3, h + 0.3);
      g.clip();
      hatch(g, k, plot.width, plot.height);
      g.restore();
    });
  };

  /** @param {Plot} plot @param {CanvasRenderingContext2D} g */
  const frame = (plot, g) => {
    g.fillStyle = themeColour('--soft');
    g.textAlign = 'right';
    g.textBaseline = 'middle';
    for (const beta of [-180, -90, 0, 90, 180]) {
      g.fillText(`${beta}°`, plot.left - 6, clamp(plot.pixelY(beta), plot.upper + 4, plot.lower - 3));
    }
    g.textAlign = 'center';
    g.textBaseline = 'top';
    RUNS.forEach(([first, last], k) => {
      const [from, to] = [plot.pixelX(columnOf(first)), plot.pixelX(columnOf(last))];
      const words = to - from > 64 ? `segment ${k + 1}` : to - from > 14 ? String(k + 1) : '';
      g.fillText(words, (from + to) / 2, plot.lower + 7);
    });
  };

  /** @param {Plot} plot @param {CanvasRenderingContext2D} g */
  const drawEdges = (plot, g) => {
    g.strokeStyle = themeColour('--card');
    g.lineWidth = 2;
    for (const [k, [first]] of RUNS.length > 60 ? [] : RUNS.slice(1).entries()) {
      const edge = plot.pixelX((columnOf(first) + columnOf(RUNS[k][1])) / 2);
      stroke(g, [edge, plot.upper], [edge, plot.lower]);
    }
    g.strokeStyle = themeColour('--line');
    g.lineWidth = 1;
    g.strokeRect(plot.left, plot.upper, plot.right - plot.left, plot.lower - plot.upper);
  };

  /** @param {Plot} plot @param {CanvasRenderingContext2D} g */
  const drawPlans = (plot, g) => {
    const own = current();
    g.lineJoin = 'round';
    for (const of of CASES.filter((one) => one.place === own.place).sort((a) => (a === own ? 1 : -1))) {
      const beta = of.columns.beta_deg;
      for (const [colour, width] of /** @type {[string, number][]} */ ([
        ['#fff', of === own ? 4.5 : 3],
        [themeColour(of.plan ? '--bad' : '--good'), of === own ? 2.6 : 1.4],
      ])) {
        g.strokeStyle = colour;
        g.lineWidth = width;
        g.setLineDash(of.plan ? [7, 4] : []);
        g.globalAlpha = of === own ? 1 : 0.75;
        g.beginPath();
        for (const [first, last] of RUNS) {
          for (let i = first; i <= last; i++) {
            // The angle goes round: no line from the top to the bottom.
            const isNew = i === first || Math.abs(beta[i] - beta[i - 1]) > 180;
            g[isNew ? 'moveTo' : 'lineTo'](plot.pixelX(columnOf(i)), plot.pixelY(beta[i]));
          }
        }
        g.stroke();
      }
      g.setLineDash([]);
      g.globalAlpha = 1;
    }
  };

  const explain = () => {
    const reasons = (currentMap()?.reasons ?? []).map((reason, k) => {
      const sample = canvasOf({ class: 'reason', width: 18, height: 9 });
      hatch(contextOf(sample), k, 18, 9);
      return el('span', {}, sample, reasonText(reason));
    });
    const plans = legendOf([
      { name: 'best plan', color: '--good', style: 'line', y: [] },
      { name: 'worst plan', color: '--bad', style: 'dashed', y: [] },
    ]);
    const largest = currentMap()?.scores.reduce((most, score) => Math.max(most, score || 0), 0);
    legend.replaceChildren(errorRamp(largest), ...plans, ...reasons);
  };

  /** The cursor. @param {Plot} plot @param {CanvasRenderingContext2D} g */
  const drawOver = (plot, g) => {
    const map = currentMap();
    let [column, beta] = [columnOf(state.t), current().columns.beta_deg[currentPoint()]];
    if (state.chosen && map) [column, beta] = [state.chosen.column, mapState(map, state.chosen).beta];
    const [x, y] = [plot.pixelX(column), plot.pixelY(beta)];
    g.strokeStyle = themeColour('--ink');
    g.globalAlpha = 0.8;
    stroke(g, [x, plot.upper], [x, plot.lower]);
    g.globalAlpha = 1;
    disc(g, x, y, 6, '#fff');
    disc(g, x, y, 4, themeColour(state.chosen ? '--accent' : current().plan ? '--bad' : '--good'));
  };

  const stateText = (/** @type {StateMap} */ map, /** @type {Chosen} */ at) => {
    const found = mapState(map, at);
    const what = found.isAllowed ? `${fixed(found.score, 4)} mm, ${postureText(found.posture)}` : reasonText(found.reason);
    return `point ${found.point}, β ${fixed(found.beta, 1)}°: ${what}`;
  };

  /** The state under the pointer. @param {Plot} plot @param {number} x @param {number} y @returns {Chosen | null} */
  const under = (plot, x, y) => {
    const map = currentMap();
    const column = Math.floor(plot.placeX(x) + 0.5);
    const turns = (plot.placeY(y) + 180) / 360;
    if (!map || column < 0 || column >= map.points.length || turns < 0 || turns > 1) return null;
    return { column, beta: Math.round(turns * map.betaCount) % map.betaCount };
  };
  const choose = (/** @type {Chosen} */ chosen) => {
    const map = currentMap();
    if (!map) return;
    pause();
    set({ t: pointOfColumn(map, chosen.column), chosen });
  };
  const plot = new Plot(host, () => ({
    x: { label: 'point', is_log: false },
    y: { label: 'β', is_log: false },
    home: { x0: -0.5, x1: columns() - 0.5, y0: -180, y1: 180 },
    margins: { left: 42, right: 8, top: 8, bottom: 26 },
    name: 'Deflection over path point and spindle angle; arrow keys choose a state, Escape returns to the plan',
    frame,
    draw: (plot, g) => {
      const map = currentMap();
      if (map) drawStates(plot, g, map);
      drawEdges(plot, g);
      drawPlans(plot, g);
    },
    drawOver,
    rows: () => {
      const map = currentMap();
      const states = (/** @type {StateMap} */ of) =>
        Array.from(of.codes, (_, row) => {
          const { point, beta, score, isAllowed, posture, reason } = mapState(of, { column: Math.floor(row / of.betaCount), beta: row % of.betaCount });
          return [point, beta, isAllowed ? +score.toFixed(4) : null, isAllowed ? posture : null, reason];
        });
      return [['point', 'beta_deg', 'score_mm', 'posture', 'reason'], ...(map ? states(map) : [])];
    },
    find: (plot, x, y) => {
      const [map, at] = [currentMap(), under(plot, x, y)];
      return map && at ? { x: at.column, y: mapState(map, at).beta, text: stateText(map, at) } : null;
    },
    onPoint: (plot, x, y) => {
      const at = under(plot, x, y);
      if (at) choose(at);
    },
  }));
  plot.top.style.touchAction = 'pan-y';

  onChange((changed) => {
    if (changed.case) plot.refresh();
    else plot.over();
    if (changed.case || changed.theme) explain();
    const map = currentMap();
    const hint = map ? 'spindle angle β over path point; drag to choose a state' : 'both plans; the run has made no map';
    reading.textContent = state.chosen && map ? stateText(map, state.chosen) : hint;
  });
  host.addEventListener('keydown', (event) => {
    const map = currentMap();
    const step = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] }[event.key];
    if (event.key === 'Escape') set({ chosen: null });
    if (!map || !step) return;
    event.preventDefault();
    event.stopPropagation();
    const column = nearestColumn(map, pathPoint(currentPoint()));
    const plan = Math.round(((current().columns.beta_deg[currentPoint()] + 180) / 360) * map.betaCount);
    const from = state.chosen || { column, beta: plan % map.betaCount };
    choose({
      column: clamp(from.column + step[0], 0, map.points.length - 1),
      beta: (from.beta + step[1] + map.betaCount) % map.betaCount,
    });
  });
  const out = card('Deflection map', '', host, legend);
  out.classList.add('mapbox');
  /** @type {HTMLElement} */ (out.firstChild).append(reading);
  return out;
}

/** @param {StateMap} map @param {number} point of the path */
function nearestColumn(map, point) {
  const step = map.points.length > 1 ? map.points[1] - map.points[0] : 1;
  return clamp(Math.round(point / step), 0, map.points.length - 1);
}
