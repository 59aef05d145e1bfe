// What can be taken along of every card: a picture of it as it looks now, and its figures as a CSV table.

import { contextOf, el } from './dom.js';
import { PLOTS } from './plot.js';

/**
 * @typedef {(string | number | null | undefined)[]} Row
 * @typedef {{ rows?: () => Row[], picture?: () => string, svg?: () => string }} Own what a card says of itself, in place of what is read from
 *   it; a picture by its address
 */

/** @type {WeakMap<Element, Own>} */
const owns = new WeakMap();

/** Says what a card gives. @template {HTMLElement} T @param {T} section @param {Own} own @returns {T} */
export function giving(section, own) {
  owns.set(section, { ...owns.get(section), ...own });
  return section;
}

/** @param {Row[]} rows */
const csvOf = (rows) =>
  rows
    .map((row) =>
      row.map((value) => {
        // Numbers in single precision have no more digits than these.
        const text = typeof value === 'number' ? (Number.isFinite(value) ? String(+value.toPrecision(7)) : '') : String(value ?? '');
        return /[",\n]/.test(text) ? `"${text.replace(/"/g, '""')}"` : text;
      }).join(','),
    )
    .map((line) => `${line}\n`)
    .join('');

/** The figures of a card. @param {Element} section @returns {(() => Row[]) | undefined} */
function rowsOf(section) {
  const own = owns.get(section)?.rows;
  if (own) return own;
  const plots = Array.from(section.querySelectorAll('.plot')).flatMap((host) => PLOTS.get(host) ?? []);
  if (plots[0]?.drawing.rows) return () => plots[0].drawing.rows?.() ?? [];
  const tables = section.querySelectorAll('table');
  if (!tables.length && !section.querySelector('.worst-points')) return undefined;
  return () =>
    Array.from(section.querySelectorAll('tr'), (row) => Array.from(row.querySelectorAll('th, td'), (cell) => cell.textContent ?? ''));
}

/** A card as it looks, drawn anew: boxes, canvases and words where the browser has put them. @param {Element} section */
function pictureOf(section) {
  const ratio = 2;
  const box = section.getBoundingClientRect();
  const canvas = /** @type {HTMLCanvasElement} */ (el('canvas', { width: Math.round(box.width * ratio), height: Math.round(box.height * ratio) }));
  const g = contextOf(canvas);
  g.scale(ratio, ratio);
  g.translate(-box.left, -box.top);
  g.fillStyle = getComputedStyle(section).backgroundColor;
  g.fillRect(box.left, box.top, box.width, box.height);
  g.textBaseline = 'middle';
  /** @param {Element} element */
  const paint = (element) => {
    const style = getComputedStyle(element);
    const at = element.getBoundingClientRect();
    if (style.display === 'none' || !at.width || element.matches('.downloads, .zoom, .tip, .sr, input')) return;
    g.globalAlpha = +style.opacity;
    if (element instanceof HTMLCanvasElement) g.drawImage(element, at.left, at.top, at.width, at.height);
    const stripes = style.backgroundImage.match(/rgba?\([^)]*\)/);
    if (stripes) {
      g.fillStyle = stripes[0];
      for (let x = 0; x < at.width; x += 8) g.fillRect(at.left + x, at.top, Math.min(5, at.width - x), at.height);
    } else if (element !== section) {
      g.fillStyle = style.backgroundColor;
      g.fillRect(at.left, at.top, at.width, at.height);
    }
    g.fillStyle = style.color;
    g.font = `${style.fontWeight} ${style.fontSize} ${style.fontFamily}`;
    for (const child of element.childNodes) {
      if (child instanceof Element) {
        paint(child);
        g.globalAlpha = +style.opacity;
        g.fillStyle = style.color;
        g.font = `${style.fontWeight} ${style.fontSize} ${style.fontFamily}`;
      } else if (child instanceof Text) {
        for (const word of child.data.matchAll(/\S+/g)) {
          const range = document.createRange();
          range.setStart(child, word.index);
          range.setEnd(child, word.index + word[0].length);
          const place = range.getBoundingClientRect();
          g.fillText(word[0], place.left, (place.top + place.bottom) / 2);
        }
      }
    }
  };
  paint(section);
  return canvas.toDataURL();
}

/** Saves a file. @param {string} name @param {string | Uint8Array} content @param {string} type */
function save(name, content, type) {
  const address = URL.createObjectURL(new Blob([/** @type {BlobPart} */ (content)], { type }));
  const link = /** @type {HTMLAnchorElement} */ (el('a', { href: address, download: name }));
  link.click();
  setTimeout(() => URL.revokeObjectURL(address), 60000);
}

/** Puts the buttons on every card that has a heading for them. @param {Element} root */
export function withDownloads(root) {
  for (const section of root.querySelectorAll('section.card')) {
    const host = section.querySelector('.head, .tr');
    const own = owns.get(section);
    if (!host || !(own || section.querySelector('.plot, table, .worst-points'))) continue;
    const title = section.getAttribute('aria-label') ?? '';
    const name = `${document.title} ${title}`.toLowerCase().replace(/[^a-z0-9]+/g, '-').replace(/^-+|-+$/g, '');
    const rows = rowsOf(section);
    const csv = () => save(`${name}.csv`, csvOf(rows?.() ?? []), 'text/csv');
    const picture = () => {
      if (own?.svg) return save(`${name}.svg`, own.svg(), 'image/svg+xml');
      const address = own?.picture ? own.picture() : pictureOf(section);
      save(`${name}.png`, Uint8Array.from(atob(address.split(',')[1] ?? ''), (letter) => letter.charCodeAt(0)), 'image/png');
    };
    const button = (/** @type {string} */ words, /** @type {string} */ what, /** @type {() => void} */ onclick) =>
      el('button.chip', { type: 'button', 'aria-label': `${words}: ${title}`, title: what, onclick }, words);
    const buttons = [rows ? button('CSV', 'Figures as a table', csv) : null, button(own?.svg ? 'SVG' : 'PNG', 'Picture', picture)];
    host.append(el('span.downloads', {}, ...buttons));
  }
}
