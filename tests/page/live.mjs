// The live page in Debian's Chromium: what a user does with the part, and what the page shows of it.
//
// With ONLY in the environment the tests alone run whose names contain it.
//
//   STEAD=target/debug/stead node live.mjs
import { spawn } from 'node:child_process';
import { mkdtempSync, readFileSync, readdirSync, rmSync } from 'node:fs';
import { createRequire } from 'node:module';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { fileURLToPath } from 'node:url';
import assert from 'node:assert/strict';
import { inShort, launch } from './browser.mjs';

const root = fileURLToPath(new URL('../../', import.meta.url));
const stead = process.env.STEAD ?? join(root, 'target/debug/stead');
const axe = readFileSync(createRequire(import.meta.url).resolve('axe-core/axe.min.js'), 'utf8');

/** A session in a folder of its own; its address is the first line that it says. */
export function startLive(run, more = []) {
  const folder = mkdtempSync(join(tmpdir(), 'stead-live-'));
  const child = spawn(stead, ['live', run, '--no-open', '--out', join(folder, 'out'), ...more], { cwd: root, stdio: ['ignore', 'pipe', 'pipe'] });
  let said = '';
  child.stderr.on('data', (text) => (said += text));
  const address = new Promise((done, failed) => {
    let text = '';
    child.stdout.on('data', (more) => {
      text += more;
      const line = text.split('\n')[0];
      if (text.includes('\n')) done(line);
    });
    child.on('exit', (code) => failed(new Error(`stead live ended with ${code}: ${said}`)));
  });
  const end = () =>
    new Promise((done) => {
      if (child.exitCode !== null || child.signalCode !== null) return done(child.exitCode);
      child.on('exit', done);
      child.kill('SIGINT');
    });
  const close = async () => {
    await end();
    rmSync(folder, { recursive: true, force: true });
  };
  return { child, folder, address, end, close };
}

/** Opens the page of a session; what it complains of is collected. */
export async function openLive(browser, address, { width = 1400, height = 1000, touch = false } = {}) {
  const context = await browser.newContext({ viewport: { width, height }, hasTouch: touch });
  const page = await context.newPage();
  const seen = { requests: [], complaints: [], questions: [] };
  page.on('dialog', (dialog) => (seen.questions.push(dialog.message()), dialog.accept()));
  page.on('request', (request) => !request.url().startsWith(new URL(address).origin) && seen.requests.push(request.url()));
  page.on('console', (message) => message.type() === 'error' && seen.complaints.push(message.text()));
  page.on('pageerror', (error) => seen.complaints.push(String(error)));
  page.setDefaultTimeout(120000);
  await page.goto(address);
  await page.waitForFunction(() => window.stead?.first > 0, null, { timeout: 120000 });
  return { page, seen, close: () => context.close() };
}

const text = (page, id) => page.locator(`#${id}`).textContent();
/** Waits until the part is at rest and all of it is known. */
export const atRest = (page) =>
  page.waitForFunction(() => window.stead.shown.isWhole && !window.stead.shown.isFollowing, null, { timeout: 120000 });
const fill = async (page, field, value) => {
  await page.locator(`#field-${field}`).fill(String(value));
  await page.locator(`#field-${field}`).blur();
};
const go = (page, to) => page.evaluate((to) => window.stead.goTo({ ...window.stead.place, ...to }), to);
const BEST = { x_mm: 0.0284, y_mm: -1640, z_mm: -214, yaw_deg: 78.9664 };

/** Where the middle of the path is seen. */
export const partAt = (page) =>
  page.evaluate(() => {
    const box = document.querySelector('.view canvas').getBoundingClientRect();
    // Where the pointer says that it can take the part.
    for (let k = 0; k < 60; k++)
      for (let j = 0; j < 60; j++) {
        const [x, y] = [box.x + (box.width * (j + 0.5)) / 60, box.y + (box.height * (k + 0.5)) / 60];
        const canvas = document.elementFromPoint(x, y);
        if (canvas?.tagName !== 'CANVAS') continue;
        canvas.dispatchEvent(new PointerEvent('pointermove', { clientX: x, clientY: y, bubbles: true, pointerType: 'mouse' }));
        if (canvas.style.cursor === 'move') return [x, y];
      }
    return null;
  });

