// The script of the page as one file, in the order in which `html.rs` names its modules, for the type checker.
import { mkdirSync, readFileSync, writeFileSync } from 'node:fs';

const page = new URL('../../crates/report/src/page/', import.meta.url);
const names = [...readFileSync(new URL('html.rs', page), 'utf8').matchAll(/include_str!\("(script\/[^"]+)"\)/g)].map(
  (found) => found[1],
);
const modules = names.map((name) => readFileSync(new URL(name, page), 'utf8'));
mkdirSync(new URL('build/', import.meta.url), { recursive: true });
writeFileSync(new URL('build/page.js', import.meta.url), `(() => {\n${modules.join('')}})();\n`);
