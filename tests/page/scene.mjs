// The scene of a results folder by the validator of Khronos: no error, no warning.
//
//   node scene.mjs [FOLDER]
import validator from 'gltf-validator';
import { readFileSync } from 'node:fs';
import { join } from 'node:path';
import { fileURLToPath } from 'node:url';

const folder = process.argv[2] ?? fileURLToPath(new URL('../../results/caro-2013/', import.meta.url));
const report = await validator.validateBytes(new Uint8Array(readFileSync(join(folder, 'cell.glb'))), { maxIssues: 20 });
const { numErrors, numWarnings, messages } = report.issues;
for (const { code, message, pointer } of messages) console.log(`${code} at ${pointer}: ${message}`);
const { animationCount, drawCallCount, totalTriangleCount } = report.info;
console.log(`cell.glb: ${numErrors} errors, ${numWarnings} warnings; ${animationCount} animation, ${drawCallCount} meshes, ${totalTriangleCount} triangles`);
process.exit(numErrors + numWarnings + (animationCount === 1 ? 0 : 1) > 0 ? 1 : 0);
