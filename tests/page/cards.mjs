// The pages of the other commands in Debian's Chromium: made by the program, opened from the disk with the network denied, and compared
// with the tables beside them.
//
//   STEAD=target/debug/stead node cards.mjs
import { execFileSync } from 'node:child_process';
import { cpSync, existsSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { fileURLToPath, pathToFileURL } from 'node:url';
import assert from 'node:assert/strict';
import { inShort, launch, withScript } from './browser.mjs';
import { violations } from './axe.mjs';
import { table } from './suite.mjs';

const root = fileURLToPath(new URL('../../', import.meta.url));
const stead = process.env.STEAD ?? join(root, 'target/debug/stead');
const scratch = mkdtempSync(join(tmpdir(), 'stead-cards-'));
const out = (name) => join(scratch, name);
const run = (...words) => execFileSync(stead, words, { cwd: root, stdio: ['ignore', 'ignore', 'pipe'] });
let failures = 0;

const browser = await launch();

/** Opens a page, which may ask for nothing and complain of nothing; returns what is wrong. */
async function check(file, test, { width = 1400, also } = {}) {
  const context = await browser.newContext({ viewport: { width, height: 1000 }, colorScheme: 'light', offline: true });
  const page = await context.newPage();
  const wrong = [];
  const address = pathToFileURL(file).href;
  page.on('request', (request) => request.url() !== address && !also?.test(request.url()) && wrong.push(`asks for ${request.url()}`));
  page.on('console', (message) => message.type() === 'error' && wrong.push(message.text()));
  page.on('pageerror', (error) => wrong.push(String(error)));
  try {
    await page.goto(address);
    await page.waitForSelector('footer');
    await test(page);
    assert.deepEqual(await violations(page), []);
    assert.deepEqual(wrong, []);
    return null;
  } catch (error) {
    return inShort(error);
  } finally {
    await context.close();
  }
}

async function must(name, ...words) {
  const wrong = await check(...words);
  console.log(wrong === null ? `ok    ${name}` : `FAIL  ${name}: ${wrong}`);
  failures += wrong === null ? 0 : 1;
}
const card = (page, title) => page.locator(`section[aria-label="${title}"]`);
const plot = (page, title) => card(page, title).locator('canvas[tabindex]');
const tip = (page, title) => card(page, title).locator('.tip').textContent();
const pixels = (page, title) => card(page, title).locator('.plot canvas').first().evaluate((canvas) => canvas.toDataURL());
const cells = async (page, title, column) => {
  const rows = await card(page, title).locator(`tbody tr td:nth-child(${column})`).allTextContents();
  return rows.filter(Boolean).map(Number);
};

/** A chart zooms by button, key, wheel and drag, and shows all again. */
async function zooms(page, title) {
  const all = await pixels(page, title);
  const changed = async (what) => {
    await page.waitForFunction(([title]) => document.querySelector(`section[aria-label="${title}"] .plot`).dataset.zoomed === 'true', [title]);
    assert.notEqual(await pixels(page, title), all, what);
    await plot(page, title).press('0');
    assert.equal(await pixels(page, title), all, `all again after ${what}`);
  };
  await card(page, title).getByRole('button', { name: 'Zoom in' }).click();
  await changed('button');
  await plot(page, title).press('+');
  await changed('key');
  await plot(page, title).scrollIntoViewIfNeeded();
  const box = await plot(page, title).boundingBox();
  await page.mouse.move(box.x + box.width / 2, box.y + box.height / 2);
  await page.mouse.wheel(0, -200);
  await changed('wheel');
  await page.mouse.move(box.x + box.width * 0.3, box.y + box.height * 0.3);
  await page.mouse.down();
  await page.mouse.move(box.x + box.width * 0.6, box.y + box.height * 0.6, { steps: 4 });
  await page.mouse.up();
  await changed('drag');
}

/** A table sorts by a column both ways and filters by a word. */
async function sorts(page, title, column, word) {
  const heading = card(page, title).locator(`thead th:nth-child(${column}) button`);
  await heading.click();
  const rising = await cells(page, title, column);
  assert.deepEqual(rising, [...rising].sort((a, b) => a - b));
  await heading.click();
  assert.deepEqual(await cells(page, title, column), [...rising].sort((a, b) => b - a));
  if (!word) return;
  const rows = card(page, title).locator('tbody tr');
  await card(page, title).getByRole('searchbox').fill(word);
  const left = await rows.allTextContents();
  assert.ok(left.length > 0 && left.every((text) => text.toLowerCase().includes(word.toLowerCase())), word);
  await card(page, title).getByRole('searchbox').fill('no row has this');
  assert.equal(await rows.count(), 0);
  await card(page, title).getByRole('searchbox').fill('');
}

/** Picture and figures of a card, as files. */
async function given(page, title) {
  const files = [];
  for (const name of [`CSV: ${title}`, `PNG: ${title}`]) {
    const [download] = await Promise.all([page.waitForEvent('download'), page.getByRole('button', { name, exact: true }).click()]);
    files.push(readFileSync(await download.path()));
  }
  assert.ok(files[1].subarray(1, 4).equals(Buffer.from('PNG')), title);
  return files[0].toString().trimEnd().split('\n').map((line) => line.split(','));
}

/** D changes the colours of page and charts. */
async function darkens(page, title) {
  const light = await pixels(page, title);
  await page.locator('body').press('d');
  assert.notEqual(await pixels(page, title), light);
  assert.equal(await page.evaluate(() => document.documentElement.dataset.theme), 'dark');
}

run('circularity', 'tasks/measured-groove.csv', '--out', out('circle'));
const circle = JSON.parse(readFileSync(join(out('circle'), 'circularity.json'), 'utf8'));
const deviations = table(join(out('circle'), 'deviations.csv'));
await must('circularity: points under keys and pointer, circles to choose from', join(out('circle'), 'report.html'), async (page) => {
  const title = 'Deviation from the reference circle';
  const first = deviations[0];
  const reads = async (name) => {
    await plot(page, title).press('Escape');
    await plot(page, title).press('ArrowRight');
    const text = await tip(page, title);
    const [, said] = text.match(/deviation (\S+) mm/);
    assert.ok(Math.abs(said - first[`${name}_deviation_mm`]) < 2e-5 * Math.max(1e-3, Math.abs(said)) + 1e-7, `${name}: ${text}`);
    assert.ok(text.startsWith('point 0'), text);
  };
  await reads('lsc');
  await card(page, title).getByRole('radio', { name: /MIC/ }).click();
  await page.keyboard.press('Escape');
  assert.match(await card(page, title).locator('.legend').textContent(), new RegExp(circle.mic.circularity_mm.toFixed(6)));
  await plot(page, title).press('ArrowLeft');
  await zooms(page, title);
  await darkens(page, title);
});

run('identify', 'fit', 'configs/identify-example.toml', '--out', out('identify'));
const residuals = table(join(out('identify'), 'residuals.csv'));
const identified = JSON.parse(readFileSync(join(out('identify'), 'report.json'), 'utf8'));
const identify = async (page) => {
  assert.match(await page.locator('.tile').first().textContent(), new RegExp(identified.residual_rms_mm.toFixed(4)));
  const title = 'Deflection read and by the identified arm';
  await plot(page, title).press('ArrowRight');
  const text = await tip(page, title);
  const row = residuals[0];
  assert.ok(text.includes(`line ${row.line}`), text);
  const [, read] = text.match(/component read \(mm\) (\S+)/);
  assert.ok(Math.abs(read - row.measured_x_mm) < 1e-4 * Math.abs(read), text);
  await zooms(page, 'Residuals');
  const figures = await given(page, 'Readings');
  assert.deepEqual([figures.length, +figures[1][0]], [residuals.length + 1, +residuals[0].line]);
  const dots = await given(page, 'Residuals');
  assert.ok(dots.length > 3 * residuals.length && dots[0][0] === 'series', dots[0].join());
  await sorts(page, 'Readings', 5, residuals[0].configuration);
  await plot(page, 'Compliances with their 95 % intervals').press('ArrowRight');
  assert.match(await tip(page, 'Compliances with their 95 % intervals'), /^ ?joint 1/m);
};
await must('identify fit: residuals, intervals, readings', join(out('identify'), 'report.html'), identify);

run('forces', 'configs/forces-pocket.toml', '--out', out('pocket.csv'));
const engagement = table(out('pocket-engagement.csv'));
await must('forces: every chart of the picture, warnings, zoom', out('pocket-forces.html'), async (page) => {
  const title = 'Force on the tool';
  const force = (text) => +text.match(/force \(N\) ([-\d.]+)/)[1];
  await plot(page, title).press('Home');
  const [first] = engagement;
  const read = force(await tip(page, title));
  assert.ok(Math.abs(read - first.force_n) <= 0.002 * first.force_n + 1e-3, `${read}, ${first.force_n}`);
  for (const other of ['Moment about the tool centre point', 'Height of the cut above the tool centre point', 'Angles of the cut', 'Thickest chip'])
    assert.equal(await plot(page, other).count(), 1, other);
  const { warnings } = JSON.parse(readFileSync(out('pocket-forces.json'), 'utf8'));
  const said = await page.locator('main').textContent();
  assert.ok(warnings.length > 0 && warnings.every((warning) => said.includes(warning)));
  await zooms(page, title);
  await darkens(page, title);
});

cpSync(join(root, 'results/study-k1'), out('study'), { recursive: true });
const ranking = table(join(out('study'), 'study-ranking.csv'));
await must('study: a table that sorts and filters, effects', join(out('study'), 'report.html'), async (page) => {
  const rows = card(page, 'Ranking').locator('tbody tr');
  assert.equal(await rows.count(), Math.min(500, ranking.length));
  assert.equal(await rows.first().locator('td').nth(1).textContent(), ranking[0].cases);
  await sorts(page, 'Ranking', 1, ranking[0].status);
});

/** Goes through the points of a chart by keys until the words of one are right. */
async function pointWith(page, title, words) {
  for (let k = 0; k < 50; k++) {
    await plot(page, title).press(k ? 'ArrowRight' : 'Home');
    const text = await tip(page, title);
    if (text.includes(words)) return text;
  }
  throw new Error(`no point of "${title}" has ${words}`);
}

writeFileSync(
  out('small.toml'),
  `base = ${JSON.stringify(join(root, 'configs/caro-2013.toml'))}
keep = "best 1"

[[axis]]
name = "cell"
field = "cell.z_mm"
values = [[-602.0, -214.0], [-408.0, -300.0]]
labels = ["published", "lower"]

[[axis]]
field = "robot.joints[1].stiffness_mnm_per_rad"
values = [0.2, 1.41]

[[axis]]
name = "search"
fields = ["search.population", "search.generations", "search.basins", "redundancy.beta_step_deg"]
values = [[12, 2, 1, 12.0]]
labels = ["small"]
`,
);
run('study', 'run', out('small.toml'), '--out', out('small'));
run('study', 'report', out('small.toml'), '--out', out('small'));
const front = table(join(out('small'), 'study-front.csv'));
const ranked = table(join(out('small'), 'study-ranking.csv'));
await must('study report: front and map with the numbers of the tables, and the page of the case that is kept', join(out('small'), 'report.html'), async (page) => {
  const columns = { best_mean_total_mm: 'whole deflection, mean (mm)', cycle_s: 'cycle time (s)' };
  const title = 'Front of whole deflection, mean and cycle time';
  for (const row of front) {
    const text = await pointWith(page, title, `case ${row.cases} `);
    for (const [name, words] of Object.entries(columns)) {
      const value = parseFloat(text.split(`${words}, smaller is better `)[1]);
      assert.ok(Math.abs(value - row[name]) < 1e-4 * Math.abs(row[name]), `${name} in ${text}`);
    }
  }
  await zooms(page, title);
  const map = 'Mean of score';
  const read = await pointWith(page, map, 'published');
  const values = ranked.filter((row) => row.cell === 'published').map((row) => +row.objective_mm);
  const [, mean] = read.match(/(\S+) mm$/);
  assert.ok(values.some((value) => Math.abs(value - mean) < 1e-3 * value), `${read}: none of ${values}`);
  // Columns in words with their units, figures with three digits, the whole deflection beside the score, and that scores cancel.
  const heads = await card(page, 'Ranking').locator('thead th').allTextContents();
  assert.deepEqual(heads, ['rank', 'case', 'cell', 'robot joints[1] stiffness (MN m/rad)', 'score (mm)', 'whole deflection, mean (mm)', 'behind the best (%)', 'status', 'reason']);
  const found = table(join(out('small'), 'study.csv'));
  for (const [k, row] of ranked.entries()) {
    const shown = await card(page, 'Ranking').locator(`tbody tr:nth-child(${k + 1}) td`).allTextContents();
    const { best_mean_total_mm: whole } = found.find((one) => one.case === row.cases);
    for (const [text, value] of [[shown[4], row.objective_mm], [shown[5], whole]])
      assert.ok(+text === +(+value).toPrecision(3) && text.replace(/^0\.0*|\./g, '').length === 3, `${text}: ${value}`);
  }
  assert.match(await card(page, 'Notes').or(page.locator('.text')).first().textContent(), /score of 4 of 4 layouts is below a fifth of their whole deflection/);
  // The links: of the table, and of its point in the front where it has one.
  const link = card(page, 'Ranking').locator('a');
  assert.equal(await link.count(), 1);
  assert.equal(await link.textContent(), ranked[0].cases);
  const kept = new URL(await link.getAttribute('href'), page.url());
  assert.ok(existsSync(fileURLToPath(kept)), kept.href);
  await pointWith(page, title, `case ${ranked[0].cases} `);
  await plot(page, title).press('Enter');
  await page.waitForURL(kept.href);
  await page.waitForSelector('#cases');
  const [best] = table(fileURLToPath(new URL('placements.csv', kept)));
  assert.ok((await page.locator('#cases tbody tr').first().textContent()).includes((+best.mean_mm).toFixed(4)));
  // The page of the case says which it is, has its setup sheet, and leads back.
  const said = await page.locator('header .case').textContent();
  assert.equal(said, `case ${ranked[0].cases} of the study small: cell = ${ranked[0].cell}, robot.joints[1].stiffness_mnm_per_rad = ${ranked[0]['robot.joints[1].stiffness_mnm_per_rad']}, search = small`);
  assert.equal(await page.locator('#setup svg').count(), 1);
  assert.ok(existsSync(fileURLToPath(new URL('setup.svg', kept))));
  await page.locator('#study').click();
  await page.waitForURL(pathToFileURL(join(out('small'), 'report.html')).href);
  await page.waitForSelector('footer');
}, { also: /cases\/[^/]+\/report\.html$/ });

run('simulate', 'configs/umons-aluminium.toml', '--out', out('simulate'));
const simulated = JSON.parse(readFileSync(join(out('simulate'), 'summary.json'), 'utf8'));
await must('simulate: forces, wall, roughness and modes', join(out('simulate'), 'report.html'), async (page) => {
  const samples = table(join(out('simulate'), 'series.csv'));
  const near = (value, rows, column) => rows.some((row) => Math.abs(row[column] - value) <= 1e-4 * Math.abs(value) + 1e-4);
  const forces = 'Forces on the tool over the pass';
  for (const [name, column] of [['along the feed', 'force_x_n'], ['towards the wall', 'force_y_n']]) {
    // Curves follow each other: the first and the last point are of different ones.
    await plot(page, forces).press(name === 'along the feed' ? 'Home' : 'End');
    for (let k = 0; k < 80; k++) await plot(page, forces).press(name === 'along the feed' ? 'Shift+ArrowRight' : 'Shift+ArrowLeft');
    const read = await tip(page, forces);
    const [, time, force] = read.match(/time \(s\) (\S+)\nforce \(N\) (\S+)/);
    const rows = samples.filter((row) => Math.abs(row.time_s - time) < 2e-4);
    assert.ok(read.startsWith(name) && near(+force, rows, column), read);
  }
  await zooms(page, forces);
  const wall = table(join(out('simulate'), 'wall.csv'));
  const text = await pointWith(page, 'Wall: height over the nominal wall', 'height (um)');
  const [, along, height] = text.match(/along the feed \(mm\) (\S+)\nheight \(um\) (\S+)/);
  assert.ok(near(+height, wall.filter((row) => Math.abs(row.x_mm - along) < 0.02), 'height_um'), text);
  const modes = await cells(page, 'Modes of the arm', 2);
  assert.ok(modes.length === simulated.modes.length && modes.every((shown, k) => Math.abs(shown - simulated.modes[k].frequency_hz) < 0.00056));
  await darkens(page, forces);
});

run('compensate', 'configs/compensate-caro-2013.toml', '--out', out('compensate'));
const corrected = table(join(out('compensate'), 'corrected-path.csv'));
await must('compensate: before and after along the path', join(out('compensate'), 'report.html'), async (page) => {
  const title = 'Normal to the feed before and after';
  const before = await pointWith(page, title, 'target commanded');
  const [, value] = before.match(/mm\) (\S+)$/);
  assert.ok(Math.abs(value - Math.abs(corrected[0].before_normal_mm)) < 1e-4 * value, before);
  await plot(page, title).press('End');
  const after = await tip(page, title);
  const [, least] = after.match(/mm\) (\S+)$/);
  assert.ok(after.startsWith('corrected command') && Math.abs(least - Math.abs(corrected.at(-1).after_normal_mm)) < 1e-7, after);
  await zooms(page, title);
});

