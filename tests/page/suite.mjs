// What must hold of a page in a browser. Each test acts as a user does and compares what is shown with the tables beside the page.
import { readFileSync } from 'node:fs';
import { join } from 'node:path';
import assert from 'node:assert/strict';
import { figures } from './figures.mjs';

/** A CSV file as rows by the names of its columns. */
export function table(file) {
  const [head, ...lines] = readFileSync(file, 'utf8')
    .trimEnd()
    .split('\n')
    .map((line) => line.split(','));
  return lines.map((line) => Object.fromEntries(head.map((name, k) => [name, line[k]])));
}

export const PLANS = ['best.csv', 'best-worst-plan.csv', 'worst.csv', 'worst-worst-plan.csv'];
const REASONS = { reach: 'out of reach', conditioning: 'near a singularity', deflection: 'deflection above its limit' };
const reasonText = (code) => REASONS[code] ?? `limit of joint ${code.replace('joint_', '')}`;

/** Opens a page with the network denied; what it asks for and complains of is collected. */
export async function open(browser, address, { width = 1400, height = 1000, before, scheme = 'light', touch = false } = {}) {
  const context = await browser.newContext({ viewport: { width, height }, colorScheme: scheme, offline: true, hasTouch: touch });
  const page = await context.newPage();
  const seen = { requests: [], complaints: [] };
  page.on('request', (request) => request.url() !== address && seen.requests.push(request.url()));
  page.on('console', (message) => message.type() === 'error' && seen.complaints.push(message.text()));
  page.on('pageerror', (error) => seen.complaints.push(String(error)));
  if (before) await page.addInitScript(before);
  page.setDefaultTimeout(120000);
  await page.goto(address);
  await page.waitForFunction(() => window.stead?.first > 0, null, { timeout: 120000 });
  return { page, seen, close: () => context.close() };
}

export const text = (page, id) => page.locator(`#${id}`).textContent();
/** The view as drawn now, at rest: software draws coarsely while things move. */
export const view = async (page) => Buffer.from(await page.evaluate(() => window.stead.picture()));
export const setSlider = (page, value) =>
  page.locator('#slider').evaluate((slider, to) => {
    slider.value = String(to);
    slider.dispatchEvent(new Event('input', { bubbles: true }));
  }, value);
export const frame = (page) =>
  page.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))));

/** The scale of colours of a card: its ticks and its words. */
export const scale = (page, card) =>
  page.locator(`${card} .scale`).evaluate((one) => ({
    ticks: [...one.querySelectorAll('.marks i')].map((tick) => +tick.textContent),
    words: one.lastChild.textContent,
  }));
/** Whether a number is 1, 2 or 5 times a power of ten. */
const isRound = (value) => /^[125](\.0*)?e/.test(value.toExponential(6));
/** Whether a scale ends at the smallest round value that 98 of 100 values do not exceed, and says which is the largest of all that is above. */
export function endsRound({ ticks, words }, values, largest = Math.max(...values)) {
  const top = ticks.at(-1);
  assert.ok(isRound(top), `${ticks}`);
  const share = (end) => values.filter((value) => value <= end).length / values.length;
  assert.ok(share(top) >= 0.98, `${share(top)} of the values are within ${top}`);
  assert.ok(share(top / 2.5) < 0.98, `${top} is too large`);
  if (largest <= top) return assert.ok(!words.includes('above'), words);
  assert.ok(words.startsWith(`mm; above ${top} the last colour, largest `), words);
  const said = +words.match(/(\S+)$/)[1];
  assert.ok(Math.abs(said - largest) <= 0.005 * largest, `${words}: ${largest}`);
}

async function shows(page, rows, point) {
  await frame(page);
  const row = rows[point];
  assert.match(
    await text(page, 'now'),
    new RegExp(`^point ${point} of ${rows.length - 1} · segment ${row.segment} · posture ${row.posture} `),
  );
  assert.equal(await text(page, 'here'), (+row.score_mm).toFixed(3), `error at point ${point}`);
  assert.equal(await text(page, 'kappa'), (+row.inverse_condition).toFixed(3), `conditioning at point ${point}`);
  const shown = await page.evaluate((joints) => window.stead.shownAngles(joints), [1, 2, 3, 4, 5, 6].map((j) => +row[`theta${j}_deg`]));
  for (let j = 1; j <= 6; j++) {
    assert.ok(Math.abs(parseFloat(await text(page, `joint-${j}`)) - shown[j - 1]) < 0.051, `joint ${j} at point ${point}`);
  }
}

