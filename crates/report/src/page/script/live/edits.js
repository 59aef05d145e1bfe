// Other values of the run file: cell, criterion and force uncertainty, with the checks of the file; and a file of them.

import { card, el } from '../draw/dom.js';
import { RAW } from '../run/data.js';
import { chip, tell, tried } from './jobs.js';
import { place } from './place.js';
import { ask } from './server.js';

const STATED = RAW.live.stated ?? {};

/** A value as TOML. @param {any} value @returns {string} */
const toml = (value) => (Array.isArray(value) ? `[${value.map(toml).join(', ')}]` : typeof value === 'string' ? JSON.stringify(value) : String(value));

/** Fields with their keys; of the yaw that which the file states. @type {[string, string, string][]} */
const FIELDS = [
  ['cell.x_mm', 'Cell x, mm', '[least, most]'],
  ['cell.y_mm', 'Cell y, mm', '[least, most]'],
  ['cell.z_mm', 'Cell z, mm', '[least, most]'],
  STATED.cell?.q4 ? ['cell.q4', 'Cell sin(yaw / 2)', '[least, most]'] : ['cell.yaw_deg', 'Cell yaw, °', '[least, most]; all where empty'],
  ['criterion.direction', 'Scored direction', '"wall", "surface", "axis" or "total"'],
  ['criterion.aggregate', 'Made up by', '"mean", "rms" or "max"'],
  ['criterion.force_uncertainty', 'Force uncertainty', 'share of the force, as 0.1'],
];

/** What is in a field at first: the value as it is read now. @param {string} key */
function valueOf(key) {
  const [table, name] = key.split('.');
  const value = STATED[table]?.[name];
  return value === undefined ? '' : toml(value);
}

/** The card of the values. */
export function editsCard() {
  const fields = FIELDS.map(([key, name, hint]) => {
    const first = valueOf(key);
    const field = /** @type {HTMLInputElement} */ (el('input', { type: 'text', id: `edit-${key.replace('.', '-')}`, value: first, placeholder: hint, title: `${key}: ${hint}`, spellcheck: 'false' }));
    return { key, first, field, label: el('label.field.wide', {}, el('span', {}, name), field) };
  });
  /** @type {string[]} */
  const before = RAW.live.state.edits;
  const changed = () => {
    const now = fields.filter(({ field, first }) => field.value.trim() !== first && field.value.trim()).map(({ key, field }) => `${key}=${field.value.trim()}`);
    const isAgain = (/** @type {string} */ old) => now.some((one) => one.split('=')[0] === old.split('=')[0]);
    return [...before.filter((old) => !isAgain(old)), ...now];
  };
  const wrong = el('p.wrong', { id: 'edit-wrong', role: 'alert', hidden: true });
  const apply = async (/** @type {string[]} */ edits) => {
    try {
      await ask('/edit', { edits });
      location.reload();
    } catch (error) {
      wrong.hidden = false;
      wrong.textContent = error instanceof Error ? error.message : String(error);
    }
  };
  const name = /** @type {HTMLInputElement} */ (el('input', { type: 'text', id: 'save-name', placeholder: 'new-run.toml', spellcheck: 'false' }));
  const alone = /** @type {HTMLInputElement} */ (el('input', { type: 'checkbox', id: 'save-placement' }));
  const save = async () => {
    const saved = await tried(() => ask('/save', { name: name.value.trim(), is_placement: alone.checked, ...place }));
    if (saved) tell(`saved as ${saved.file}`);
  };
  return card(
    'Values of the run',
    before.length ? `changed: ${before.join(', ')}` : 'as the file has them',
    el('div.fields', {}, ...fields.map(({ label }) => label)),
    wrong,
    el('div.row', {}, chip('edit-apply', 'Apply', () => void apply(changed())), ...(before.length ? [chip('edit-reset', 'As in the file', () => void apply([]))] : [])),
    el('div.row', {}, chip('save', 'Save as run file', () => void save()), el('label.field', {}, el('span', {}, 'name'), name), el('label.field', {}, alone, el('span', {}, 'with this placement alone'))),
  );
}