const tests = {
  'the figures are those of the command': async (page) => {
    await go(page, BEST);
    await atRest(page);
    assert.match(await text(page, 'live-mean'), /^0\.107\d mm$/);
    assert.match(await text(page, 'live-state'), /^as 'stead score' states it$/);
    assert.match(await text(page, 'live-feed'), /^\d+ mm\/s$/);
  },

  'what is typed moves the part and is undone': async (page) => {
    await go(page, BEST);
    await atRest(page);
    const before = await text(page, 'live-mean');
    await fill(page, 'z_mm', -300);
    await atRest(page);
    assert.notEqual(await text(page, 'live-mean'), before);
    assert.equal(await page.evaluate(() => window.stead.cases[0].at.z), -300);
    await page.keyboard.press('Control+z');
    await atRest(page);
    assert.equal(await text(page, 'live-mean'), before);
    await page.keyboard.press('Control+y');
    await atRest(page);
    assert.equal(await page.locator('#field-z_mm').inputValue(), '-300');
    // A number that is none moves nothing.
    await page.locator('#field-z_mm').fill('');
    assert.equal(await page.locator('#field-z_mm').getAttribute('aria-invalid'), 'true');
    await page.locator('#field-z_mm').blur();
    assert.equal(await page.locator('#field-z_mm').inputValue(), '-300');
  },

  'keys move the part': async (page) => {
    await go(page, BEST);
    await page.locator('#part').focus();
    for (const key of ['ArrowRight', 'Shift+ArrowUp', 'PageDown', ']']) await page.keyboard.press(key);
    const at = await page.evaluate(() => window.stead.place);
    assert.deepEqual([at.x_mm, at.y_mm, at.z_mm].map((mm) => +mm.toFixed(4)), [1.0284, -1630, -215]);
    assert.equal(+at.yaw_deg.toFixed(4), 78.4664);
  },

  'the part is dragged, lifted and turned': async (page) => {
    await page.evaluate(() => scrollTo(0, 0));
    await go(page, { ...BEST, y_mm: -1800, z_mm: -400 });
    await atRest(page);
    const drag = async (key) => {
      const from = await partAt(page);
      assert.ok(from, 'the part is not seen');
      const before = await page.evaluate(() => ({ ...window.stead.place }));
      await page.mouse.move(...from);
      if (key) await page.keyboard.down(key);
      await page.mouse.down();
      await page.mouse.move(from[0] + 25, from[1] + 14, { steps: 5 });
      await page.mouse.up();
      if (key) await page.keyboard.up(key);
      const after = await page.evaluate(() => ({ ...window.stead.place }));
      return ['x_mm', 'y_mm', 'z_mm', 'yaw_deg'].map((field) => Math.abs(after[field] - before[field]) > 1e-6);
    };
    assert.deepEqual(await drag(), [true, true, false, false]);
    assert.deepEqual(await drag('Shift'), [false, false, true, false]);
    assert.deepEqual(await drag('Alt'), [false, false, false, true]);
    await atRest(page);
    await page.locator('#undo').click();
    assert.equal(await page.locator('#redo').isDisabled(), false);
  },

  'one request at a time follows the part, the newest next, and charts and map are drawn at rest': async (page) => {
    await go(page, BEST);
    await atRest(page);
    const from = await partAt(page);
    // All of it is drawn, the view in its best quality.
    await page.waitForFunction(() => {
      const canvas = document.querySelector('.view canvas');
      return canvas.width > 1.9 * canvas.clientWidth;
    });
    // The map, which comes column by column, too: nothing more is drawn for half a second.
    await page.waitForFunction(() => {
      const { stead, settled = {} } = window;
      if (settled.beyond !== stead.steps.beyond) window.settled = { beyond: stead.steps.beyond, since: performance.now() };
      return performance.now() - window.settled.since > 500;
    });
    await page.evaluate(() => {
      const ask = window.fetch;
      window.asked = { now: 0, most: 0, places: [], ask };
      window.fetch = async (path, options) => {
        const { asked } = window;
        if (path !== '/preview') return ask(path, options);
        asked.places.push(JSON.parse(options.body));
        asked.most = Math.max(asked.most, ++asked.now);
        await new Promise((done) => setTimeout(done, 80));
        const answer = await ask(path, options);
        asked.now--;
        return answer;
      };
    });
    await page.mouse.move(...from);
    await page.mouse.down();
    const before = await page.evaluate(() => ({ ...window.stead.steps }));
    // So little that there is a plan all along: with its reasons the cards beside the view would grow.
    for (let k = 1; k <= 30; k++) await page.mouse.move(from[0] + k / 15, from[1] + k / 30);
    // The part is drawn where it is.
    await page.waitForFunction((count) => {
      const { asked, stead } = window;
      return asked.places.length > 2 && stead.shown.answer.id === asked.places.at(-1).id && stead.steps.count > count;
    }, before.count);
    const held = await page.evaluate(() => ({ ...window.stead.steps, asked: window.asked, canvas: document.querySelector('.view canvas').width }));
    assert.equal(held.beyond, before.beyond, 'more is drawn than the part');
    assert.equal(held.asked.most, 1);
    assert.ok(held.asked.places.length < 30, `${held.asked.places.length} requests`);
    await page.mouse.up();
    await atRest(page);
    const rest = await page.evaluate(() => ({ ...window.stead.steps, place: window.stead.place, answer: window.stead.shown.answer.place, at: window.stead.cases[0].at }));
    assert.ok(rest.beyond > held.beyond, 'charts and map are not drawn at rest');
    for (const [field, short] of [['x_mm', 'x'], ['y_mm', 'y'], ['z_mm', 'z']]) {
      assert.ok(Math.abs(rest.answer.placement_exact[field] - rest.place[field]) < 1e-6, field);
      assert.equal(rest.at[short], rest.place[field]);
    }
    await page.waitForFunction((width) => document.querySelector('.view canvas').width > width, held.canvas);
    await page.evaluate(() => (window.fetch = window.asked.ask));
  },

  'beside the part the view is turned and the part stays': async (page) => {
    const before = await page.evaluate(() => JSON.stringify(window.stead.place));
    const box = await page.locator('.view').boundingBox();
    await page.mouse.move(box.x + 20, box.y + box.height - 120);
    await page.mouse.down();
    await page.mouse.move(box.x + 80, box.y + box.height - 140, { steps: 3 });
    await page.mouse.up();
    assert.equal(await page.evaluate(() => JSON.stringify(window.stead.place)), before);
  },

  'a placement without a plan names its limits': async (page) => {
    await go(page, { ...BEST, y_mm: -3900 });
    await page.locator('#live-blocked').waitFor({ state: 'visible' });
    await atRest(page);
    assert.match(await text(page, 'live-blocked'), /beyond the stretched arm/);
    assert.match(await text(page, 'live-blocked'), /outside the cell of the run file: y by 1660 mm beyond -2240/);
    assert.match(await text(page, 'concerns'), /outside the cell/);
    assert.equal(await page.locator('.view').getAttribute('data-level'), 'bad');
    assert.equal(await text(page, 'live-mean'), '–');
    await go(page, BEST);
    await atRest(page);
    assert.equal(await page.locator('#live-blocked').isVisible(), false);
  },

  'the map is filled column by column and any state can be chosen': async (page) => {
    await go(page, BEST);
    await page.waitForFunction(() => {
      const map = window.stead.maps[0];
      return map?.reasons.length && !map.reasons.includes('not known yet');
    });
    await page.locator('#map').focus();
    await page.keyboard.press('ArrowRight');
    await page.waitForFunction(() => /^point \d+, β /.test(document.getElementById('map-reading').textContent));
    await page.keyboard.press('Escape');
  },

  'placements are pinned and compared, and a search is stopped': async (page, session, seen) => {
    await go(page, BEST);
    await atRest(page);
    assert.match(await text(page, 'concerns'), /not checked: collisions/);
    assert.equal(await page.locator('.view').getAttribute('data-level'), 'doubt');
    await page.locator('#label').fill('the best');
    await page.locator('#keep').click();
    await page.locator('#pins tr').first().waitFor();
    assert.match(await page.locator('#pins').textContent(), /placement-1 · the best/);
    assert.match(seen.questions.pop(), /^Pin this placement all the same\?\n- not checked: collisions/);
    await page.waitForFunction(() => window.stead.cases.length === 4);
    await go(page, { ...BEST, z_mm: -300 });
    await atRest(page);
    const cells = await page.locator('#comparison tbody tr').first().locator('td').allTextContents();
    const [a, b, by] = cells.map(parseFloat);
    assert.ok(Math.abs(b - a - by) < 2e-4, cells.join());
    await page.locator('#search-cell').click();
    await page.locator('#job').waitFor({ state: 'visible' });
    // By the keyboard: a click waits for two pictures that are the same, and there may be few while the machine is busy.
    await page.locator('#stop').press('Enter');
    await page.locator('#pins tr').nth(1).waitFor();
    assert.match(await text(page, 'log'), /search the cell, stopped: /);
    const files = readdirSync(join(session.folder, 'out', 'placement-2'));
    assert.ok(files.includes('setup.svg') && files.includes('score.json'), String(files));
  },

  'values are changed with the checks of the file': async (page) => {
    await page.locator('#edit-cell-x_mm').fill('[300, -300]');
    await page.locator('#edit-apply').click();
    await page.locator('#edit-wrong').waitFor({ state: 'visible' });
    assert.match(await text(page, 'edit-wrong'), /cell\.x_mm/);
    await page.locator('#edit-cell-x_mm').fill('[-200, 200]');
    await Promise.all([page.waitForEvent('load'), page.locator('#edit-apply').click()]);
    await page.waitForFunction(() => window.stead?.first > 0);
    assert.equal(await page.locator('#edit-cell-x_mm').inputValue(), '[-200, 200]');
    assert.match(await page.locator('#log').textContent(), /the values of the run were changed: cell\.x_mm=\[-200, 200\]/);
    await page.locator('#edit-cell-z_mm').fill('[-600, -214]');
    await Promise.all([page.waitForEvent('load'), page.locator('#edit-apply').click()]);
    await page.waitForFunction(() => window.stead?.first > 0);
    // A field that is empty has the value of the file.
    await page.locator('#edit-cell-x_mm').fill('');
    await Promise.all([page.waitForEvent('load'), page.locator('#edit-apply').click()]);
    await page.waitForFunction(() => window.stead?.first > 0);
    const values = () => Promise.all(['x', 'z'].map((axis) => page.locator(`#edit-cell-${axis}_mm`).inputValue()));
    assert.deepEqual(await values(), ['[-300, 300]', '[-600, -214]']);
    await Promise.all([page.waitForEvent('load'), page.locator('#edit-reset').click()]);
    await page.waitForFunction(() => window.stead?.first > 0);
    assert.deepEqual(await values(), ['[-300, 300]', '[-602, -214]']);
    await page.locator('#save-name').fill('caro-2013');
    await page.locator('#save').click();
    await page.locator('#log .wrong').first().waitFor();
    assert.match(await page.locator('#log .wrong').first().textContent(), /is there already/);
  },

  'axe finds no violation': async (page) => {
    await go(page, BEST);
    await atRest(page);
    // A script of the page's policy is not: it is run by the browser itself.
    await page.evaluate(axe);
    for (const scheme of ['light', 'dark']) {
      await page.emulateMedia({ colorScheme: scheme });
      const found = await page.evaluate(() => window.axe.run(document, { resultTypes: ['violations'] }));
      const said = found.violations.map((one) => `${one.id}: ${one.nodes.map((node) => node.html.slice(0, 120)).join(' | ')}`);
      assert.deepEqual(said, [], scheme);
    }
  },
};