/** The tests by name. `folder` holds the tables of the page, `others` are further folders with plans of the same arm and spindle. */
export function tests(folder, others) {
  const plans = PLANS.map((name) => table(join(folder, name)));
  const placements = table(join(folder, 'placements.csv'));
  return {
    'forward kinematics agrees with every plan': async (page) => {
      let farthest = 0;
      for (const from of [folder, ...others]) {
        for (const name of PLANS) {
          const rows = table(join(from, name));
          const joints = rows.map((row) => [1, 2, 3, 4, 5, 6].map((j) => +row[`theta${j}_deg`]));
          const tips = await page.evaluate(
            (all) => all.map((one) => window.stead.framesOf(one)[7].slice(12, 15)),
            joints,
          );
          rows.forEach((row, k) => {
            const off = Math.hypot(tips[k][0] - row.x_mm, tips[k][1] - row.y_mm, tips[k][2] - row.z_mm);
            farthest = Math.max(farthest, off);
          });
        }
      }
      assert.ok(farthest < 0.005, `${farthest} mm off`);
      return `${farthest.toFixed(4)} mm at most`;
    },

    'joint angles are those of the pendant, as the setup sheet has them': async (page) => {
      const { setup_sheet: sheet } = JSON.parse(readFileSync(join(folder, 'summary.json'), 'utf8'));
      assert.ok(sheet.check_points.length > 1);
      for (const { point, controller_deg: angles } of sheet.check_points) {
        await page.evaluate((t) => window.stead.set({ t }), point);
        await frame(page);
        for (let j = 1; j <= 6; j++)
          assert.ok(Math.abs(parseFloat(await text(page, `joint-${j}`)) - angles[j - 1]) < 0.051, `A${j} at point ${point}`);
      }
      await page.evaluate(() => window.stead.set({ t: 0 }));
    },

    'the numbers of the page are those of the tables': async (page) => {
      for (let k = 0; k < 4; k++) {
        const shown = await page.evaluate((k) => {
          const of = window.stead.cases[k];
          return {
            mean: of.mean,
            max: of.max,
            columns: Object.fromEntries(Object.entries(of.columns).map(([n, c]) => [n, [...c]])),
          };
        }, k);
        assert.equal(shown.mean, +placements[k].mean_mm);
        for (const [name, values] of Object.entries(shown.columns)) {
          plans[k].forEach((row, i) => assert.equal(values[i], Math.fround(row[name]), `${name} of point ${i}`));
        }
        const cells = await page.locator(`#cases tbody tr:nth-child(${k + 1}) td`).allTextContents();
        assert.equal(cells[1], `${(+placements[k].mean_mm).toFixed(4)} mm`);
        assert.equal(cells[2], (+placements[k].max_mm).toFixed(3));
      }
    },

    'the slider moves robot and figures': async (page) => {
      await setSlider(page, 0);
      const first = await view(page);
      for (const point of [58, 104]) {
        await setSlider(page, point);
        await shows(page, plans[0], point);
      }
      assert.ok(!first.equals(await view(page)), 'the view stays as it is: the robot does not follow');
    },

    'keys move along the path and between cases': async (page) => {
      await page.locator('body').click({ position: { x: 3, y: 3 } });
      await page.keyboard.press('Home');
      await shows(page, plans[0], 0);
      for (let k = 0; k < 3; k++) await page.keyboard.press('ArrowRight');
      await page.keyboard.press('ArrowLeft');
      await shows(page, plans[0], 2);
      await page.keyboard.press('Shift+ArrowRight');
      const second = plans[0].findIndex((row) => row.segment === '2');
      await shows(page, plans[0], second);
      for (const k of [3, 2, 1, 0]) {
        await page.keyboard.press(String(k + 1));
        await shows(page, plans[k], second);
        assert.equal(await text(page, 'mean'), (+placements[k].mean_mm).toFixed(3));
      }
      await page.keyboard.press('End');
      await shows(page, plans[0], plans[0].length - 1);
      const before = await page.evaluate(() => getComputedStyle(document.body).backgroundColor);
      await page.keyboard.press('d');
      assert.notEqual(await page.evaluate(() => getComputedStyle(document.body).backgroundColor), before);
      await page.keyboard.press('d');
    },

    'play runs in real time and stops': async (page) => {
      await setSlider(page, 0);
      const first = await view(page);
      const seconds = async () => parseFloat((await text(page, 'now')).match(/([\d.]+) s$/)[1]);
      // Between two clicks in the page, however long the browser takes for a frame.
      const [played, hasCursor] = await page.evaluate(async () => {
        const button = document.getElementById('play');
        button.click();
        const begun = performance.now();
        await new Promise((done) => setTimeout(done, 3000));
        const cursor = document.querySelectorAll('#map canvas')[1];
        const pixels = cursor.getContext('2d').getImageData(0, 0, cursor.width, cursor.height).data;
        button.click();
        return [(performance.now() - begun) / 1000, pixels.some((value) => value > 0)];
      });
      const at = await seconds();
      assert.ok(hasCursor, 'the map has no cursor while it plays');
      assert.ok(at > 0.5 * played - 0.5 && at < 1.1 * played, `after ${played} s of play it is at ${at} s`);
      assert.ok(!first.equals(await view(page)), 'the view stays as it is');
      assert.equal(await seconds(), at, 'it goes on after the pause');
      await page.locator('body').click({ position: { x: 3, y: 3 } });
      await page.keyboard.press('Space');
      assert.equal(await page.locator('#play').getAttribute('aria-label'), 'Pause');
      await page.keyboard.press('ArrowRight');
      assert.equal(await page.locator('#play').getAttribute('aria-label'), 'Play');
    },

    'any state of the map can be chosen': async (page) => {
      await page.keyboard.press('1');
      await page.evaluate(() => scrollTo(0, 0));
      const states = table(join(folder, 'deflection-map-best.csv'));
      const { posture_words: words } = JSON.parse(readFileSync(join(folder, 'summary.json'), 'utf8'));
      const postureText = (posture) => `posture ${posture} (${words[posture - 1]})`;
      const count = states.filter((row) => row.point === '0').length;
      const points = states.length / count;
      const surface = page.locator('#map canvas').nth(1);
      const box = await surface.boundingBox();
      const [left, right, top, bottom] = [42, 8, 8, 26];
      const place = (point, k) => [
        box.x + left + ((point + 0.5) / points) * (box.width - left - right),
        box.y + top + (1 - k / count) * (box.height - top - bottom),
      ];
      const check = async (point, k) => {
        const row = states[point * count + k];
        const beta = `β ${(+row.beta_deg).toFixed(1)}°`;
        const what = row.reason ? reasonText(row.reason) : `${(+row.score_mm).toFixed(4)} mm, ${postureText(row.posture)}`;
        await frame(page);
        assert.equal(await text(page, 'map-reading'), `point ${point}, ${beta}: ${what}`);
        // Bar, tiles and charts tell the same state.
        const words = row.reason
          ? [`point ${point} of 104`, beta, `not allowed: ${reasonText(row.reason)}`, 'the robot stays on the plan']
          : [`point ${point} of 104`, `segment ${plans[0][point].segment}`, postureText(row.posture), beta, `${(+row.score_mm).toFixed(3)} mm, chosen in the map`];
        assert.equal(await text(page, 'now'), words.join(' · '));
        const cards = (await page.locator('.charts .sub').allTextContents()).slice(0, 3);
        assert.ok(cards.every((one) => /chosen state|along plans only/.test(one)), cards.join('; '));
        if (row.reason) return assert.equal(await text(page, 'limit'), '–');
        assert.equal(await text(page, 'here'), (+row.score_mm).toFixed(3));
        // The joints shown bring the tool to the point, but for their rounding to 0.02 deg.
        const off = await page.evaluate(
          ([column, beta, at]) => {
            const map = window.stead.maps[0];
            const row = 6 * (column * map.betaCount + beta);
            const tip = window.stead.framesOf([...map.joints.subarray(row, row + 6)])[7];
            return Math.hypot(tip[12] - at[0], tip[13] - at[1], tip[14] - at[2]);
          },
          [point, k, ['x_mm', 'y_mm', 'z_mm'].map((name) => +plans[0][point][name])],
        );
        assert.ok(off < 1.5, `the robot is ${off} mm off the point`);
      };
      await page.mouse.move(...place(3, 60));
      const allowed = states.findIndex((row) => row.point === '30' && !row.reason) % count;
      await page.mouse.click(...place(30, allowed));
      await check(30, allowed);
      const first = await view(page);
      // A state among allowed ones and away from both plans is painted all over.
      const isClear = (row, k) =>
        k > 1 && k < count - 2 &&
        [-2, 0, 2].every((by) => states[90 * count + k + by]?.reason === '') &&
        plans.slice(0, 2).every((plan) => Math.abs(plan[90].beta_deg - row.beta_deg) > 20);
      const clear = states.slice(90 * count, 91 * count).findIndex(isClear);
      const pixel = await page.evaluate(
        ([x, y]) => {
          const canvas = document.querySelector('#map canvas');
          const box = canvas.getBoundingClientRect();
          const ratio = canvas.width / box.width;
          return [...canvas.getContext('2d').getImageData((x - box.x) * ratio, (y - box.y) * ratio, 1, 1).data];
        },
        place(90, clear),
      );
      assert.equal(pixel[3], 255, 'the map is not drawn');
      // Dragging goes from state to state.
      await page.mouse.move(...place(30, allowed));
      await page.mouse.down();
      await page.mouse.move(...place(70, 100), { steps: 4 });
      await page.mouse.up();
      await check(70, 100);
      assert.ok(!first.equals(await view(page)), 'the robot does not take the state');
      const blocked = states.findIndex((row) => row.reason);
      await page.mouse.click(...place(Math.floor(blocked / count), blocked % count));
      await check(Math.floor(blocked / count), blocked % count);
      // And with keys.
      await page.mouse.click(...place(70, 100));
      await page.locator('#map').focus();
      await page.keyboard.press('ArrowUp');
      await check(70, 101);
      await page.keyboard.press('ArrowLeft');
      await check(69, 101);
      await page.keyboard.press('Escape');
      await shows(page, plans[0], 69);
    },

    'colours end at a round value that one outlier does not move': async (page) => {
      const scores = plans.flat().map((row) => +row.score_mm);
      const states = ['best', 'worst'].map((name) => table(join(folder, `deflection-map-${name}.csv`)).map((row) => +row.score_mm));
      const all = [];
      for (const [k, key] of ['1', '3'].entries()) {
        await page.keyboard.press(key);
        await frame(page);
        const [view, map] = [await scale(page, '#scene'), await scale(page, '.mapbox')];
        endsRound(view, scores);
        endsRound(map, scores, Math.max(...scores, ...states[k]));
        assert.ok(view.ticks.every(isRound), `${view.ticks}`);
        all.push(view.ticks, map.ticks);
      }
      all.forEach((ticks) => assert.deepEqual(ticks, all[0], 'best and worst, view and map share the scale'));
      await page.keyboard.press('1');
      return all[0].join(', ');
    },

    'a row of the table selects its case': async (page) => {
      await page.locator('#cases tbody tr').nth(2).click();
      await frame(page);
      assert.equal(await page.locator('#scene h2').textContent(), 'Worst placement');
      assert.equal(await text(page, 'mean'), (+placements[2].mean_mm).toFixed(3));
      assert.equal(await page.locator('#cases tr[aria-selected=true]').getAttribute('data-case'), '3');
      await page.locator('#cases tbody tr button').first().press('Enter');
      await frame(page);
      assert.equal(await page.locator('#scene h2').textContent(), 'Best placement');
    },

    'the view turns, zooms, and leaves layers out': async (page) => {
      await page.evaluate(() => scrollTo(0, 0));
      const box = await page.locator('.view').boundingBox();
      const [x, y] = [box.x + box.width / 2, box.y + box.height / 2];
      let last = await view(page);
      const differs = async (what) => {
        const now = await view(page);
        assert.ok(!last.equals(now), `${what} changes nothing in the view`);
        last = now;
      };
      await page.mouse.move(x, y);
      await page.mouse.down();
      await page.mouse.move(x + 120, y - 30, { steps: 4 });
      await page.mouse.up();
      await differs('dragging');
      await page.mouse.wheel(0, -300);
      await differs('the wheel');
      await page.locator('.view').focus();
      await page.keyboard.press('ArrowLeft');
      await differs('an arrow key');
      for (const name of ['top', 'front', 'tool', 'cell']) {
        await page.locator(`[data-view=${name}]`).click();
        await differs(`the view ${name}`);
      }
      for (const name of ['curtain', 'cell', 'reach', 'ghost']) {
        await page.locator(`[data-layer=${name}]`).click();
        await differs(`the layer ${name}`);
        await page.locator(`[data-layer=${name}]`).click();
      }
    },

    'a lost context comes back': async (page) => {
      const before = await view(page);
      await page.evaluate(async () => {
        const lose = document.querySelector('.view canvas').getContext('webgl2').getExtension('WEBGL_lose_context');
        lose.loseContext();
        await new Promise((done) => setTimeout(done, 200));
        lose.restoreContext();
        await new Promise((done) => setTimeout(done, 200));
      });
      assert.ok(before.equals(await view(page)), 'the view is another one');
    },

    'everything that takes the focus has a name and shows it': async (page) => {
      const nameless = await page.evaluate(() =>
        [...document.querySelectorAll('button, input, [tabindex="0"], canvas:not([aria-hidden])')]
          .filter((one) => !(one.getAttribute('aria-label') || one.closest('label')?.textContent || one.textContent))
          .map((one) => one.outerHTML),
      );
      assert.deepEqual(nameless, []);
      await page.locator('body').click({ position: { x: 3, y: 3 } });
      for (let k = 0; k < 12; k++) {
        await page.keyboard.press('Tab');
        const outline = await page.evaluate(() => getComputedStyle(document.activeElement).outlineStyle);
        assert.equal(outline, 'solid', await page.evaluate(() => document.activeElement.outerHTML.slice(0, 120)));
      }
    },

    'a link leads to its case and point, and the address follows': async (page) => {
      await page.evaluate(() => {
        location.hash = '#case=3&point=26';
      });
      await page.waitForFunction(() => document.getElementById('now').textContent.startsWith('point 26 '));
      await shows(page, plans[2], 26);
      await page.evaluate(() => window.stead.set({ case: 1, t: 40 }));
      await page.waitForFunction(() => location.hash === '#case=2&point=40');
      await page.evaluate(() => {
        location.hash = '#case=9&point=x';
      });
      await frame(page);
      await shows(page, plans[1], 40);
      await page.evaluate(() => window.stead.set({ case: 0, t: 0 }));
    },

    'a state that is not allowed is named, in grey': async (page) => {
      const reason = await page.evaluate(() => {
        const { codes, betaCount, reasons, points } = window.stead.maps[0];
        const row = codes.findIndex((code) => code >= 16);
        const [column, beta] = [Math.floor(row / betaCount), row % betaCount];
        window.stead.set({ case: 0, t: points[column], chosen: { column, beta } });
        return reasons[codes[row] - 16];
      });
      await frame(page);
      assert.match(await text(page, 'refusal'), new RegExp(`^Not allowed at point .*: ${reasonText(reason)}$`));
      assert.equal(await page.locator('.view.refused').count(), 1);
      await page.evaluate(() => window.stead.set({ chosen: null }));
      await frame(page);
      assert.equal(await page.locator('#refusal').isVisible(), false);
    },

    'the worst points are those of the table and lead there': async (page) => {
      await page.evaluate(() => window.stead.set({ case: 2, t: 0 }));
      await frame(page);
      const worst = plans[2].reduce((most, row) => (+row.score_mm > +most.score_mm ? row : most));
      const first = page.locator('.worst-points tbody tr').first();
      assert.ok((await first.textContent()).includes((+worst.score_mm).toFixed(3)));
      await first.locator('button').click();
      await page.waitForFunction((point) => document.getElementById('now').textContent.startsWith(`point ${point} `), worst.point);
      await page.evaluate(() => window.stead.set({ case: 0, t: 0 }));
    },

    ...figures(folder, plans),

    'the setup sheet has the numbers of the summary': async (page) => {
      const { setup_sheet: sheet } = JSON.parse(readFileSync(join(folder, 'summary.json'), 'utf8'));
      await page.locator('#setup summary').click();
      const said = await page.locator('#setup svg').textContent();
      for (const check of sheet.check_points) {
        for (const number of check.controller_deg) assert.ok(said.includes(number.toFixed(2)), String(number));
      }
      await page.locator('#setup summary').click();
    },

    'it prints the sheet, both placements, the map and the table': async (page) => {
      await page.evaluate(() => window.stead.set({ case: 3, t: 7 }));
      await frame(page);
      await page.evaluate(() => dispatchEvent(new Event('beforeprint')));
      await page.emulateMedia({ media: 'print' });
      await page.waitForFunction(() => [...document.querySelectorAll('.printed img')].every((image) => image.complete));
      const pictures = await page.locator('.pair img, .charted > img').evaluateAll((all) => all.map((image) => image.naturalWidth));
      assert.equal(pictures.length, 3);
      assert.ok(pictures.every((width) => width > 300), String(pictures));
      const isShown = (name) => page.locator(name).first().isVisible();
      for (const name of ['#setup svg', '.pair', '#cases']) assert.ok(await isShown(name), name);
      for (const name of ['#scene', '#play', '.keys', '.search']) assert.ok(!(await isShown(name)), name);
      await page.emulateMedia({ media: 'screen' });
      await page.evaluate(() => dispatchEvent(new Event('afterprint')));
      await frame(page);
      // What was looked at is there again.
      await shows(page, plans[3], 7);
      await page.evaluate(() => window.stead.set({ case: 0, t: 0 }));
    },
  };
}
