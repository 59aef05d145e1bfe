// A small table of words and numbers, which needs no sorting.

import { el } from '../draw/dom.js';

/** @param {string[]} heads @param {(string | number | Node)[][]} rows */
export function smallTable(heads, rows) {
  const isNumber = (/** @type {string | number | Node} */ value) => typeof value === 'number' || /^[-–]?\d|^–$/.test(String(value));
  const isWords = heads.map((_, k) => k === 0 || !rows.every((row) => isNumber(row[k])));
  const cell = (/** @type {string | number | Node} */ value, /** @type {number} */ k) =>
    el(isWords[k] ? 'td.words' : 'td', {}, value);
  const head = el(
    'thead',
    {},
    el('tr', {}, ...heads.map((name, k) => el(isWords[k] ? 'th.words' : 'th', { scope: 'col' }, name))),
  );
  return el('table', {}, head, el('tbody', {}, ...rows.map((row) => el('tr', {}, ...row.map(cell)))));
}
