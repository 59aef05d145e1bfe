// The cell in three dimensions.

/** What can be left out of the view, with its words. @type {[string, string][]} */
const LAYERS = [
  ['curtain', `${SCORED} error ×${MAGNIFIED}`],
  ['cell', 'cell volume'],
  ['reach', 'reach'],
  ['ghost', 'other placement'],
  ['envelopes', 'collision shapes of the arm'],
];

const SHADOW_PIXELS = 2048;
const SUN = unit([0.42, -0.52, 0.86]);

/**
 * @typedef {{
 *   view: (name: string) => void, layer: (name: string, isShown: boolean) => void, turn: (dx: number, dy: number) => void,
 *   zoom: (factor: number) => void, picture: () => string
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
    around: buffersOf(gl, bodiesOf(SHAPES, 'cell')),
    part: buffersOf(gl, bodiesOf([...BODIES, ...SHAPES], 'workpiece')),
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
  const { tube, curtain } = pathMeshes(of);
  return {
    tube: buffersOf(gl, tube),
    curtain: buffersOf(gl, curtain),
    block: HAS_BLOCK ? buffersOf(gl, block(isDark() ? [104, 118, 134] : [186, 197, 209])) : null,
    edges: linesOf(gl, partEdges()),
    axes: buffersOf(gl, arrows(IDENTITY, FARTHEST * 0.09)),
    ghost: other ? buffersOf(gl, pathMeshes(other).tube) : null,
    ghostEdges: other ? buffersOf(gl, tubes(partEdges(), FARTHEST * 0.0008)) : null,
  };
}

/** @param {HTMLElement} host @returns {Scene} */
function sceneIn(host) {
  const canvas = /** @type {HTMLCanvasElement} */ (el('canvas', { 'aria-hidden': 'true' }));
  const gl = canvas.getContext('webgl2', { antialias: false, alpha: true, premultipliedAlpha: false });
  if (!gl) {
    host.append(el('p.none', {}, 'This browser shows no WebGL2. Maps, charts and tables work all the same.'));
    return { view() {}, layer() {}, turn() {}, zoom() {}, picture: () => '' };
  }
  host.append(canvas);
  /** @type {Record<string, boolean>} */
  const shown = Object.fromEntries(LAYERS.map(([name]) => [name, name !== 'envelopes']));
  const eye = viewOf('cell');
  let parts = sceneParts(gl);
  let ofCase = caseParts(gl);
  const hand = steer(canvas, eye, () => set({ scene: true }));

  // Software draws four samples of a pixel too slowly while things move: one then, four at rest.
  let isSlow = /swiftshader|llvmpipe|softpipe|basic render/i.test(rendererOf(gl));
  let isCoarse = isSlow;
  let [restTimer, lastFrame, slowFrames] = [0, 0, 0];

  const resize = () => {
    const box = host.getBoundingClientRect();
    const ratio = isCoarse ? Math.min(devicePixelRatio, 1) : 2;
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
      restTimer = window.setTimeout(settle, clamp(3 * since, 500, 2000));
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
    const base = baseFrame(of, state.t);
    const frames = framesOf(currentJoints(), base);
    const part = workpieceFrame(of, state.t);
    const other = CASES.find((one) => one.place !== of.place && one.plan === of.plan);
    const ghost = other ? workpieceFrame(other, state.t) : IDENTITY;
    const bodies = (/** @type {Program} */ program) => {
      parts.arm.forEach((buffers, k) => put(program, buffers, frames[k]));
      put(program, parts.part, part);
      put(program, parts.around);
      put(program, ofCase.block, part);
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

    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
    gl.viewport(0, 0, canvas.width, canvas.height);
    gl.clearColor(0, 0, 0, 0);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    const program = parts.main;
    const aspect = canvas.width / canvas.height;
    const place = placeOf(eye);
    const view = product(
      perspective(aspect < 1 ? 0.9 : 0.63, aspect, 0.02 * far, 11 * far),
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
    const paint = (/** @type {number} */ mode, tint = [1, 1, 1], alpha = 1) => {
      gl.uniform1i(program.at('mode'), mode);
      gl.uniform3fv(program.at('tint'), tint);
      gl.uniform1f(program.at('alpha'), alpha);
    };
    const [soft, accent] = [themeRgb('--soft'), themeRgb('--accent')];
    paint(MODE.lit);
    bodies(program);
    put(program, parts.axes, base);
    put(program, ofCase.axes, part);
    paint(MODE.plain);
    put(program, ofCase.tube, part);
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
    if (shown.ghost) {
      paint(MODE.plain, [1, 1, 1], 0.5);
      put(program, ofCase.ghost, ghost);
    }
    if (shown.curtain) {
      paint(MODE.plain, [1, 1, 1], 0.62);
      put(program, ofCase.curtain, part);
    }
    if (shown.envelopes) {
      paint(MODE.plain, [1, 1, 1], 0.25);
      parts.envelopes.forEach((buffers, k) => put(program, buffers, frames[k]));
    }
    if (shown.reach) {
      paint(MODE.plain, soft, 0.45);
      put(program, parts.reach, base);
      paint(MODE.rim, soft, isDark() ? 0.4 : 0.16);
      put(program, parts.ball, base);
    }
    gl.depthMask(true);
  };

  canvas.addEventListener('webglcontextlost', (event) => event.preventDefault());
  canvas.addEventListener('webglcontextrestored', () => {
    parts = sceneParts(gl);
    ofCase = caseParts(gl);
    draw();
  });
  onChange((changed) => {
    if (gl.isContextLost()) return;
    if (changed.case || changed.theme) {
      Object.values(ofCase).forEach((buffers) => buffers && free(gl, buffers));
      ofCase = caseParts(gl);
    }
    if (changed.case || changed.theme || changed.size) resize();
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
  };
}

/** @param {WebGL2RenderingContext} gl @returns {string} */
function rendererOf(gl) {
  const info = gl.getExtension('WEBGL_debug_renderer_info');
  return info ? String(gl.getParameter(info.UNMASKED_RENDERER_WEBGL)) : '';
}

/** The view as it is now, as the address of a picture; the card of the scene puts it in. */
let viewPicture = () => '';

/** The card with the view, its switches and its words. */
function sceneCard() {
  const view = el('div.view');
  const [title, where] = [el('h2'), el('div.sub')];
  const host = el(
    'section.card.scene',
    { 'aria-label': 'The cell in three dimensions', id: 'scene' },
    view,
    el('div.tl', {}, title, where),
  );
  const scene = sceneIn(view);
  viewPicture = scene.picture;
  const views = [
    ['cell', '3-D'],
    ['top', 'Top'],
    ['front', 'Front'],
    ['tool', 'Tool'],
  ].map(([name, text]) =>
    el('button.chip', { type: 'button', 'data-view': name, onclick: () => scene.view(name) }, text),
  );
  const layers = LAYERS.filter(([name]) => (name !== 'ghost' || CASES.length > 2) && (name !== 'envelopes' || HAS_ENVELOPES)).map(([name, text]) => {
    const box = /** @type {HTMLInputElement} */ (
      el('input', {
        type: 'checkbox',
        checked: name !== 'envelopes',
        'data-layer': name,
        onchange: () => scene.layer(name, box.checked),
      })
    );
    return el('label.chip', {}, box, text);
  });
  const words = [
    HAS_ILLUSTRATIONS ? 'Shapes of arm and spindle are illustrations made from the robot’s rows' : '',
    HAS_BLOCK ? 'the block is the extent of the path' : '',
  ];
  host.append(
    el('div.tr', {}, ...views),
    el('div.bl', {}, el('div.tags', {}, ...layers), el('div.sub', {}, words.filter(Boolean).join('; '))),
  );
  view.tabIndex = 0;
  view.setAttribute('role', 'img');
  view.setAttribute('aria-label', 'Robot, spindle, path and cell; arrow keys turn the view, plus and minus zoom');
  view.addEventListener('keydown', (event) => {
    const turn = { ArrowLeft: [-25, 0], ArrowRight: [25, 0], ArrowUp: [0, 25], ArrowDown: [0, -25] }[event.key];
    if (turn) scene.turn(turn[0], turn[1]);
    else if (event.key === '+' || event.key === '=') scene.zoom(0.85);
    else if (event.key === '-') scene.zoom(1 / 0.85);
    else return;
    event.preventDefault();
    event.stopPropagation();
  });
  onChange(({ case: isOther }) => {
    if (!isOther) return;
    const { x, y, z, yaw } = current().at;
    title.textContent = current().name;
    where.textContent = `x ${fixed(x, 1)}  y ${fixed(y, 1)}  z ${fixed(z, 1)} mm, yaw ${fixed(yaw, 1)}°`;
  });
  // WebGL is not printed: a picture takes its place.
  const still = /** @type {HTMLImageElement} */ (el('img.still', { alt: '' }));
  view.append(still);
  addEventListener('beforeprint', () => {
    still.src = viewPicture();
  });
  return host;
}
