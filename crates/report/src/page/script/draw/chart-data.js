// What is drawn: the values of `chart.rs`, and what the page of a run makes like them.

/**
 * @typedef {ArrayLike<number | null>} Numbers null or NaN for none
 * @typedef {{
 *   label: string, is_log: boolean, names?: string[], range?: [number, number]
 * }} Axis names: in the place of 0, 1, 2 and so on; range: its ends, where they are not those of the values
 * @typedef {{
 *   name: string, style: 'line' | 'dashed' | 'dots' | 'rings' | 'intervals', color: number | string, width?: number, x?: Numbers,
 *   y: Numbers, low?: Numbers, high?: Numbers, labels?: string[], links?: string[]
 * }} Series color: its place among the colours of series, or a custom property; without x over 0, 1, 2 and so on
 * @typedef {{
 *   is_level: boolean, at: number, label: string, kind?: 'limit' | 'break'
 * }} Mark a limit is not to be passed; at a break curves end and begin anew
 * @typedef {{
 *   title: string, detail: string, x: Axis, y: Axis, series: Series[], marks?: Mark[], is_even?: boolean, is_wide?: boolean
 * }} Chart
 * @typedef {{label: string, color: number, low: [number, number], high: [number, number]}} Outline
 * @typedef {{
 *   title: string, detail: string, x: Axis, y: Axis, columns: number[], rows: number[], values: (number | null)[],
 *   range: [number, number], unit: string, blank: string, outlines?: Outline[], is_even: boolean, is_written: boolean
 * }} HeatMap
 * @typedef {{name: string, detail: string, deviations: (number | null)[], band: [number, number]}} PolarChoice
 * @typedef {{
 *   title: string, detail: string, unit: string, choices: PolarChoice[], angles: number[], excluded: boolean[]
 * }} Polar
 */

export {};
