// Tables that sort by a click on a heading and show the rows with a word in them.

import { el } from '../draw/dom.js';
import { giving } from '../draw/downloads.js';
/** @import { TableCard } from './sheet.js' */

/** Rows that are shown at once; the others come when asked for. */
const ROWS = 500;

/**
 * @param {TableCard} card
 * @returns {HTMLElement}
 */
export function tableCard(card) {
  const text = (/** @type {null | string | [string, string]} */ cell) => cell === null ? '' : typeof cell === 'string' ? cell : cell[0];
  const [body, counted] = [el('tbody'), el('span', { class: 'sub', role: 'status' })];
  let [rows, sorted, isFalling, limit, words] = [[...card.rows], -1, false, ROWS, ''];
  const show = () => {
    const wanted = words.toLowerCase().split(/\s+/).filter(Boolean);
    const found = rows.filter(row => wanted.every(word => row.some(cell => text(cell).toLowerCase().includes(word))));
    counted.textContent = wanted.length > 0 || found.length > limit ? `${Math.min(found.length, limit)} of ${card.rows.length} rows` : '';
    body.replaceChildren(...found.slice(0, limit).map(row => el('tr', {}, ...row.map((cell, k) => {
      const kind = card.columns[k].is_number ? 'number' : 'words';
      return el('td', { class: kind }, typeof cell === 'object' && cell ? el('a', { href: cell[1] }, cell[0]) : text(cell));
    }))));
    more.hidden = found.length <= limit;
  };
  const more = el('button', { type: 'button', class: 'chip' }, 'Show all rows');
  more.addEventListener('click', () => { limit = Infinity; show(); });
  const headings = card.columns.map((column, k) => {
    const button = el('button', { type: 'button' }, column.name);
    const heading = el('th', { scope: 'col', class: column.is_number ? 'number' : 'words' }, button);
    button.addEventListener('click', () => {
      isFalling = sorted === k && !isFalling;
      sorted = k;
      const order = (/** @type {string} */ a, /** @type {string} */ b) => column.is_number ? Number(a) - Number(b) : a.localeCompare(b, 'en');
      // What is empty stays at the end.
      rows = [...card.rows].sort((a, b) => {
        const [left, right] = [text(a[k]), text(b[k])];
        return !left || !right ? Number(!left) - Number(!right) : order(left, right) * (isFalling ? -1 : 1);
      });
      headings.forEach((other, n) => other.setAttribute('aria-sort', n === k ? isFalling ? 'descending' : 'ascending' : 'none'));
      show();
    });
    return heading;
  });
  const head = el('div', { class: 'head' }, el('h2', {}, card.title), el('span', { class: 'sub' }, card.detail), counted);
  if (card.can_filter) {
    const field = /** @type {HTMLInputElement} */ (
      el('input', { type: 'search', placeholder: 'filter rows', 'aria-label': `Filter rows: ${card.title}` }));
    field.addEventListener('input', () => { words = field.value; show(); });
    head.append(field);
  }
  const table = el('table', {}, el('caption', { class: 'sr' }, card.title), el('thead', {}, el('tr', {}, ...headings)), body);
  show();
  const section = el('section', { class: 'card wide', 'aria-label': card.title }, head, el('div', { class: 'scroll', tabindex: '0' }, table), more);
  return giving(section, { rows: () => [card.columns.map(({ name }) => name), ...rows.map(row => row.map(text))] });
}
