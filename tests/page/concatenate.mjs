// The scripts of both kinds of pages, each as one file, in the order in which `html.rs` names its modules, for the type checker.
import { mkdirSync, readFileSync, writeFileSync } from 'node:fs';

mkdirSync(new URL('build/', import.meta.url), { recursive: true });
for (const [name, folder] of [['page', ''], ['cards', 'cards/']]) {
  const place = new URL(`../../crates/report/src/page/${folder}`, import.meta.url);
  const names = [...readFileSync(new URL('html.rs', place), 'utf8').matchAll(/include_str!\("(script\/[^"]+)"\)/g)].map((found) => found[1]);
  const modules = names.map((file) => readFileSync(new URL(file, place), 'utf8'));
  writeFileSync(new URL(`build/${name}.js`, import.meta.url), `(() => {\n${modules.join('')}})();\n`);
}
