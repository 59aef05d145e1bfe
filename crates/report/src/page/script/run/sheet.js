// The setup sheet: folded on the screen, the first page of what is printed.

import { el, folded } from '../draw/dom.js';
import { giving } from '../draw/downloads.js';
import { fixed } from '../draw/scale.js';
import { RAW } from './data.js';

/** What the sheet is about, in a line. @param {any} sheet */
function summaryOf(sheet) {
  /** @type {Record<string, string>} */
  const frames = { root: 'the controller’s root frame', base: 'the robot’s base frame', cell: 'the cell frame' };
  const [x, y, z] = sheet.part.xyz_mm.map((/** @type {number} */ mm) => fixed(mm, 1));
  const [a, b, c] = sheet.part.abc_deg.map((/** @type {number} */ deg) => fixed(deg, 2));
  return `part at x ${x}, y ${y}, z ${z} mm, turned by A ${a}, B ${b}, C ${c}° in ${frames[sheet.frame]}`;
}

/** The card of the sheet, where the run left one. */
export function sheetCard() {
  const { setup_sheet: sheet } = RAW.document;
  if (!RAW.setup_sheet_svg || !sheet) return null;
  const drawn = new DOMParser().parseFromString(RAW.setup_sheet_svg, 'image/svg+xml').documentElement;
  const picture = document.importNode(drawn, true);
  picture.setAttribute('role', 'img');
  picture.setAttribute('aria-label', `Setup sheet: ${summaryOf(sheet)}`);
  const fold = folded(
    el('summary', {}, el('b', {}, 'Setup sheet'), ` ${summaryOf(sheet)}`),
    el('div.head', {}, el('span.sub', {}, 'A4, to be printed at full size')),
    el('div.sheet', { tabindex: 0, role: 'group', 'aria-label': 'The sheet at full size' }, picture),
  );
  const out = el('section.card.setup', { 'aria-label': 'Setup sheet', id: 'setup' }, fold);
  return giving(out, { svg: () => RAW.setup_sheet_svg });
}
