// WebGL2 in the few words that the scene needs.

/** @import { Vec } from './linear.js' */
/** @import { Mesh } from './mesh.js' */

/** @typedef {{ program: WebGLProgram, at: (name: string) => WebGLUniformLocation | null }} Program */
/** @typedef {{ array: WebGLVertexArrayObject, count: number, form: number, isIndexed: boolean, buffers: WebGLBuffer[] }} Buffers */

/** @param {WebGL2RenderingContext} gl @param {string} vertex @param {string} fragment @returns {Program} */
export function programOf(gl, vertex, fragment) {
  const program = gl.createProgram();
  for (const [type, source] of /** @type {[number, string][]} */ ([
    [gl.VERTEX_SHADER, vertex],
    [gl.FRAGMENT_SHADER, fragment],
  ])) {
    const shader = /** @type {WebGLShader} */ (gl.createShader(type));
    gl.shaderSource(shader, source);
    gl.compileShader(shader);
    gl.attachShader(program, shader);
  }
  ['p', 'n', 'c'].forEach((name, k) => gl.bindAttribLocation(program, k, name));
  gl.linkProgram(program);
  if (!gl.getProgramParameter(program, gl.LINK_STATUS) && !gl.isContextLost()) {
    throw new Error(gl.getProgramInfoLog(program) || 'the shaders cannot be linked');
  }
  /** @type {Map<string, WebGLUniformLocation | null>} */
  const places = new Map();
  const at = (/** @type {string} */ name) => {
    if (!places.has(name)) places.set(name, gl.getUniformLocation(program, name));
    return places.get(name) || null;
  };
  return { program, at };
}

/** @param {WebGL2RenderingContext} gl @param {Mesh} mesh @param {number} form @returns {Buffers} */
export function buffersOf(gl, mesh, form = gl.TRIANGLES) {
  const array = gl.createVertexArray();
  gl.bindVertexArray(array);
  const colours = mesh.c.length
    ? Float32Array.from(mesh.c, (part) => part / 255)
    : new Float32Array(mesh.p.length).fill(1);
  const normals = mesh.n.length ? mesh.n : new Float32Array(mesh.p.length);
  const buffers = [mesh.p, normals, colours].map((data, k) => {
    const buffer = gl.createBuffer();
    gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
    gl.bufferData(gl.ARRAY_BUFFER, data instanceof Float32Array ? data : new Float32Array(data), gl.STATIC_DRAW);
    gl.enableVertexAttribArray(k);
    gl.vertexAttribPointer(k, 3, gl.FLOAT, false, 0, 0);
    return buffer;
  });
  if (mesh.i.length) {
    const buffer = gl.createBuffer();
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, buffer);
    gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, new Uint32Array(mesh.i), gl.STATIC_DRAW);
    buffers.push(buffer);
  }
  gl.bindVertexArray(null);
  return { array, count: mesh.i.length || mesh.p.length / 3, form, isIndexed: mesh.i.length > 0, buffers };
}

/** @param {WebGL2RenderingContext} gl @param {Vec[]} pairs @returns {Buffers} */
export const linesOf = (gl, pairs) => buffersOf(gl, { p: pairs.flat(), n: [], c: [], i: [] }, gl.LINES);

/** @param {WebGL2RenderingContext} gl @param {Buffers} of */
export function free(gl, of) {
  of.buffers.forEach((buffer) => gl.deleteBuffer(buffer));
  gl.deleteVertexArray(of.array);
}

/** The depth of the scene as the sun sees it. @param {WebGL2RenderingContext} gl @param {number} pixels */
export function shadowTarget(gl, pixels) {
  const texture = gl.createTexture();
  gl.bindTexture(gl.TEXTURE_2D, texture);
  gl.texStorage2D(gl.TEXTURE_2D, 1, gl.DEPTH_COMPONENT24, pixels, pixels);
  for (const [key, value] of [
    [gl.TEXTURE_COMPARE_MODE, gl.COMPARE_REF_TO_TEXTURE],
    [gl.TEXTURE_MIN_FILTER, gl.LINEAR],
    [gl.TEXTURE_MAG_FILTER, gl.LINEAR],
    [gl.TEXTURE_WRAP_S, gl.CLAMP_TO_EDGE],
    [gl.TEXTURE_WRAP_T, gl.CLAMP_TO_EDGE],
  ])
    gl.texParameteri(gl.TEXTURE_2D, key, value);
  const target = gl.createFramebuffer();
  gl.bindFramebuffer(gl.FRAMEBUFFER, target);
  gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.DEPTH_ATTACHMENT, gl.TEXTURE_2D, texture, 0);
  gl.bindFramebuffer(gl.FRAMEBUFFER, null);
  return target;
}
