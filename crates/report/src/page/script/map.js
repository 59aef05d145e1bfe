// The deflection map: spindle angle over path point. Any state of it can be chosen, and the robot takes it.

/** Words for the reasons of the tables. @param {string} reason */
function reasonText(reason) {
  if (reason.startsWith('joint_')) return `limit of joint ${reason.slice(6)}`;
  /** @type {Record<string, string>} */
  const words = { reach: 'out of reach', conditioning: 'near a singularity', deflection: 'deflection above its limit' };
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
function hatch(g, k, width, height) {
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

function mapCard() {
  const plot = plotWith(
    'Deflection over path point and spindle angle; arrow keys choose a state, Escape returns to the plan',
    { left: 42, right: 8, top: 8, bottom: 26 },
    'plot.tall',
  );
  const { margins, host } = plot;
  host.id = 'map';
  host.tabIndex = 0;
  const legend = el('div.legend');
  const reading = el('span.sub', { id: 'map-reading', 'aria-live': 'polite' });
  const inner = () => [plot.width - margins.left - margins.right, plot.height - margins.top - margins.bottom];
  const columns = () => currentMap()?.points.length || COUNT;
  // Places along the map in its columns: its points are evenly chosen of the path's.
  const columnOf = (/** @type {number} */ t) => {
    const map = currentMap();
    if (!map) return t;
    const i = Math.floor(t);
    return nearestColumn(map, pathPoint(i)) + (map.points.length === COUNT ? t - i : 0);
  };
  const xOf = (/** @type {number} */ column) => margins.left + ((column + 0.5) / columns()) * inner()[0];
  const yOf = (/** @type {number} */ beta) => margins.top + ((180 - beta) / 360) * inner()[1];

  const drawStates = (/** @type {StateMap} */ map) => {
    const g = plot.still;
    const [width, height] = inner();
    const [wide, high] = [map.points.length, map.betaCount];
    const image = new ImageData(wide, high);
    /** @type {[number, number][][]} */
    const refused = map.reasons.map(() => []);
    for (let column = 0; column < wide; column++) {
      for (let k = 0; k < high; k++) {
        const row = column * high + k;
        if (map.codes[row] < 16)
          image.data.set([...colourOf(map.scores[row]), 255], ((high - 1 - k) * wide + column) * 4);
        else refused[map.codes[row] - 16].push([column, k]);
      }
    }
    const small = document.createElement('canvas');
    [small.width, small.height] = [wide, high];
    /** @type {CanvasRenderingContext2D} */ (small.getContext('2d')).putImageData(image, 0, 0);
    g.imageSmoothingEnabled = false;
    g.drawImage(small, margins.left, margins.top, width, height);
    const [w, h] = [width / wide, height / high];
    refused.forEach((cells, k) => {
      g.save();
      g.beginPath();
      for (const [column, row] of cells)
        g.rect(margins.left + column * w, margins.top + (high - 1 - row) * h, w + 0.3, h + 0.3);
      g.clip();
      hatch(g, k, plot.width, plot.height);
      g.restore();
    });
  };

  const drawAxes = () => {
    const g = plot.still;
    const [width, height] = inner();
    g.fillStyle = themeColour('--soft');
    g.textAlign = 'right';
    g.textBaseline = 'middle';
    for (const beta of [-180, -90, 0, 90, 180]) {
      g.fillText(`${beta}°`, margins.left - 6, clamp(yOf(beta), margins.top + 4, plot.height - margins.bottom - 3));
    }
    g.textAlign = 'center';
    g.textBaseline = 'top';
    RUNS.forEach(([first, last], k) => {
      const [from, to] = [xOf(columnOf(first)), xOf(columnOf(last))];
      const words = to - from > 64 ? `segment ${k + 1}` : to - from > 14 ? String(k + 1) : '';
      g.fillText(words, (from + to) / 2, plot.height - margins.bottom + 7);
      if (k === 0 || RUNS.length > 60) return;
      const edge = (from + xOf(columnOf(RUNS[k - 1][1]))) / 2;
      g.strokeStyle = themeColour('--card');
      g.lineWidth = 2;
      stroke(g, [
        [edge, margins.top],
        [edge, plot.height - margins.bottom],
      ]);
    });
    g.strokeStyle = themeColour('--line');
    g.lineWidth = 1;
    g.strokeRect(margins.left, margins.top, width, height);
  };

  const drawPlans = () => {
    const g = plot.still;
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
        g.globalAlpha = of === own ? 1 : 0.75;
        g.beginPath();
        for (const [first, last] of RUNS) {
          for (let i = first; i <= last; i++) {
            // The angle goes round: no line from the top to the bottom.
            const isNew = i === first || Math.abs(beta[i] - beta[i - 1]) > 180;
            if (isNew) g.moveTo(xOf(columnOf(i)), yOf(beta[i]));
            else g.lineTo(xOf(columnOf(i)), yOf(beta[i]));
          }
        }
        g.stroke();
      }
      g.globalAlpha = 1;
    }
  };

  const explain = () => {
    const map = currentMap();
    const ramp = /** @type {HTMLCanvasElement} */ (el('canvas.ramp', { width: 110, height: 9, 'aria-hidden': 'true' }));
    const g = /** @type {CanvasRenderingContext2D} */ (ramp.getContext('2d'));
    for (let x = 0; x < 110; x++) {
      g.fillStyle = cssOf(viridis(x / 109));
      g.fillRect(x, 0, 1, 9);
    }
    const swatch = (/** @type {string} */ kind) => el(`i.swatch.${kind}`);
    const reasons = (map ? map.reasons : []).map((reason, k) => {
      const sample = /** @type {HTMLCanvasElement} */ (
        el('canvas.reason', { width: 18, height: 9, 'aria-hidden': 'true' })
      );
      hatch(/** @type {CanvasRenderingContext2D} */ (sample.getContext('2d')), k, 18, 9);
      return el('span', {}, sample, reasonText(reason));
    });
    const plans = [el('span', {}, swatch('good'), 'best plan'), el('span', {}, swatch('bad'), 'worst plan')];
    legend.replaceChildren(el('span', {}, String(SCALE[0]), ramp, `${SCALE[1]} mm`), ...plans, ...reasons);
  };

  const drawStill = () => {
    clear(plot.still, plot);
    const map = currentMap();
    if (map) drawStates(map);
    drawAxes();
    drawPlans();
  };

  const drawTop = () => {
    const g = plot.top;
    clear(g, plot);
    const map = currentMap();
    const plan = current().columns.beta_deg[currentPoint()];
    let [column, beta] = [columnOf(state.t), plan];
    if (state.chosen && map) [column, beta] = [state.chosen.column, mapState(map, state.chosen).beta];
    g.strokeStyle = themeColour('--ink');
    g.globalAlpha = 0.8;
    stroke(g, [
      [xOf(column), margins.top],
      [xOf(column), plot.height - margins.bottom],
    ]);
    g.globalAlpha = 1;
    const dot = (/** @type {number} */ radius, /** @type {string} */ colour) => {
      g.fillStyle = colour;
      g.beginPath();
      g.arc(xOf(column), yOf(beta), radius, 0, 7);
      g.fill();
    };
    dot(6, '#fff');
    dot(4, state.chosen ? themeColour('--accent') : themeColour(current().plan ? '--bad' : '--good'));
  };

  const stateText = (/** @type {StateMap} */ map, /** @type {Chosen} */ at) => {
    const found = mapState(map, at);
    const what = found.isAllowed ? `${fixed(found.score, 4)} mm, posture ${found.posture}` : reasonText(found.reason);
    return `point ${found.point}, β ${fixed(found.beta, 1)}°: ${what}`;
  };

  onChange((changed) => {
    if (fit(plot) || changed.case || changed.theme) drawStill();
    if (changed.case || changed.theme) explain();
    drawTop();
    const map = currentMap();
    const hint = map ? 'spindle angle β over path point; drag to choose a state' : 'both plans; the run has made no map';
    reading.textContent = state.chosen && map ? stateText(map, state.chosen) : hint;
  });

  /** The state under the pointer. @param {PointerEvent} event @returns {Chosen | null} */
  const under = (event) => {
    const map = currentMap();
    const box = plot.surface.getBoundingClientRect();
    const [width, height] = inner();
    const across_ = (event.clientX - box.left - margins.left) / width;
    const down = (event.clientY - box.top - margins.top) / height;
    if (!map || across_ < 0 || across_ >= 1 || down < 0 || down > 1) return null;
    return {
      column: Math.floor(across_ * map.points.length),
      beta: Math.round((1 - down) * map.betaCount) % map.betaCount,
    };
  };
  const choose = (/** @type {Chosen} */ chosen) => {
    const map = currentMap();
    if (!map) return;
    pause();
    set({ t: pointOfColumn(map, chosen.column), chosen });
  };
  const { surface } = plot;
  surface.style.cursor = 'crosshair';
  surface.style.touchAction = 'none';
  surface.addEventListener('pointerdown', (event) => {
    surface.setPointerCapture(event.pointerId);
    const at = under(event);
    if (at) choose(at);
  });
  surface.addEventListener('pointermove', (event) => {
    const [map, at] = [currentMap(), under(event)];
    if (!map || !at) return say(plot, '', 0, 0);
    const box = surface.getBoundingClientRect();
    say(plot, stateText(map, at), event.clientX - box.left, event.clientY - box.top);
    if (event.buttons) choose(at);
  });
  surface.addEventListener('pointerleave', () => say(plot, '', 0, 0));
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
