// The scene of a results folder by the validator of Khronos.
import validator from 'gltf-validator';
import { readFileSync } from 'node:fs';
import { join } from 'node:path';

/** How many errors and warnings `cell.glb` has, and what is to be said of it. */
export async function validated(folder) {
  const bytes = new Uint8Array(readFileSync(join(folder, 'cell.glb')));
  const report = await validator.validateBytes(bytes, { maxIssues: 20 });
  const { numErrors, numWarnings, messages } = report.issues;
  const said = messages.map(({ code, message, pointer }) => `${code} at ${pointer}: ${message}\n`).join('');
  const { animationCount, drawCallCount, totalTriangleCount } = report.info;
  const wrong = numErrors + numWarnings + (animationCount === 1 ? 0 : 1);
  const counts = `${animationCount} animation, ${drawCallCount} meshes, ${totalTriangleCount} triangles`;
  return { wrong, text: `${said}cell.glb: ${numErrors} errors, ${numWarnings} warnings; ${counts}` };
}
