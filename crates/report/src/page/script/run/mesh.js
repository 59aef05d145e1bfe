// Triangles with normals and colours, and the few shapes that the page makes itself.

import { RADIANS, add, cross, dot, less, size, times, unit } from './linear.js';
/** @import { Mat, Vec } from './linear.js' */

/** @typedef {{ p: number[] | Float32Array, n: number[] | Float32Array, c: number[] | Float32Array, i: number[] }} Mesh without indices each three corners are a triangle */

/** @returns {{ p: number[], n: number[], c: number[], i: number[] }} */
export const mesh = () => ({ p: [], n: [], c: [], i: [] });

/** Two directions across a third. @param {Vec} along @returns {[Vec, Vec]} */
export function across(along) {
  const u = unit(cross(along, Math.abs(along[2]) < 0.9 ? [0, 0, 1] : [1, 0, 0]));
  return [u, cross(along, u)];
}

/**
 * A round body about an axis: its profile is pairs of way along the axis and radius.
 * @param {{ p: number[], n: number[], c: number[], i: number[] }} into
 * @param {Vec} from @param {Vec} to @param {[number, number][]} profile @param {number} corners @param {number[]} colour to 255
 */
export function lathe(into, from, to, profile, corners, colour) {
  const along = unit(less(to, from));
  const [u, v] = across(along);
  for (let k = 0; k + 1 < profile.length; k++) {
    const base = into.p.length / 3;
    const [dz, dr] = [profile[k + 1][0] - profile[k][0], profile[k + 1][1] - profile[k][1]];
    for (const [z, radius] of [profile[k], profile[k + 1]]) {
      for (let a = 0; a <= corners; a++) {
        const angle = (2 * Math.PI * a) / corners;
        const out = add(times(u, Math.cos(angle)), times(v, Math.sin(angle)));
        into.p.push(...add(from, add(times(along, z), times(out, radius))));
        into.n.push(...unit(add(times(out, dz), times(along, -dr))));
        into.c.push(...colour);
      }
    }
    for (let a = 0; a < corners; a++) {
      const [p, q] = [base + a, base + a + corners + 1];
      into.i.push(p, p + 1, q + 1, p, q + 1, q);
    }
  }
}

/** Lines of a width in mm. @param {Vec[]} pairs ends of the lines @param {number} radius @param {number[]} [colour] */
export function tubes(pairs, radius, colour = [255, 255, 255]) {
  const out = mesh();
  for (let k = 0; k < pairs.length; k += 2) {
    const length = size(less(pairs[k + 1], pairs[k]));
    if (length > 0)
      lathe(
        out,
        pairs[k],
        pairs[k + 1],
        [
          [0, radius],
          [length, radius],
        ],
        6,
        colour,
      );
  }
  return out;
}

/** The axes of a frame as arrows: x red, y green, z blue. @param {Mat} frame @param {number} length */
export function arrows(frame, length) {
  const out = mesh();
  const from = [frame[12], frame[13], frame[14]];
  [
    [222, 60, 60],
    [46, 160, 80],
    [50, 110, 230],
  ].forEach((colour, k) => {
    const to = add(from, times([frame[4 * k], frame[4 * k + 1], frame[4 * k + 2]], length));
    const [thin, thick, neck] = [length * 0.016, length * 0.045, length * 0.84];
    lathe(
      out,
      from,
      to,
      [
        [0, thin],
        [neck, thin],
        [neck, thick],
        [length, 0],
      ],
      10,
      colour,
    );
  });
  return out;
}

/** Corners of flat triangles get the mean normal of the triangles about them that are less than this apart. */
const CREASE = Math.cos(38 * RADIANS);

/** @param {Float32Array} corners @param {ArrayLike<number>} triangles @param {number[]} colour to 255 @returns {Mesh} */
export function smoothed(corners, triangles, colour) {
  const count = triangles.length / 3;
  const normals = new Float32Array(count * 3);
  /** @type {Map<string, number[]>} triangles about a place, which may be several corners */
  const about = new Map();
  const place = (/** @type {number} */ k) => `${corners[3 * k]},${corners[3 * k + 1]},${corners[3 * k + 2]}`;
  const corner = (/** @type {number} */ k) => [corners[3 * k], corners[3 * k + 1], corners[3 * k + 2]];
  for (let t = 0; t < count; t++) {
    const [a, b, c] = [0, 1, 2].map((k) => corner(triangles[3 * t + k]));
    // As long as the triangle is large, so that large ones count more.
    normals.set(cross(less(b, a), less(c, a)), 3 * t);
    for (let k = 0; k < 3; k++) {
      const key = place(triangles[3 * t + k]);
      const list = about.get(key);
      if (list) list.push(t);
      else about.set(key, [t]);
    }
  }
  const normal = (/** @type {number} */ t) => [normals[3 * t], normals[3 * t + 1], normals[3 * t + 2]];
  const out = { p: new Float32Array(count * 9), n: new Float32Array(count * 9), c: new Float32Array(count * 9), i: [] };
  for (let t = 0; t < count; t++) {
    const own = unit(normal(t));
    for (let k = 0; k < 3; k++) {
      const at = triangles[3 * t + k];
      let sum = [0, 0, 0];
      for (const other of about.get(place(at)) || []) {
        if (dot(unit(normal(other)), own) > CREASE) sum = add(sum, normal(other));
      }
      out.p.set(corner(at), 9 * t + 3 * k);
      out.n.set(unit(sum), 9 * t + 3 * k);
      out.c.set(colour, 9 * t + 3 * k);
    }
  }
  return out;
}

/** Edges where a surface bends sharply or ends. @param {Mesh} of three corners a triangle @returns {Vec[]} ends of the edges */
export function creasesOf({ p }) {
  /** @type {Map<string, { ends: Vec[], facing: Vec, isSharp: boolean }>} */
  const edges = new Map();
  for (let t = 0; t < p.length; t += 9) {
    const corners = [0, 3, 6].map((k) => [p[t + k], p[t + k + 1], p[t + k + 2]]);
    const facing = unit(cross(less(corners[1], corners[0]), less(corners[2], corners[0])));
    for (let k = 0; k < 3; k++) {
      const ends = [corners[k], corners[(k + 1) % 3]];
      const key = ends.map(String).sort().join();
      const known = edges.get(key);
      if (known) known.isSharp = dot(known.facing, facing) < CREASE;
      else edges.set(key, { ends, facing, isSharp: true });
    }
  }
  return [...edges.values()].filter((edge) => edge.isSharp).flatMap((edge) => edge.ends);
}
