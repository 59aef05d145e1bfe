// The page of a run with a stock: arrows and colours of its forces, the stock before and after, the charts of the cut; with a run that the
// program makes here, compared with the tables of `stead forces` for the same cut.
//
//   STEAD=target/debug/stead node removal.mjs [FOLDER]     FOLDER keeps the run, and is taken as it is where it is there
import { execFileSync } from 'node:child_process';
import { existsSync, mkdirSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { fileURLToPath, pathToFileURL } from 'node:url';
import assert from 'node:assert/strict';
import { inShort, launch, withScript } from './browser.mjs';
import { violations } from './axe.mjs';
import { endsRound, frame, open, scale, table } from './suite.mjs';

const root = fileURLToPath(new URL('../../', import.meta.url));
const stead = process.env.STEAD ?? join(root, 'target/debug/stead');
const scratch = process.argv[2] ?? mkdtempSync(join(tmpdir(), 'stead-removal-'));
const at = (name) => join(scratch, name);
const run = (...words) => execFileSync(stead, words, { cwd: scratch, stdio: ['ignore', 'ignore', 'pipe'] });
let failures = 0;

// The published path, 5 mm deep in a slab, with a flute too short; the last segment cuts nothing.
const CUT = `[stock]
box_mm = [400, 440, 10]
xyz_mm = [0, 200, 0]
[tool]
cutter_diameter_mm = 16
teeth = 4
flute_length_mm = 4
kt_mpa = 800
kr = 0.4
ka_mpa = 100
kte_n_per_mm = 20
kre_n_per_mm = 20
[cut]
spindle_rpm = 20000
`;
if (!existsSync(at('out/report.html'))) {
  mkdirSync(scratch, { recursive: true });
  const shipped = readFileSync(join(root, 'configs/caro-2013.toml'), 'utf8');
  const path = readFileSync(join(root, 'tasks/five-segments-path.csv'), 'utf8').trimEnd().split('\n');
  writeFileSync(at('path.csv'), `${path.map((line, k) => `${line},${k ? 66.667 : 'feed_mm_per_s'}`).join('\n')}\n`);
  writeFileSync(at('robot.toml'), readFileSync(join(root, 'configs/robots/kuka-kr270-2.toml'), 'utf8'));
  const named = shipped.replace(/^robot = .*$/m, "robot = 'robot.toml'").replace(/^task = .*$/m, "task = 'path.csv'");
  writeFileSync(at('run.toml'), `${named.replace(/^\[reference\][^]*?(?=^\[|$(?![^]))/m, '')}\n${CUT}`);
  writeFileSync(at('forces.toml'), `path = 'path.csv'\n${CUT}`);
  const small = ['population=12', 'generations=2', 'basins=1'].flatMap((value) => ['--set', `search.${value}`]);
  run('place', 'run.toml', ...small, '--set', 'redundancy.beta_step_deg=7.2', '--out', 'out');
  run('forces', 'forces.toml', '--out', 'task.csv');
}
const engagement = table(at('task-engagement.csv'));
const summary = JSON.parse(readFileSync(at('out/summary.json'), 'utf8'));
const address = pathToFileURL(at('out/report.html')).href;
const browser = await launch();

/** A page with a test; returns what is wrong. */
async function wrongWith(where, test, options) {
  const { page, seen, close } = await open(browser, where, options);
  try {
    const said = await test(page);
    assert.deepEqual(seen, { requests: [], complaints: [] });
    return { said };
  } catch (error) {
    return { wrong: inShort(error) };
  } finally {
    await close();
  }
}

async function check(name, test, { where = address, ...options } = {}) {
  const { wrong, said } = await wrongWith(where, test, options);
  console.log(wrong ? `FAIL  ${name}: ${wrong}` : `ok    ${name}${said ? `: ${said}` : ''}`);
  failures += wrong ? 1 : 0;
}

const picture = (page) => page.evaluate(() => window.stead.picture());
const forces = (page) => page.locator('section[aria-label="Force and deflection"]');
const pick = (page, group, name) => page.getByRole('radiogroup', { name: group }).getByRole('radio', { name, exact: true }).click();

async function charts(page) {
  // What is read of the last curve, its column and decimals.
  const read = [
    ['cutting', 'force_n', 1, 'N'],
    ['removed', 'removed_mm3_per_mm', 2, 'mm³/mm'],
    ['height', 'highest_mm', 2, 'mm'],
    ['chip', 'chip_um', 1, 'µm'],
  ];
  const points = await page.evaluate(() => window.stead.cases[0].joints.length);
  assert.equal(points, engagement.length);
  for (const [name, column, digits, unit] of read) {
    await pick(page, 'What is seen along the path', name);
    for (const point of [3, 24, 70, points - 2]) {
      await page.evaluate((t) => window.stead.set({ t }, true), point);
      const said = await forces(page).locator('.head .sub').textContent();
      const row = engagement[point];
      if (row.highest_mm === '') {
        assert.equal(said, `${unit}; nothing is cut here`);
        continue;
      }
      const value = parseFloat(said.match(/here (-?[\d.]+)$/)[1]);
      assert.ok(Math.abs(value - row[column]) <= 0.51 * 10 ** -digits + 1e-4 * Math.abs(value), `${name} at ${point}: ${said}, ${row[column]}`);
    }
  }
}
await check('the charts of the cut are the table of its engagement', charts);

async function layers(page) {
  await page.locator('[data-view=tool]').click();
  const all = await picture(page);
  for (const layer of ['forces', 'deflection', 'after', 'before']) {
    await page.locator(`[data-layer=${layer}]`).click();
    assert.notEqual(await picture(page), all, `${layer} is not seen`);
    await page.locator(`[data-layer=${layer}]`).click();
    assert.equal(await picture(page), all, `${layer} is not as before`);
  }
  // The stock before alone is another than that after.
  await page.locator('[data-layer=after]').click();
  await page.locator('[data-layer=before]').click();
  assert.notEqual(await picture(page), all, 'the stock before is that after');
}
await check('forces and the stock before and after are switched', layers);

async function colours(page) {
  await page.locator('[data-view=tool]').click();
  const legend = () => scale(page, '.colouring');
  const seen = new Map();
  for (const name of ['error', 'force', 'removed']) {
    await pick(page, 'Colour of the path', name);
    await frame(page);
    seen.set(await picture(page), await legend());
  }
  assert.equal(seen.size, 3);
  const values = [...seen.values()];
  endsRound({ ...values[1], words: values[1].words.replace(/^N/, 'mm') }, engagement.map((row) => +row.force_n));
  // The other case keeps the colours.
  const before = await legend();
  await page.keyboard.press('3');
  assert.deepEqual(await legend(), before);
}
await check('the path has the colours of error, force and removed volume', colours);

await check('axe-core finds nothing', async (page) => assert.deepEqual(await violations(page), []));

await check('on paper it goes from the headline to the tables, its notes open', async (page) => {
  const fold = page.locator('#messages details');
  assert.equal(await fold.evaluate((one) => one.open), false);
  await page.emulateMedia({ media: 'print' });
  await page.evaluate(() => dispatchEvent(new Event('beforeprint')));
  const parts = ['#setup svg', 'h1', '#short', '.warnings', '#messages details', '.printed figure', '#cases', 'footer'];
  const tops = await page.evaluate((parts) => parts.map((part) => document.querySelector(part).getBoundingClientRect().top), parts);
  assert.deepEqual(tops, [...tops].sort((a, b) => a - b), parts.join());
  const { computed_notes: computed } = JSON.parse(readFileSync(at('out/page-data.json'), 'utf8'));
  assert.ok(computed.length > 0 && computed.length < summary.notes.length, `${computed}`);
  const seen = await fold.locator('li').evaluateAll((all) => all.map((one) => one.offsetHeight > 0));
  seen.forEach((isSeen, k) => assert.equal(isSeen, !computed.includes(summary.notes[k]), summary.notes[k]));
  assert.match(await fold.innerText(), /notes\.txt/);
  await page.evaluate(() => dispatchEvent(new Event('afterprint')));
  await page.emulateMedia({ media: 'screen' });
  assert.deepEqual(await fold.evaluate((one) => [one.open, one.querySelector('p').offsetHeight]), [false, 0]);
});

await check('both feeds and the warnings are stated', async (page) => {
  const rows = await page.locator('section[aria-label="At the programmed and at the held feed"] tbody tr').allTextContents();
  const expected = summary.cases.map(({ at_held_feed: held, mean_mm, max_mm }) =>
    [held.slowed_segments, ...[mean_mm, max_mm, held.mean_mm, held.max_mm].map((mm) => mm.toFixed(4))].join(''),
  );
  assert.deepEqual(rows.map((row) => row.replace(/^[A-Za-z, ]+/, '')), expected);
  const said = await page.locator('#messages .warnings').textContent();
  assert.ok(summary.warnings.length >= 2 && summary.warnings.every((warning) => said.includes(warning)), said);
});

for (const width of [380, 800, 1400]) {
  await check(
    `nothing is wider than a window of ${width}`,
    async (page) => {
      const [is, may] = await page.evaluate(() => [document.scrollingElement.scrollWidth, innerWidth]);
      assert.ok(is <= may, `${is} pixels in ${may}`);
      const [wide, room] = await forces(page).evaluate((card) => [card.scrollWidth, card.clientWidth]);
      assert.ok(wide <= room, `the card of the forces: ${wide} pixels in ${room}`);
    },
    { width, height: 900, scheme: 'dark' },
  );
}

await check(
  'a run without a stock has none of it',
  async (page) => {
    assert.equal(await page.locator('[data-layer=after], [data-layer=before], .colouring .choice').count(), 0);
    assert.deepEqual(await forces(page).getByRole('radio').allTextContents(), ['force', 'deflection']);
  },
  { where: pathToFileURL(join(root, 'results/caro-2013/report.html')).href },
);

// Broken on purpose: the test that is about it must fail.
const html = readFileSync(at('out/report.html'), 'utf8');
for (const [part, test, change] of [
  ['arrows', layers, (script) => script.replace('if (shown.forces) put(program, ofCase.forces, part);', '')],
  ['colours', colours, (script) => script.replace(/COLOURINGS\[state\.colouring\](;\s*const magnified)/, 'COLOURINGS[0]$1')],
  ['charts', charts, (script) => script.replace("['mean over a turn', FORCES,", "['mean over a turn', of.chip_n,")],
]) {
  const file = at(`${part}.html`);
  writeFileSync(file, withScript(html, change));
  const { wrong } = await wrongWith(pathToFileURL(file).href, test);
  console.log(wrong ? `ok    with the ${part} broken their own test fails: ${wrong}` : `FAIL  with the ${part} broken nothing fails`);
  failures += wrong ? 0 : 1;
}

await browser.close();
if (!process.argv[2]) rmSync(scratch, { recursive: true });
console.log(failures ? `${failures} failed` : 'all passed');
process.exit(failures ? 1 : 0);
