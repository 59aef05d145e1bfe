// What the page is made of, as its data say.

/**
 * @typedef {{label: string, is_log: boolean, names?: string[]}} Axis
 * @typedef {(number | null)[]} Numbers
 * @typedef {{name: string, style: 'line' | 'dashed' | 'dots' | 'rings' | 'intervals', color: number, x: Numbers, y: Numbers,
 *   low?: Numbers, high?: Numbers, labels?: string[], links?: string[]}} Series
 * @typedef {{is_level: boolean, at: number, label: string}} Mark
 * @typedef {{kind: 'text', title: string, sentences: string[], is_warning: boolean}} TextCard
 * @typedef {{kind: 'tiles', tiles: {label: string, value: string, unit: string, detail: string}[]}} TilesCard
 * @typedef {{kind: 'table', title: string, detail: string, columns: {name: string, is_number: boolean}[],
 *   rows: (null | string | [string, string])[][], can_filter: boolean}} TableCard
 * @typedef {{kind: 'chart', title: string, detail: string, x: Axis, y: Axis, series: Series[], marks?: Mark[], is_even: boolean,
 *   is_wide: boolean}} ChartCard
 * @typedef {{label: string, color: number, low: [number, number], high: [number, number]}} Outline
 * @typedef {{kind: 'heat-map', title: string, detail: string, x: Axis, y: Axis, columns: number[], rows: number[], values: Numbers,
 *   range: [number, number], unit: string, blank: string, outlines?: Outline[], is_even: boolean, is_written: boolean}} HeatMapCard
 * @typedef {{name: string, detail: string, deviations: Numbers, band: [number, number]}} PolarChoice
 * @typedef {{kind: 'polar', title: string, detail: string, unit: string, choices: PolarChoice[], angles: number[], excluded: boolean[]}} PolarCard
 * @typedef {TextCard | TilesCard | TableCard | ChartCard | HeatMapCard | PolarCard} AnyCard
 * @typedef {{title: string, subtitle: string, lead: string, cards: AnyCard[], origin: string[]}} Sheet
 */

/** @type {Sheet} */
const sheet = JSON.parse(document.getElementById('data')?.textContent ?? '{}');
