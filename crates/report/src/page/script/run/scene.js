// The cell in three dimensions.

import { el } from '../draw/dom.js';
import { clamp, fixed } from '../draw/scale.js';
import { isDark, themeRgb } from '../draw/theme.js';
import { axisTrack, platter } from './axis-tracks.js';
import { ARM_FRAMES, BODIES, HAS_ENVELOPES, HAS_SURROUNDINGS, SHAPES, STOCKS, bodiesOf } from './bodies.js';
import { MIDDLE, fieldOf, lookAt, parallel, perspective, placeOf, rayAt, steer, viewOf } from './camera.js';
import { LARGEST_FORCE, deflectionArrows, forceArrows } from './arrows.js';
import { COLOURINGS } from './colour.js';
import { CASES, RAW, REMOVAL } from './data.js';
import { AXES, axesAt, axisFrame, baseFrame, carriedBy, workpieceFrame } from './external-axes.js';
import { buffersOf, free, linesOf, programOf, shadowTarget } from './gpu.js';
import { FARTHEST, framesOf } from './kinematics.js';
import { IDENTITY, add, product, times, unit } from './linear.js';
import { arrows, tubes } from './mesh.js';
import { MAGNIFIED, SCORED, pathMeshes } from './path-mesh.js';
import { DEPTH_FRAGMENT, FRAGMENT, MODE, VERTEX } from './shaders.js';
import { current, currentJoints, onScene, set, state } from './state.js';
import { FLOOR, HAS_BLOCK, HIDES_PATH, block, cellEdges, floorGrid, partEdges, reachBall, reachLines, wallEdges } from './surroundings.js';
/** @import { Buffers, Program } from './gpu.js' */
/** @import { Ray } from './camera.js' */
/** @import { Mat } from './linear.js' */

/** What can be left out of the view, with its words, where there is such a thing. */
export const LAYERS = [
  { name: 'curtain', words: `${SCORED} error`, isThere: true },
  { name: 'deflection', words: 'whole deflection', isThere: true, isOff: true },
  { name: 'forces', words: `forces, up to ${fixed(LARGEST_FORCE, 0)} N`, isThere: LARGEST_FORCE > 0, isOff: !REMOVAL },
  { name: 'after', words: 'stock after', isThere: STOCKS.length > 0 },
  { name: 'before', words: 'stock before', isThere: STOCKS.length > 0, isOff: true },
  { name: 'clear', words: 'see through the part', isThere: true, isOff: !HIDES_PATH },
  { name: 'cell', words: 'cell volume', isThere: true },
  { name: 'reach', words: 'reach', isThere: true },
  { name: 'ghost', words: 'other placement', isThere: CASES.length > 2 || Boolean(RAW.live) },
  { name: 'around', words: 'surroundings', isThere: HAS_SURROUNDINGS },
  { name: 'envelopes', words: 'collision shapes of the arm', isThere: HAS_ENVELOPES, isOff: true },
].filter(({ isThere }) => isThere);

const SHADOW_PIXELS = 2048;
/** How much of a wall of the cell is seen: what is behind it stays readable. */
const PANE = 0.16;
/** How much is seen of what is removed of the stock, where the stock is shown both before and after. */
const REMOVED = 0.4;
/** How much is seen of each face of a part that is seen through. */
const CLEAR = 0.25;
const SUN = unit([0.42, -0.52, 0.86]);

/**
 * @typedef {{
 *   view: (name: string) => void, layer: (name: string, isShown: boolean) => void, turn: (dx: number, dy: number) => void,
 *   zoom: (factor: number) => void, picture: () => string, ray: (x: number, y: number) => Ray
 * }} Scene
 */

