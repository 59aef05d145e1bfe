// What the page is made of, as its data say.

/** @import { Chart, HeatMap, Polar } from '../draw/chart-data.js' */

/**
 * @typedef {{kind: 'text', title: string, sentences: string[], is_warning: boolean}} TextCard
 * @typedef {{kind: 'tiles', tiles: {label: string, value: string, unit: string, detail: string}[]}} TilesCard
 * @typedef {{
 *   kind: 'table', title: string, detail: string, columns: {name: string, is_number: boolean}[],
 *   rows: (null | string | [string, string])[][], can_filter: boolean
 * }} TableCard
 * @typedef {TextCard | TilesCard | TableCard | ({kind: 'chart'} & Chart) | ({kind: 'heat-map'} & HeatMap)
 *   | ({kind: 'polar'} & Polar)} AnyCard
 * @typedef {{title: string, subtitle: string, lead: string, cards: AnyCard[], origin: string[]}} Sheet
 */

/** @type {Sheet} */
export const sheet = JSON.parse(document.getElementById('data')?.textContent ?? '{}');
