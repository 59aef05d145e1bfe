// The page: its head, its cards in their order, where it comes from.

import { chartCard } from '../draw/chart.js';
import { el } from '../draw/dom.js';
import { withDownloads } from '../draw/downloads.js';
import { heatMapCard } from '../draw/heat-map.js';
import { themeButton, turnTheme } from '../draw/theme.js';
import { polarCard } from './polar.js';
import { sheet } from './sheet.js';
import { tableCard } from './table.js';
/** @import { AnyCard } from './sheet.js' */

/**
 * @param {AnyCard} card
 * @returns {HTMLElement}
 */
function cardOf(card) {
  switch (card.kind) {
    case 'text': {
      const list = el('ul', {}, ...card.sentences.map(sentence => el('li', {}, sentence)));
      const head = el('div', { class: 'head' }, el('h2', {}, card.title));
      return el('section', { class: card.is_warning ? 'card wide text warning' : 'card wide text' }, head, list);
    }
    case 'tiles':
      return el('div', { class: 'tiles wide' }, ...card.tiles.map(tile => el('div', { class: 'tile' },
        el('div', { class: 'k' }, tile.label),
        el('div', { class: 'v' }, tile.value, el('span', { class: 'u' }, tile.unit)),
        el('div', { class: 'd', title: tile.detail }, tile.detail))));
    case 'table': return tableCard(card);
    case 'chart': return chartCard(card);
    case 'heat-map': return heatMapCard(card);
    case 'polar': return polarCard(card);
  }
}

addEventListener('keydown', event => {
  const isField = event.target instanceof HTMLInputElement;
  if (!isField && !event.ctrlKey && !event.metaKey && !event.altKey && event.key.toLowerCase() === 'd') turnTheme();
});
const head = el('div', {}, el('h1', {}, sheet.title, el('small', {}, sheet.subtitle)), el('p', {}, sheet.lead));
const keySign = (/** @type {string} */ name) => el('kbd', {}, name);
const help = el('span.keys', {}, 'In a chart: ', keySign('←'), ' ', keySign('→'), ' values, ', keySign('+'), ' ', keySign('−'), ' or wheel or drag: zoom, ',
  keySign('0'), ' all; ', keySign('D'), ' light or dark');
document.body.append(el('div', { class: 'wrap' },
  el('header', {}, head, el('div', { class: 'tools' }, themeButton())),
  el('main', { class: 'cards' }, ...sheet.cards.map(cardOf)),
  el('footer', {}, help, ...sheet.origin.map(line => el('span', {}, line)))));
withDownloads(document.body);