/** Everything on the graphics card, made once for a context. @param {WebGL2RenderingContext} gl */
function sceneParts(gl) {
  const [thin, thick] = floorGrid();
  const wide = 2 * FARTHEST;
  const corners = [
    [-wide, -wide],
    [wide, -wide],
    [wide, wide],
    [-wide, wide],
  ].flatMap(([x, y]) => [x, y, FLOOR - 1]);
  return {
    main: programOf(gl, VERTEX, FRAGMENT),
    depth: programOf(gl, VERTEX, DEPTH_FRAGMENT),
    shadow: shadowTarget(gl, SHADOW_PIXELS),
    arm: ARM_FRAMES.map((frame) => buffersOf(gl, bodiesOf(BODIES, frame))),
    envelopes: ARM_FRAMES.map((frame) => buffersOf(gl, bodiesOf(SHAPES, frame))),
    walls: buffersOf(gl, bodiesOf(SHAPES, 'cell')),
    wallEdges: linesOf(gl, wallEdges()),
    onAxes: AXES.map((_, k) => buffersOf(gl, bodiesOf(SHAPES, `axis_${k + 1}`))),
    tracks: AXES.map((_, k) => buffersOf(gl, axisTrack(k))),
    part: buffersOf(gl, bodiesOf([...BODIES, ...SHAPES], 'workpiece')),
    stocks: STOCKS.map((body) => buffersOf(gl, body.mesh)),
    thin: linesOf(gl, thin),
    thick: linesOf(gl, thick),
    floor: buffersOf(gl, { p: corners, n: [], c: [], i: [0, 1, 2, 0, 2, 3] }),
    cell: buffersOf(gl, tubes(cellEdges(), FARTHEST * 0.0013)),
    reach: linesOf(gl, reachLines()),
    ball: buffersOf(gl, reachBall()),
    axes: buffersOf(gl, arrows(IDENTITY, FARTHEST * 0.155)),
  };
}

/** What depends on the case and on the theme. @param {WebGL2RenderingContext} gl */
function caseParts(gl) {
  const of = current();
  const other = CASES.find((one) => one.place !== of.place && one.plan === of.plan);
  const by = COLOURINGS[state.colouring];
  const magnified = state.magnified ?? MAGNIFIED;
  const { tube, curtain } = pathMeshes(of, by, magnified);
  return {
    forces: buffersOf(gl, forceArrows(of)),
    deflection: buffersOf(gl, deflectionArrows(of, magnified)),
    tube: buffersOf(gl, tube),
    curtain: buffersOf(gl, curtain),
    block: HAS_BLOCK ? buffersOf(gl, block(isDark() ? [104, 118, 134] : [186, 197, 209])) : null,
    edges: linesOf(gl, partEdges()),
    axes: buffersOf(gl, arrows(IDENTITY, FARTHEST * 0.09)),
    ghost: other ? buffersOf(gl, pathMeshes(other, by, magnified).tube) : null,
    platters: AXES.map((_, k) => buffersOf(gl, platter(of, k))),
    ghostEdges: other ? buffersOf(gl, tubes(partEdges(), FARTHEST * 0.0008)) : null,
  };
}