run('stability', 'configs/umons-steel.toml', '--out', out('stability'));
const stability = table(join(out('stability'), 'lobes.csv'));
await must('stability: lobes, response, modes', join(out('stability'), 'report.html'), async (page) => {
  const title = 'Stability lobes';
  const text = await pointWith(page, title, 'semi-discretisation');
  const [, speed, depth] = text.match(/\(rpm\) (\S+)\n.*\(mm\) (\S+)$/);
  assert.ok(Math.abs(speed - stability[0].spindle_rpm) < 0.1 && Math.abs(depth - stability[0].critical_depth_mm) < 1e-4, text);
  await zooms(page, title);
  await zooms(page, 'Frequency response of the tip');
  const frequencies = table(join(out('stability'), 'modes.csv')).map((row) => +row.frequency_hz);
  (await cells(page, 'Modes of the arm', 2)).forEach((shown, k) => assert.ok(Math.abs(shown - frequencies[k]) < 0.00056, `${shown}`));
});

run('assess', 'configs/horizontal-slot.toml', '--out', out('assess'));
await must('assess: maps with zones, ranking', join(out('assess'), 'report.html'), async (page) => {
  const title = await page.locator('section.tall').first().getAttribute('aria-label');
  await plot(page, title).press('ArrowRight');
  const text = await tip(page, title);
  const map = table(join(out('assess'), readdir(/^map-.*\.csv$/)));
  const [, value] = text.match(/\n(\S+) mm$/);
  assert.ok(Object.values(map[0]).length > 3 && +value > 0, text);
  await zooms(page, title);
  await sorts(page, 'Ranking', 1);
  // All maps have the colours and the axes of each other.
  const maps = await page.locator('section.tall').evaluateAll((all) => all.map((one) => one.querySelector('.marks').textContent));
  assert.ok(maps.length > 1 && maps.every((one) => one === maps[0]), maps.join('; '));
  const ends = await page.evaluate(() => JSON.parse(document.getElementById('data').textContent).cards.filter(({ kind }) => kind === 'heat-map').map(({ x, y, range }) => [x.range, y.range, range]));
  ends.forEach((one) => assert.deepEqual(one, ends[0]));
  const drawn = await page.locator('section.tall .plot').evaluateAll((all) => all.map((one) => one.getBoundingClientRect()));
  drawn.forEach(({ width, height }) => assert.ok(Math.abs(width - drawn[0].width) < 1 && height === drawn[0].height));
  // On paper charts are drawn for its width, as pictures, and the figures come first.
  await page.emulateMedia({ media: 'print' });
  await page.evaluate(() => dispatchEvent(new Event('beforeprint')));
  const pictures = await page.locator('.plot').evaluateAll((all) => all.map((one) => [one.querySelector('img').naturalWidth, one.clientWidth]));
  assert.ok(pictures.length > 2 && pictures.every(([dots, width]) => width === 690 && dots === 3 * width), `${pictures}`);
  const tops = await page.evaluate(() => ['h1', '.tiles', '.warning', 'table', '.plot'].map((part) => document.querySelector(part).getBoundingClientRect().top));
  assert.deepEqual(tops, [...tops].sort((a, b) => a - b));
  await page.evaluate(() => dispatchEvent(new Event('afterprint')));
  await page.emulateMedia({ media: 'screen' });
  assert.equal(await page.locator('.plot img').count(), 0);
});

