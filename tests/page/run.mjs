// The page in Debian's Chromium: the suite on the shipped page, on one without WebGL, with names that look like markup, in several widths;
// and on three pages broken on purpose, which must fail.
//
// With ONLY in the environment the suite runs the tests alone whose names contain it. Of a broken page the test that is about it is run; with
// STEAD_TESTS=all also those before it.
//
//   node run.mjs [FOLDER [OTHER ..]]     FOLDER has report.html; the others further plans of the same arm and spindle
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join, resolve } from 'node:path';
import { fileURLToPath, pathToFileURL } from 'node:url';
import assert from 'node:assert/strict';
import { inShort, launch, withScript } from './browser.mjs';
import { violations } from './axe.mjs';
import { open, tests } from './suite.mjs';

const results = fileURLToPath(new URL('../../results/', import.meta.url));
const [folder = join(results, 'caro-2013'), ...others] = process.argv.slice(2).map((name) => resolve(name));
if (!process.argv[2]) others.push(join(results, 'caro-2013-k1-0.8'));
const file = join(folder, 'report.html');
const browser = await launch();
const scratch = mkdtempSync(join(tmpdir(), 'stead-page-'));
const html = readFileSync(file, 'utf8');
let failures = 0;

/** The suite on a page, the tests whose names contain `only`; returns what failed. With `firstOnly` it stops there. */
async function suite(address, { firstOnly = false, only = process.env.ONLY ?? '' } = {}) {
  const failed = [];
  const { page, seen, close } = await open(browser, address);
  for (const [name, test] of Object.entries(tests(folder, others))) {
    if (!name.includes(only)) continue;
    const begun = Date.now();
    try {
      const said = await test(page);
      if (!firstOnly)
        console.log(`ok    ${name} (${((Date.now() - begun) / 1000).toFixed(1)} s)${said ? `: ${said}` : ''}`);
    } catch (error) {
      failed.push(`${name}: ${inShort(error)}`);
      if (firstOnly) break;
      console.log(`FAIL  ${failed.at(-1)}`);
    }
  }
  if (seen.requests.length) failed.push(`asks the network for ${seen.requests}`);
  if (seen.complaints.length) failed.push(`complains: ${seen.complaints}`);
  await close();
  return failed;
}

/** One more check on its own page. */
async function check(name, options, address, test) {
  try {
    const opened = await open(browser, address, options);
    await test(opened.page);
    assert.deepEqual(opened.seen, { requests: [], complaints: [] });
    await opened.close();
    console.log(`ok    ${name}`);
  } catch (error) {
    failures++;
    console.log(`FAIL  ${name}: ${inShort(error)}`);
  }
}

function saved(name, text) {
  const path = join(scratch, name);
  writeFileSync(path, text);
  return pathToFileURL(path).href;
}

const address = pathToFileURL(file).href;
const found = await suite(address);
failures += found.length;
found.filter((one) => !/^[^:]+: /.test(one)).forEach((one) => console.log(`FAIL  ${one}`));

await check(
  'without WebGL it says so and the rest works',
  {
    before: () => {
      const original = HTMLCanvasElement.prototype.getContext;
      HTMLCanvasElement.prototype.getContext = function (kind, ...rest) {
        return kind === 'webgl2' ? null : original.call(this, kind, ...rest);
      };
    },
  },
  address,
  async (page) => {
    assert.match(await page.locator('.view').textContent(), /no WebGL2/);
    await page.keyboard.press('End');
    await page.waitForFunction(() => document.getElementById('now').textContent.startsWith('point 104 '));
    assert.equal(await page.locator('#cases tbody tr').count(), 4);
  },
);

const evil = '<script>window.owned = 1</script><img src=x onerror="window.owned = 1">';
const data = JSON.parse(html.match(/id="data">([^]*?)<\/script>/)[1]);
data.robot.name = evil;
data.inputs.forEach((input) => (input.name = evil));
data.document.notes = [evil];
data.document.warnings = [evil];
data.document.summary = [{ about: evil, text: evil }];
const named = html.replace(
  /id="data">[^]*?<\/script>/,
  () => `id="data">${JSON.stringify(data).replaceAll('<', '\\u003c')}</script>`,
);
await check('names that look like markup are text', {}, saved('names.html', named), async (page) => {
  assert.ok((await page.locator('h1').textContent()).includes(evil));
  assert.ok((await page.locator('#messages').textContent()).includes(evil));
  assert.equal(await page.locator('#short').textContent(), evil + evil);
  assert.deepEqual(
    await page.evaluate(() => [window.owned, document.scripts.length, document.querySelectorAll('img').length]),
    [undefined, 2, 0],
  );
});

for (const width of [380, 800, 1024, 2200]) {
  await check(
    `nothing is wider than a window of ${width}`,
    { width, height: 900, scheme: 'dark' },
    address,
    async (page) => {
      const [is, may] = await page.evaluate(() => [document.scrollingElement.scrollWidth, innerWidth]);
      assert.ok(is <= may, `${is} pixels in ${may}`);
    },
  );
}

