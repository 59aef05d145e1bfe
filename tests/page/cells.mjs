// The view of cells: the robot behind fences, and what external axes carry; with runs that the program makes here.
//
//   STEAD=target/debug/stead node cells.mjs [FOLDER]     FOLDER keeps the runs, and is taken as it is where they are there
import { execFileSync } from 'node:child_process';
import { existsSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { dirname, join } from 'node:path';
import { fileURLToPath, pathToFileURL } from 'node:url';
import assert from 'node:assert/strict';
import { inShort, launch, withScript } from './browser.mjs';
import { violations } from './axe.mjs';
import { PLANS, open, table } from './suite.mjs';
import { validated } from './validated.mjs';

const root = fileURLToPath(new URL('../../', import.meta.url));
const stead = process.env.STEAD ?? join(root, 'target/debug/stead');
const kept = process.argv[2];
const scratch = kept ?? mkdtempSync(join(tmpdir(), 'stead-cells-'));
let failures = 0;

/** A small run of a shipped file. */
function folder(name) {
  const place = join(scratch, name);
  const small = ['population=12', 'generations=2', 'basins=1'].flatMap((value) => ['--set', `search.${value}`]);
  if (!existsSync(join(place, 'report.html'))) {
    execFileSync(stead, ['place', `configs/${name}.toml`, ...small, '--out', place], { cwd: root, stdio: ['ignore', 'ignore', 'pipe'] });
  }
  return place;
}

const browser = await launch();

async function check(name, run, test) {
  try {
    const place = folder(run);
    const { page, seen, close } = await open(browser, pathToFileURL(join(place, 'report.html')).href);
    const said = await test(page, place);
    assert.deepEqual(await violations(page), []);
    assert.deepEqual(seen, { requests: [], complaints: [] });
    await close();
    const scene = await validated(place);
    assert.equal(scene.wrong, 0, scene.text);
    console.log(`ok    ${run}: ${name}${said ? `: ${said}` : ''}; ${scene.text}`);
  } catch (error) {
    failures++;
    console.log(`FAIL  ${run}: ${name}: ${inShort(error)}`);
  }
}

/** How many pixels of the view have the colour of the arm, and of the light parts in its middle. */
const orange = (page) =>
  page.evaluate(async () => {
    const picture = new Image();
    picture.src = window.stead.picture();
    await picture.decode();
    const canvas = document.createElement('canvas');
    [canvas.width, canvas.height] = [picture.width, picture.height];
    const g = canvas.getContext('2d', { willReadFrequently: true });
    g.drawImage(picture, 0, 0);
    const { data } = g.getImageData(0, 0, canvas.width, canvas.height);
    let count = 0;
    for (let k = 0; k < data.length; k += 4) count += data[k + 3] > 200 && data[k] > 1.35 * data[k + 2] && data[k] > 90 ? 1 : 0;
    return { count, picture: picture.src };
  });

await check('the robot is seen through the fence', 'collision', async (page) => {
  const layer = page.locator('[data-layer=around]');
  const counts = [];
  for (const view of ['cell', 'front', 'tool']) {
    await page.locator(`[data-view=${view}]`).click();
    const fenced = await orange(page);
    await layer.click();
    const bare = await orange(page);
    await layer.click();
    assert.notEqual(fenced.picture, bare.picture, `no fence in the view ${view}`);
    assert.ok(bare.count > 2000, `${bare.count} pixels of the arm in the view ${view}`);
    counts.push(fenced.count / bare.count);
    assert.ok(fenced.count > 0.7 * bare.count, `${fenced.count} of ${bare.count} pixels of the arm are seen in the view ${view}`);
  }
  return `${(100 * Math.min(...counts)).toFixed(0)} % of its pixels at least`;
});

await check('the path is seen through the part that surrounds it', 'collision', async (page) => {
  const box = page.getByRole('checkbox', { name: 'see through the part' });
  assert.ok(await box.isChecked(), 'the part hides its path at first');
  // The path alone has these colours: strong greens and yellows.
  const path = () =>
    page.evaluate(async () => {
      const picture = new Image();
      picture.src = window.stead.picture();
      await picture.decode();
      const g = Object.assign(document.createElement('canvas'), { width: picture.width, height: picture.height }).getContext('2d');
      g.drawImage(picture, 0, 0);
      const { data } = g.getImageData(0, 0, picture.width, picture.height);
      let count = 0;
      for (let k = 0; k < data.length; k += 4) count += data[k + 1] > 1.25 * data[k + 2] && data[k + 1] > 1.15 * data[k] ? 1 : 0;
      return count;
    });
  for (const name of ['curtain', 'ghost', 'around', 'cell', 'reach']) await page.locator(`[data-layer=${name}]`).click();
  await page.locator('[data-view=tool]').click();
  // From below, where the part is between the eye and the path.
  await page.locator('.view').focus();
  for (let k = 0; k < 5; k++) await page.keyboard.press('ArrowDown');
  const clear = await path();
  await box.focus();
  await page.keyboard.press('Space');
  const solid = await path();
  assert.ok(clear > 1.5 * solid && clear > 500, `${clear} pixels of the path with it, ${solid} without`);
  await page.keyboard.press('Space');
  assert.equal(await path(), clear);
  return `${clear} pixels of the path, ${solid} through a solid part`;
});

await check('a leaning plan says lead, tilt and force at its points, and its bounds in words', 'leaning-tool', async (page, place) => {
  const rows = table(join(place, PLANS[0]));
  for (const point of [0, 17, 40]) {
    await page.evaluate((t) => window.stead.set({ t }, true), point);
    const row = rows[point];
    assert.equal(await page.locator('#lean').textContent(), `lead ${(+row.lead_deg).toFixed(1)}°, tilt ${(+row.tilt_deg).toFixed(1)}°`);
    const said = await page.locator('#lean-more').textContent();
    const [, size, ...parts] = said.match(/^force (\S+) N: (\S+) along the feed, (\S+) to its left, (\S+) along the axis of the path$/);
    const force = Math.hypot(row.force_x_n, row.force_y_n, row.force_z_n);
    assert.ok(Math.abs(size - force) < 0.6 && Math.abs(Math.hypot(...parts) - force) < 1.5, `${said}: ${force}`);
  }
  const { cases } = JSON.parse(readFileSync(join(place, 'summary.json'), 'utf8'));
  const keys = cases.flatMap((one) => one.active_bounds ?? []).map(({ bound }) => bound);
  assert.ok(keys.some((key) => key.startsWith('lean.')), `${keys}`);
  const said = [await page.locator('#short').textContent(), await page.locator('section[aria-label="What holds the placements"]').textContent()];
  for (const key of keys.filter((key) => /_(mm|deg|condition)/.test(key))) assert.ok(said.every((text) => !text.includes(key)), `${key} in ${said}`);
  assert.match(said[1], /limit: (lead|tilt|lean) of the tool/);
});

// Fences that are drawn as solid walls must fail.
{
  const html = readFileSync(join(folder('collision'), 'report.html'), 'utf8');
  const file = join(mkdtempSync(join(tmpdir(), 'stead-solid-')), 'report.html');
  writeFileSync(file, withScript(html, (script) => script.replace('paint(MODE.lit, [1, 1, 1], PANE)', 'paint(MODE.lit, [1, 1, 1], 1)')));
  const { page, close } = await open(browser, pathToFileURL(file).href);
  const solid = (await orange(page)).count;
  await page.locator('[data-layer=around]').click();
  const bare = (await orange(page)).count;
  const isHidden = solid < 0.7 * bare;
  console.log(`${isHidden ? 'ok   ' : 'FAIL '} collision: behind solid walls ${((100 * solid) / bare).toFixed(0)} % of the robot is left, which the test above refuses`);
  failures += isHidden ? 0 : 1;
  await close();
  rmSync(dirname(file), { recursive: true });
}

/** In every plan the tool by the arm is where the path by the workpiece is, and both where the table says, seen from the robot's carriage. */
async function meets(page, place) {
  let farthest = 0;
  for (const [number, name] of PLANS.entries()) {
    const rows = table(join(place, name));
    const found = await page.evaluate((number) => window.stead.meets(number), number);
    rows.forEach((row, k) => {
      const { tool, path, carriage } = found[k];
      const [x, y, z] = [0, 4, 8].map((j) => carriage[j / 4] * row.x_mm + carriage[4 + j / 4] * row.y_mm + carriage[8 + j / 4] * row.z_mm + carriage[12 + j / 4]);
      farthest = Math.max(farthest, Math.hypot(tool[0] - x, tool[1] - y, tool[2] - z), Math.hypot(path[0] - x, path[1] - y, path[2] - z));
    });
  }
  assert.ok(farthest < 0.01, `${farthest} mm off`);
  return `${farthest.toFixed(4)} mm at most`;
}

/** What is fixed to an axis is where the axis, moved by those before it, has turned or pushed it: by the formula of Rodrigues, here again. */
async function axesCarry(page, place) {
  const { external_axes: axes } = JSON.parse(readFileSync(join(place, 'page-data.json'), 'utf8'));
  const rows = table(join(place, PLANS[0]));
  const found = await page.evaluate(() => window.stead.meets(0));
  const move = ({ kind, direction: d, point_mm: c }, at, p) => {
    if (kind === 'rail') return p.map((v, k) => v + d[k] * at);
    const [angle, r] = [(at * Math.PI) / 180, p.map((v, k) => v - c[k])];
    const along = r[0] * d[0] + r[1] * d[1] + r[2] * d[2];
    const side = [d[1] * r[2] - d[2] * r[1], d[2] * r[0] - d[0] * r[2], d[0] * r[1] - d[1] * r[0]];
    return p.map((_, k) => c[k] + r[k] * Math.cos(angle) + side[k] * Math.sin(angle) + d[k] * along * (1 - Math.cos(angle)));
  };
  for (const [i, row] of rows.entries()) {
    axes.forEach((axis, k) => {
      const corner = [1234, -321, 777];
      const before = axes.slice(0, k + 1).filter((other) => other.carries === axis.carries);
      const due = before.reduceRight((p, other) => move(other, +row[other.column], p), corner);
      const m = found[i].axes[k];
      const is = [0, 1, 2].map((j) => m[j] * corner[0] + m[4 + j] * corner[1] + m[8 + j] * corner[2] + m[12 + j]);
      const off = Math.hypot(...is.map((v, j) => v - due[j]));
      assert.ok(off < 0.01, `what ${axis.name} carries is ${off} mm off at point ${i}`);
    });
  }
  return axes.length;
}

/** Every move between segments is drawn along its way of `summary.json`: out and in with the tool centre on a straight line, else straight in the joints. */
await check('moves between segments are drawn as planned', 'collision', async (page, place) => {
  const { cases } = JSON.parse(readFileSync(join(place, 'summary.json'), 'utf8'));
  let [farthest, straight, count] = [0, 0, 0];
  for (const [number, { transfers }] of cases.entries()) {
    const segments = table(join(place, PLANS[number])).map((row) => +row.segment);
    for (const move of transfers) {
      const end = segments.lastIndexOf(move.after_segment);
      const ways = move.joints_deg;
      const [drawn, tips] = await page.evaluate(
        ([number, end, ways]) => {
          const { cases, jointsAt, framesOf } = window.stead;
          const drawn = Array.from({ length: 1999 }, (_, k) => jointsAt(cases[number], end + (k + 1) / 2000));
          const tip = (joints) => framesOf(joints)[7].slice(12, 15);
          return [drawn.map((joints) => [joints, tip(joints)]), ways.map(tip)];
        },
        [number, end, ways],
      );
      /** How far a place is from the line between two others. */
      const beside = (at, from, to) => {
        const [line, off] = [to.map((v, k) => v - from[k]), at.map((v, k) => v - from[k])];
        const [along, long] = [line.reduce((sum, v, k) => sum + v * off[k], 0), Math.hypot(...line) ** 2];
        const share = Math.min(1, Math.max(0, along / (long || 1)));
        return Math.hypot(...off.map((v, k) => v - share * line[k]));
      };
      for (const [joints, tip] of drawn) {
        const offs = ways.slice(1).map((to, k) => {
          const isLine = (k === 0 && move.retracts) || (k + 2 === ways.length && move.approaches);
          return isLine ? beside(tip, tips[k], tips[k + 1]) : beside(joints, ways[k], to);
        });
        farthest = Math.max(farthest, Math.min(...offs));
        straight = Math.max(straight, beside(joints, ways[0], ways.at(-1)));
      }
      // It passes all places of the way.
      for (const joints of ways) {
        const near = Math.min(...drawn.map(([at]) => Math.max(...at.map((v, k) => Math.abs(v - joints[k])))));
        assert.ok(near < 0.5, `case ${number + 1}, move ${move.after_segment}: ${near} deg off a place of its way`);
      }
      count++;
    }
  }
  assert.ok(farthest < 0.05, `${farthest} deg or mm off the way`);
  assert.ok(straight > 1, 'all ways are straight: nothing is tested');
  return `${count} moves, ${farthest.toFixed(3)} deg or mm off at most`;
});

for (const run of ['tilting-table', 'rail-panel', 'wall-raster']) {
  await check('tool, path and tables meet at every point', run, async (page, place) => {
    const said = await meets(page, place);
    assert.equal(await axesCarry(page, place), { 'tilting-table': 2, 'rail-panel': 1, 'wall-raster': 0 }[run]);
    const rows = table(join(place, PLANS[0]));
    for (const [k, column] of ['e1_deg', 'e1_mm', 'e2_deg'].filter((name) => name in rows[0]).entries()) {
      await page.evaluate((t) => window.stead.set({ t }, true), rows.length - 1);
      const shown = await page.locator(`#axis-${k + 1}`).textContent();
      assert.ok(Math.abs(parseFloat(shown) - rows.at(-1)[column]) < 0.051, `${column}: ${shown}`);
    }
    // The table of cases has where the axes stand.
    const { external_axes: axes } = JSON.parse(readFileSync(join(place, 'page-data.json'), 'utf8'));
    const heads = await page.locator('#cases thead th').allTextContents();
    for (const [number, name] of PLANS.entries()) {
      const cells = await page.locator(`#cases tbody tr:nth-child(${number + 1}) td`).allTextContents();
      for (const axis of axes) {
        const cell = cells[heads.indexOf(`${axis.name} ${axis.kind === 'rail' ? 'mm' : 'deg'}`)];
        const positions = table(join(place, name)).map((row) => +row[axis.column]);
        const ends = [Math.min(...positions), Math.max(...positions)];
        const told = cell.split(' … ').map((text) => parseFloat(text.replace('−', '-')));
        assert.ok(Math.abs(told[0] - ends[0]) < 0.051 && Math.abs(told.at(-1) - ends[1]) < 0.051, `${axis.name}: ${cell}`);
      }
    }
    return said;
  });
}

await browser.close();
if (!kept) rmSync(scratch, { recursive: true });
console.log(failures ? `${failures} failed` : 'all passed');
process.exit(failures ? 1 : 0);