const isMain = process.argv[1] === fileURLToPath(import.meta.url);
if (isMain) {
  const browser = await launch();
  let failures = 0;
  const checked = async (name, test) => {
    if (process.env.ONLY && !name.includes(process.env.ONLY)) return;
    const begun = Date.now();
    try {
      await test();
      console.log(`ok    ${name} (${((Date.now() - begun) / 1000).toFixed(1)} s)`);
    } catch (error) {
      failures++;
      console.log(`FAIL  ${name}: ${inShort(error)}`);
    }
  };
  const session = startLive('configs/caro-2013.toml');
  const address = await session.address;
  const { page, seen, close } = await openLive(browser, address);
  for (const [name, test] of Object.entries(tests)) await checked(name, () => test(page, session, seen));
  await checked('nothing is asked of other hosts, and only refusals are complained of', async () => {
    assert.deepEqual(seen.requests, []);
    assert.deepEqual(seen.complaints.filter((one) => !/status of 400/.test(one)), []);
  });

  await checked('two tabs have parts of their own and the same pins', async () => {
    const other = await openLive(browser, address);
    await go(other.page, { ...BEST, z_mm: -350 });
    await go(page, BEST);
    await Promise.all([atRest(other.page), atRest(page)]);
    assert.match(await text(page, 'live-mean'), /^0\.107\d mm$/);
    assert.notEqual(await text(other.page, 'live-mean'), await text(page, 'live-mean'));
    const count = await page.locator('#pins tr').count();
    await other.page.locator('#keep').click();
    await page.locator('#pins tr').nth(count).waitFor();
    // Values that are changed in one leave part, steps back and comparison of the other.
    await page.locator('#side-a').selectOption('placement-1');
    await other.page.locator('#edit-cell-x_mm').fill('[-250, 250]');
    await Promise.all([page.waitForEvent('load'), other.page.locator('#edit-apply').click()]);
    await page.waitForFunction(() => window.stead?.first > 0);
    await atRest(page);
    assert.match(await page.locator('#log li').first().textContent(), /values of the run were changed: cell\.x_mm=\[-250, 250\]/);
    assert.equal(await page.evaluate(() => window.stead.place.z_mm), BEST.z_mm);
    assert.equal(await page.locator('#side-a').inputValue(), 'placement-1');
    assert.equal(await page.locator('#undo').isEnabled(), true);
    await other.page.waitForFunction(() => window.stead?.first > 0);
    assert.equal(await other.page.evaluate(() => window.stead.place.z_mm), -350);
    await other.close();
  });

  await checked('a page without the token is refused', async () => {
    const context = await browser.newContext();
    const stranger = await context.newPage();
    const origin = new URL(address).origin;
    for (const path of ['/', '/?token=0', '/state']) assert.equal((await stranger.goto(origin + path)).status(), 403);
    await context.close();
  });

  await checked('nothing is wider than the window of a phone', async () => {
    const phone = await openLive(browser, address, { width: 390, height: 844, touch: true });
    await atRest(phone.page);
    const [is, may] = await phone.page.evaluate(() => [document.scrollingElement.scrollWidth, innerWidth]);
    assert.ok(is <= may, `${is} pixels in ${may}`);
    await phone.close();
  });

  await checked('a finger on the part moves it, and one elsewhere scrolls', async () => {
    const phone = await openLive(browser, address, { width: 390, height: 844, touch: true });
    await go(phone.page, { ...BEST, y_mm: -1800, z_mm: -400 });
    await atRest(phone.page);
    const client = await phone.page.context().newCDPSession(phone.page);
    const swipe = async (x, y) => {
      const touch = (type, ...touchPoints) => client.send('Input.dispatchTouchEvent', { type, touchPoints });
      const now = () => phone.page.evaluate(() => ({ at: window.stead.place, y: scrollY }));
      const before = await now();
      await touch('touchStart', { x, y });
      for (let k = 1; k <= 12; k++) await touch('touchMove', { x: x + k, y: y - 5 * k });
      await touch('touchEnd');
      await phone.page.waitForTimeout(300);
      const after = await now();
      return { by: ['x_mm', 'y_mm', 'z_mm', 'yaw_deg'].map((field) => Math.abs(after.at[field] - before.at[field]) > 1), scrolled: after.y - before.y };
    };
    const part = await partAt(phone.page);
    assert.ok(part, 'the part is not seen');
    assert.deepEqual(await swipe(...part), { by: [true, true, false, false], scrolled: 0 });
    await atRest(phone.page);
    const view = await phone.page.locator('.view').boundingBox();
    const beside = await swipe(view.x + 15, view.y + view.height - 25);
    assert.deepEqual(beside.by, [false, false, false, false]);
    assert.ok(beside.scrolled > 20, `scrolled by ${beside.scrolled}`);
    await phone.close();
  });

  await checked('a session that is killed is said to be gone', async () => {
    const isGrey = () => page.locator('#keep').evaluate((button) => Boolean(button.closest('[inert]')));
    session.child.kill('SIGSTOP');
    await page.locator('#lost').waitFor({ state: 'visible' });
    assert.equal(await isGrey(), true);
    session.child.kill('SIGCONT');
    await page.locator('#lost').waitFor({ state: 'hidden' });
    assert.equal(await isGrey(), false);
    session.child.kill('SIGKILL');
    await page.locator('#lost').waitFor({ state: 'visible' });
    assert.match(await text(page, 'lost'), /What is pinned is kept/);
  });
  await close();
  await session.close();

  await checked('external axes and orientations are set by hand', async () => {
    const turning = startLive('configs/tilting-table.toml');
    const opened = await openLive(browser, await turning.address);
    await opened.page.waitForFunction(() => window.stead.shown.answer);
    const before = await opened.page.evaluate(() => JSON.stringify(window.stead.shown.answer.place.external_axes));
    await opened.page.locator('#axis-field-2').fill('12');
    await opened.page.locator('#axis-field-2').blur();
    await opened.page.waitForFunction((before) => !window.stead.shown.isFollowing && JSON.stringify(window.stead.shown.answer.place.external_axes) !== before, before);
    await opened.page.getByRole('radio', { name: 'flat' }).click();
    await opened.page.waitForFunction(() => window.stead.shown.answer.place.orientation === 'flat');
    assert.deepEqual(opened.seen, { requests: [], complaints: [], questions: [] });
    await opened.close();
    await turning.close();
  });

  await browser.close();
  console.log(failures ? `${failures} failed` : 'all passed');
  process.exit(failures ? 1 : 0);
}