await check('the table of cases fits in a window of 1400', { width: 1400, height: 900 }, address, async (page) => {
  const [is, may] = await page.evaluate(() => {
    const card = document.getElementById('cases').parentElement;
    return [card.scrollWidth, card.clientWidth];
  });
  assert.ok(is <= may, `${is} pixels in ${may}`);
});

await check('the play bar is in a low window', { width: 1280, height: 720 }, address, async (page) => {
  const { y, height } = await page.locator('#play').boundingBox();
  assert.ok(y > 0 && y + height <= 720, `${y}`);
  // It covers nothing of the view, at first and where the view is scrolled to.
  for (const block of ['', 'end']) {
    if (block) await page.locator('.view').evaluate((view, block) => view.scrollIntoView({ block }), block);
    const [bar, view] = [await page.locator('.bar').boundingBox(), await page.locator('.view').boundingBox()];
    assert.ok(bar.y + bar.height <= view.y || view.y + view.height <= bar.y, `bar ${bar.y} to ${bar.y + bar.height}, view from ${view.y}`);
    assert.ok(bar.y >= 0 && view.y + view.height <= 720, `view ${view.y} to ${view.y + view.height}`);
  }
});

await check('a finger that goes up scrolls the page', { width: 390, height: 844, touch: true }, address, async (page) => {
  // A finger drawn up over the view and over the map moves the page, and the robot and the state stay.
  const client = await page.context().newCDPSession(page);
  const touch = (type, ...touchPoints) => client.send('Input.dispatchTouchEvent', { type, touchPoints });
  for (const what of ['.view', '#map']) {
    await page.locator(what).evaluate((one) => one.scrollIntoView({ block: 'center' }));
    const box = await page.locator(what).boundingBox();
    const before = await page.evaluate(() => scrollY);
    const [x, y] = [box.x + box.width / 2, box.y + box.height / 2];
    await touch('touchStart', { x, y });
    for (let k = 1; k <= 12; k++) await touch('touchMove', { x, y: y - 15 * k });
    await touch('touchEnd');
    await page.waitForFunction((before) => scrollY > before + 100, before, { timeout: 5000 });
  }
  const actions = await page.evaluate(() =>
    [...document.querySelectorAll('.view > canvas, #map canvas')].map((one) => getComputedStyle(one).touchAction),
  );
  assert.ok(actions.includes('pan-y') && !actions.includes('none'), String(actions));
});

for (const options of [{ width: 1400 }, { width: 1400, scheme: 'dark' }, { width: 390, touch: true }]) {
  await check(`axe-core finds nothing, ${JSON.stringify(options)}`, options, address, async (page) => {
    await page.locator('#setup summary').click();
    assert.deepEqual(await violations(page), []);
    await page.evaluate(() => {
      const { codes, betaCount, points } = window.stead.maps[0];
      const row = codes.findIndex((code) => code >= 16);
      window.stead.set({ t: points[Math.floor(row / betaCount)], chosen: { column: Math.floor(row / betaCount), beta: row % betaCount } }, true);
    });
    assert.deepEqual(await violations(page), []);
    // It would find something.
    await page.locator('#play').evaluate((button) => {
      button.removeAttribute('aria-label');
      button.textContent = '';
    });
    assert.match((await violations(page)).join(), /button-name/);
  });
}

await check('a page of 105 points is small', {}, address, async (page) => {
  assert.equal(await page.evaluate(() => window.stead.cases[0].joints.length), 105);
  assert.ok(html.length < 600_000, `${html.length} characters`);
});

await check('printed it is two pages', {}, address, async (page) => {
  const pdf = (await page.pdf({ preferCSSPageSize: true })).toString('latin1');
  assert.equal(pdf.match(/\/Type\s*\/Page[^s]/g).length, 2);
});

// Each part broken, with the test that is about it: that one must fail, and with all tests none before it.
const broken = [
  {
    part: 'robot',
    test: 'the slider moves robot and figures',
    change: (script) => script.replace('framesOf(currentJoints(), base)', 'framesOf(CASES[0].joints[0], base)'),
  },
  {
    part: 'map',
    test: 'any state of the map can be chosen',
    change: (script) => script.replace('plot.placeX(x) + 0.5', '0.9 * plot.placeX(x) + 0.5'),
  },
  {
    part: 'play button',
    test: 'play runs in real time and stops',
    change: (script) => script.replace('onclick: playOrPause', 'onclick: pause'),
  },
];
for (const { part, test, change } of broken) {
  const only = process.env.STEAD_TESTS === 'all' ? '' : test;
  const [first] = await suite(saved(`${part}.html`, withScript(html, change)), { firstOnly: true, only });
  const isOwn = first?.startsWith(`${test}: `);
  console.log(`${isOwn ? 'ok   ' : 'FAIL '} with the ${part} broken its own test fails first: ${first ?? 'nothing fails'}`);
  failures += isOwn ? 0 : 1;
}

await browser.close();
rmSync(scratch, { recursive: true });
console.log(failures ? `${failures} failed` : 'all passed');
process.exit(failures ? 1 : 0);