/** @param {HTMLElement} host @returns {Scene} */
export function sceneIn(host) {
  const canvas = /** @type {HTMLCanvasElement} */ (el('canvas', { 'aria-hidden': 'true' }));
  const gl = canvas.getContext('webgl2', { antialias: false, alpha: true, premultipliedAlpha: false });
  if (!gl) {
    host.append(el('p.none', {}, 'This browser shows no WebGL2. Maps, charts and tables work all the same.'));
    return { view() {}, layer() {}, turn() {}, zoom() {}, picture: () => '', ray: () => ({ from: [0, 0, 0], along: [0, 0, 1] }) };
  }
  host.append(canvas);
  /** @type {Record<string, boolean>} */
  const shown = Object.fromEntries(LAYERS.map(({ name, isOff }) => [name, !isOff]));
  const eye = viewOf('cell');
  let parts = sceneParts(gl);
  let ofCase = caseParts(gl);
  const hand = steer(canvas, eye, () => set({ scene: true }));

  // Software draws too slowly while things move: without soft shadows and the ball of the reach then, with few pixels
  // while something is held, and with four samples of each at rest.
  let isSlow = /swiftshader|llvmpipe|softpipe|basic render/i.test(rendererOf(gl));
  let isCoarse = isSlow;
  let [restTimer, lastFrame, slowFrames] = [0, 0, 0];

  const resize = () => {
    const box = host.getBoundingClientRect();
    const ratio = isCoarse ? (state.isHeld ? 0.6 : 1) * Math.min(devicePixelRatio, 1) : 2;
    const [width, height] = [Math.max(1, Math.round(box.width * ratio)), Math.max(1, Math.round(box.height * ratio))];
    if (canvas.width !== width || canvas.height !== height) {
      [canvas.width, canvas.height] = [width, height];
      canvas.style.width = `${box.width}px`;
      canvas.style.height = `${box.height}px`;
    }
  };
  const settle = () => {
    isCoarse = false;
    resize();
    draw();
  };
  if (isSlow) restTimer = window.setTimeout(() => settle(), 800);
  const keepUp = () => {
    const now = performance.now();
    const since = now - lastFrame;
    lastFrame = now;
    if (since > 70 && since < 1000) isSlow ||= ++slowFrames > 3;
    else if (since < 30) slowFrames = 0;
    if (isSlow) {
      isCoarse = true;
      clearTimeout(restTimer);
      if (!state.isHeld) restTimer = window.setTimeout(settle, clamp(3 * since, 500, 2000));
    }
    resize();
  };

  /** @param {Program} program @param {Buffers | null} of @param {Mat} model */
  const put = (program, of, model = IDENTITY) => {
    if (!of || !of.count) return;
    gl.uniformMatrix4fv(program.at('model'), false, model);
    gl.bindVertexArray(of.array);
    if (of.isIndexed) gl.drawElements(of.form, of.count, gl.UNSIGNED_INT, 0);
    else gl.drawArrays(of.form, 0, of.count);
  };

  const draw = () => {
    if (gl.isContextLost()) return;
    const of = current();
    const at = axesAt(of, state.t);
    const base = baseFrame(of, state.t);
    const frames = framesOf(currentJoints(), base);
    const part = workpieceFrame(of, state.t);
    const other = CASES.find((one) => one.place !== of.place && one.plan === of.plan);
    const ghost = other ? workpieceFrame(other, state.t) : IDENTITY;
    const bodies = (/** @type {Program} */ program) => {
      parts.arm.forEach((buffers, k) => put(program, buffers, frames[k]));
      if (shown.around) parts.onAxes.forEach((buffers, k) => put(program, buffers, axisFrame(k, at)));
      parts.tracks.forEach((buffers, k) => put(program, buffers, carriedBy(AXES[k].carries, at, k)));
      ofCase.platters.forEach((buffers, k) => put(program, buffers, axisFrame(k, at)));
    };
    const work = (/** @type {Program} */ program) => {
      const [before, after] = parts.stocks;
      for (const body of [parts.part, ofCase.block, shown.after ? after : shown.before ? before : null]) put(program, body, part);
    };
    const far = FARTHEST;
    const middle = [MIDDLE[0], MIDDLE[1], MIDDLE[2]];
    const sunEye = lookAt(add(middle, times(SUN, 2.2 * far)), middle, [0, 1, 0]);
    const sunView = product(parallel(far, 0.18 * far, 4.4 * far), sunEye);

    gl.bindFramebuffer(gl.FRAMEBUFFER, parts.shadow);
    gl.viewport(0, 0, SHADOW_PIXELS, SHADOW_PIXELS);
    gl.depthMask(true);
    gl.clear(gl.DEPTH_BUFFER_BIT);
    gl.enable(gl.DEPTH_TEST);
    gl.disable(gl.BLEND);
    gl.useProgram(parts.depth.program);
    gl.uniformMatrix4fv(parts.depth.at('view'), false, sunView);
    bodies(parts.depth);
    work(parts.depth);

    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
    gl.viewport(0, 0, canvas.width, canvas.height);
    gl.clearColor(0, 0, 0, 0);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    const program = parts.main;
    const aspect = canvas.width / canvas.height;
    const place = placeOf(eye);
    const view = product(
      perspective(fieldOf(aspect), aspect, 0.02 * far, 11 * far),
      lookAt(place, eye.target, [0, 0, 1]),
    );
    gl.useProgram(program.program);
    gl.uniformMatrix4fv(program.at('view'), false, view);
    gl.uniformMatrix4fv(program.at('sunView'), false, sunView);
    gl.uniform3fv(program.at('eye'), place);
    gl.uniform3fv(program.at('sun'), SUN);
    gl.uniform4f(program.at('fade'), middle[0], middle[1], 0.6 * far, 1.4 * far);
    gl.uniform1f(program.at('dark'), isDark() ? 1 : 0);
    gl.uniform1i(program.at('depths'), 0);
    gl.uniform1i(program.at('soft'), isCoarse ? 0 : 1);
    const paint = (/** @type {number} */ mode, tint = [1, 1, 1], alpha = 1) => {
      gl.uniform1i(program.at('mode'), mode);
      gl.uniform3fv(program.at('tint'), tint);
      gl.uniform1f(program.at('alpha'), alpha);
    };
    const path = () => {
      paint(MODE.lit);
      if (shown.forces) put(program, ofCase.forces, part);
      if (shown.deflection) put(program, ofCase.deflection, part);
      paint(MODE.plain);
      put(program, ofCase.tube, part);
    };
    const [soft, accent] = [themeRgb('--soft'), themeRgb('--accent')];
    paint(MODE.lit);
    bodies(program);
    if (!shown.clear) work(program);
    put(program, parts.axes, base);
    put(program, ofCase.axes, part);
    if (!shown.clear) path();
    if (shown.cell) {
      paint(MODE.plain, accent);
      put(program, parts.cell);
    }
    if (shown.ghost) {
      paint(MODE.plain, soft);
      put(program, ofCase.ghostEdges, ghost);
    }
    gl.enable(gl.BLEND);
    gl.blendFuncSeparate(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA, gl.ONE, gl.ONE_MINUS_SRC_ALPHA);
    gl.depthMask(false);
    paint(MODE.shadow, [0, 0, 0], isDark() ? 0.55 : 0.26);
    put(program, parts.floor);
    paint(MODE.grid, soft, 0.2);
    put(program, parts.thin);
    paint(MODE.grid, soft, 0.45);
    put(program, parts.thick);
    paint(MODE.plain, soft, 0.8);
    put(program, ofCase.edges, part);
    if (shown.clear) {
      // The path behind it in time, so that no face of the part covers it.
      paint(MODE.lit, [1, 1, 1], CLEAR);
      work(program);
      gl.depthMask(true);
      path();
      gl.depthMask(false);
    }
    if (shown.ghost) {
      paint(MODE.plain, [1, 1, 1], 0.5);
      put(program, ofCase.ghost, ghost);
    }
    if (shown.curtain) {
      paint(MODE.plain, [1, 1, 1], 0.62);
      put(program, ofCase.curtain, part);
    }
    if (shown.before && shown.after) {
      // Behind what is left, where both have the same face.
      gl.enable(gl.CULL_FACE);
      gl.enable(gl.POLYGON_OFFSET_FILL);
      gl.polygonOffset(4, 4);
      paint(MODE.plain, accent, REMOVED);
      put(program, parts.stocks[0], part);
      gl.disable(gl.POLYGON_OFFSET_FILL);
      gl.disable(gl.CULL_FACE);
    }
    if (shown.around) {
      // Only what faces the eye, so that a wall is one pane.
      gl.enable(gl.CULL_FACE);
      paint(MODE.lit, [1, 1, 1], PANE);
      put(program, parts.walls);
      gl.disable(gl.CULL_FACE);
      paint(MODE.plain, soft, 0.55);
      put(program, parts.wallEdges);
    }
    if (shown.envelopes) {
      paint(MODE.plain, [1, 1, 1], 0.25);
      parts.envelopes.forEach((buffers, k) => put(program, buffers, frames[k]));
    }
    if (shown.reach) {
      paint(MODE.plain, soft, 0.45);
      put(program, parts.reach, base);
      paint(MODE.rim, soft, isDark() ? 0.4 : 0.16);
      if (!isCoarse) put(program, parts.ball, base);
    }
    gl.depthMask(true);
  };

  canvas.addEventListener('webglcontextlost', (event) => event.preventDefault());
  canvas.addEventListener('webglcontextrestored', () => {
    parts = sceneParts(gl);
    ofCase = caseParts(gl);
    draw();
  });
  onScene((changed) => {
    if (gl.isContextLost()) return;
    if (changed.case || changed.theme || changed.path) {
      Object.values(ofCase).flat().forEach((buffers) => buffers && free(gl, buffers));
      ofCase = caseParts(gl);
    }
    if ((changed.case && !changed.renewed) || changed.theme || changed.size) resize();
    else keepUp();
    draw();
  });
  return {
    view: (name) => {
      Object.assign(eye, viewOf(name));
      set({ scene: true });
    },
    layer: (name, isShown) => {
      shown[name] = isShown;
      set({ scene: true });
    },
    turn: (dx, dy) => {
      hand.turn(dx, dy);
      set({ scene: true });
    },
    zoom: (factor) => {
      hand.zoom(factor);
      set({ scene: true });
    },
    picture: () => {
      settle();
      return canvas.toDataURL('image/png');
    },
    ray: (x, y) => rayAt(eye, canvas, x, y),
  };
}

/** @param {WebGL2RenderingContext} gl @returns {string} */
function rendererOf(gl) {
  const info = gl.getExtension('WEBGL_debug_renderer_info');
  return info ? String(gl.getParameter(info.UNMASKED_RENDERER_WEBGL)) : '';
}
