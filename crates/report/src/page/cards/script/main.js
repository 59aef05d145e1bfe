// The page: its head, its cards in their order, where it comes from.

/**
 * @param {AnyCard} card
 * @returns {HTMLElement}
 */
function cardOf(card) {
  switch (card.kind) {
    case 'text': {
      const list = element('ul', {}, ...card.sentences.map(sentence => element('li', {}, sentence)));
      const head = element('div', { class: 'head' }, element('h2', {}, card.title));
      return element('section', { class: card.is_warning ? 'card wide text warning' : 'card wide text' }, head, list);
    }
    case 'tiles':
      return element('div', { class: 'tiles wide' }, ...card.tiles.map(tile => element('div', { class: 'tile' },
        element('div', { class: 'k' }, tile.label),
        element('div', { class: 'v' }, tile.value, element('span', { class: 'u' }, tile.unit)),
        element('div', { class: 'd', title: tile.detail }, tile.detail))));
    case 'table': return tableCard(card);
    case 'chart': return chartCard(card);
    case 'heat-map': return heatMapCard(card);
    case 'polar': return polarCard(card);
  }
}

const themeButton = element('button', { type: 'button', class: 'icon', 'aria-label': 'Light or dark', title: 'Light or dark (D)' }, '◐');
themeButton.addEventListener('click', turnTheme);
addEventListener('keydown', event => {
  const isField = event.target instanceof HTMLInputElement;
  if (!isField && !event.ctrlKey && !event.metaKey && !event.altKey && event.key.toLowerCase() === 'd') turnTheme();
});
const head = element('div', {}, element('h1', {}, sheet.title, element('small', {}, sheet.subtitle)), element('p', {}, sheet.lead));
const keySign = (/** @type {string} */ name) => element('kbd', {}, name);
const help = element('span', {}, 'In a chart: ', keySign('←'), ' ', keySign('→'), ' values, ', keySign('+'), ' ', keySign('−'), ' or wheel or drag: zoom, ',
  keySign('0'), ' all; ', keySign('D'), ' light or dark');
document.body.append(element('div', { class: 'wrap' },
  element('header', {}, head, element('div', { class: 'tools' }, themeButton)),
  element('main', { class: 'cards' }, ...sheet.cards.map(cardOf)),
  element('footer', {}, help, ...sheet.origin.map(line => element('span', {}, line)))));
