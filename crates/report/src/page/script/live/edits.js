// Other values of the run file: cell, criterion and force uncertainty, with the checks of the file; and a file of them.

import { card, el } from '../draw/dom.js';
import { RAW } from '../run/data.js';
import { changed, chip, tell, tried } from './jobs.js';
import { place } from './place.js';
import { ask } from './server.js';

const STATED = RAW.live.stated ?? {};
/** The same without what was changed in the session. */
const IN_FILE = RAW.live.stated_in_file ?? {};

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

/** A value as text, empty where none is stated. @param {any} stated @param {string} key */
function valueOf(stated, key) {
  const [table, name] = key.split('.');
  const value = stated[table]?.[name];
  return value === undefined ? '' : toml(value);
}

/** The card of the values. */
export function editsCard() {
  const fields = FIELDS.map(([key, name, hint]) => {
    const first = valueOf(STATED, key);
    const field = /** @type {HTMLInputElement} */ (el('input', { type: 'text', id: `edit-${key.replace('.', '-')}`, value: first, placeholder: hint, title: `${key}: ${hint}`, spellcheck: 'false' }));
    return { key, field, label: el('label.field.wide', {}, el('span', {}, name), field) };
  });
  /** @type {string[]} */
  const before = RAW.live.state.edits;
  /** What differs from the file: a field that is empty has its value. */
  const wanted = () => {
    const now = fields.filter(({ key, field }) => !['', valueOf(IN_FILE, key)].includes(field.value.trim())).map(({ key, field }) => `${key}=${field.value.trim()}`);
    const isHere = (/** @type {string} */ old) => fields.some(({ key }) => key === old.split('=')[0]);
    return [...before.filter((old) => !isHere(old)), ...now];
  };
  const wrong = el('p.wrong', { id: 'edit-wrong', role: 'alert', hidden: true });
  const apply = async (/** @type {string[]} */ edits) => {
    try {
      changed((await ask('/edit', { edits })).edits);
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
    el('div.row', {}, chip('edit-apply', 'Apply', () => void apply(wanted())), ...(before.length ? [chip('edit-reset', 'Reset to the file', () => void apply([]))] : [])),
    el('div.row', {}, chip('save', 'Save as run file', () => void save()), el('label.field', {}, el('span', {}, 'name'), name), el('label.field', {}, alone, el('span', {}, 'with this placement alone'))),
  );
}