/** The file of a name in the folder of the assessment. */
function readdir(pattern) {
  const manifest = JSON.parse(readFileSync(join(out('assess'), 'manifest.json'), 'utf8'));
  return JSON.stringify(manifest).match(/"(map-[^"]+\.csv)"/)[1].replace(pattern, '$&');
}

for (const width of [380, 800, 2200]) {
  await must(`nothing is wider than a window of ${width}`, join(out('identify'), 'report.html'), async (page) => {
    const [is, may] = await page.evaluate(() => [document.scrollingElement.scrollWidth, innerWidth]);
    assert.ok(is <= may, `${is} pixels in ${may}`);
  }, { width });
}

// A page whose residuals are drawn and read from the wrong column must fail.
const html = readFileSync(join(out('identify'), 'report.html'), 'utf8');
writeFileSync(out('broken.html'), withScript(html, (script) => script.replace('series.x[k] : k, y))', 'series.x[k] : k, series.x[k]))')));
const wrong = await check(out('broken.html'), identify);
const isOwn = wrong?.startsWith('x of the base frame');
console.log(`${isOwn ? 'ok   ' : 'FAIL '} with the residuals read from the wrong column their test fails: ${wrong ?? 'nothing fails'}`);
failures += isOwn ? 0 : 1;

await browser.close();
rmSync(scratch, { recursive: true });
process.exit(failures ? 1 : 0);
