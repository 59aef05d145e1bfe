// The scene of a results folder by the validator of Khronos: no error, no warning.
//
//   node scene.mjs [FOLDER]
import { fileURLToPath } from 'node:url';
import { validated } from './validated.mjs';

const folder = process.argv[2] ?? fileURLToPath(new URL('../../results/caro-2013/', import.meta.url));
const { wrong, text } = await validated(folder);
console.log(text);
process.exit(wrong ? 1 : 0);
