// What must hold of the figures of a page in a browser: what the joints give, forces and deflections, and what every card gives to be taken along.
import { readFileSync } from 'node:fs';
import { join } from 'node:path';
import assert from 'node:assert/strict';
import { frame, setSlider, table, view } from './suite.mjs';

/** The tests by name, for a page of the tables in a folder, whose plans are read. */
export const figures = (folder, plans) => ({
  'what the joints give adds up to the scored part, along plans and in the map': async (page) => {
    const [onPlans, inMap, count] = await page.evaluate(() => {
      const { byJointHere, byJointOnPlan, besideJoints, cases, maps, set } = window.stead;
      const sum = (parts) => parts.reduce((a, b) => a + b, 0);
      let [onPlans, inMap, count] = [0, 0, 0];
      for (const of of cases) {
        of.joints.forEach((_, i) => {
          const parts = byJointOnPlan(of, i);
          // The size of what is scored, without what covers errors of force and stiffness.
          onPlans = Math.max(onPlans, Math.abs(sum(parts) + besideJoints(of, i) - of.columns.score_mm[i]));
        });
      }
      maps.forEach((map, place) => {
        for (let row = 0; row < map.codes.length; row += 53) {
          if (map.codes[row] >= 16) continue;
          const column = Math.floor(row / map.betaCount);
          set({ case: 2 * place, t: map.points[column], chosen: { column, beta: row % map.betaCount } }, true);
          inMap = Math.max(inMap, Math.abs(sum(byJointHere()) - map.scores[row]) / (0.01 + map.scores[row]));
          count++;
        }
      });
      set({ case: 0, t: 0, chosen: null }, true);
      return [onPlans, inMap, count];
    });
    assert.ok(onPlans < 2e-5, `${onPlans} mm off on plans`);
    // Angles of the map are rounded to 0.02 deg.
    assert.ok(inMap < 0.03 && count > 200, `${inMap} of the score off in the map, in ${count} states`);
    return `${onPlans.toExponential(1)} mm, ${(inMap * 100).toFixed(2)} % at most`;
  },

  'the joints that yield are named at the worst points and at a chosen state': async (page) => {
    await page.evaluate(() => window.stead.set({ case: 2, t: 0 }));
    await frame(page);
    const shares = await page.locator('.worst-points tbody tr').first().locator('td').allTextContents();
    const sum = shares.slice(5).reduce((all, text) => all + parseFloat(text), 0);
    assert.ok(shares.length === 11 && Math.abs(sum - 100) <= 3, shares.join(' '));
    const card = page.locator('section[aria-label="Which joint yields"]');
    const read = async () => (await card.locator('.g b:last-child').allTextContents()).map(parseFloat);
    const [before, [column, beta, score]] = [
      await read(),
      await page.evaluate(() => {
        const map = window.stead.maps[1];
        const row = map.codes.findIndex((code, k) => code < 16 && k > 40 * map.betaCount);
        const [column, beta] = [Math.floor(row / map.betaCount), row % map.betaCount];
        window.stead.set({ t: map.points[column], chosen: { column, beta } });
        return [column, beta, map.scores[row]];
      }),
    ];
    await frame(page);
    const chosen = await read();
    assert.ok(Math.abs(chosen.reduce((a, b) => a + b, 0) - score) < 0.01 * score + 1e-3, `${chosen} at column ${column}, ${beta}: ${score}`);
    assert.notDeepEqual(chosen, before);
    await page.evaluate(() => window.stead.set({ case: 0, t: 0, chosen: null }));
  },

  'errors are drawn by the factor of the slider': async (page) => {
    await frame(page);
    const slider = page.locator('#magnified');
    const said = () => page.locator('.factor output').textContent();
    const [usual, first] = [await said(), await view(page)];
    await slider.focus();
    await page.keyboard.press('ArrowRight');
    await frame(page);
    assert.notEqual(await said(), usual);
    assert.ok(!first.equals(await view(page)), 'the curtain stays as it is');
    await page.keyboard.press('ArrowLeft');
    await frame(page);
    assert.equal(await said(), usual);
    assert.ok(first.equals(await view(page)), 'the curtain is not as before');
    for (const name of ['forces', 'deflection']) {
      await page.locator(`[data-layer=${name}]`).click();
      assert.ok(!first.equals(await view(page)), `no arrows of ${name}`);
      await page.locator(`[data-layer=${name}]`).click();
    }
  },

  'force and deflection are those of the table': async (page) => {
    const card = page.locator('section[aria-label="Force and deflection"]');
    for (const [name, of, digits] of [
      ['force', (row) => Math.hypot(row.force_x_n, row.force_y_n, row.force_z_n), 1],
      ['deflection', (row) => +row.total_mm, 4],
    ]) {
      await card.getByRole('radio', { name }).click();
      for (const point of [0, 19, 60]) {
        await setSlider(page, point);
        await frame(page);
        const [, value] = (await card.locator('.head .sub').textContent()).match(/here (\S+)$/);
        assert.equal(value, of(plans[0][point]).toFixed(digits), `${name} at ${point}`);
      }
    }
  },

  'every card gives its picture and its figures': async (page) => {
    const bytes = async (button) => {
      // As slowly as by hand: of many downloads within a second or two Chromium leaves one out.
      await page.waitForTimeout(400);
      const [download] = await Promise.all([page.waitForEvent('download'), button.click()]);
      return [download.suggestedFilename(), readFileSync(await download.path())];
    };
    if (!(await page.locator('#setup details').evaluate((fold) => fold.open))) await page.locator('#setup summary').click();
    const cards = await page.locator('section.card').evaluateAll((all) =>
      all.filter((one) => !one.matches('.messages, .bar') && !one.querySelector('.downloads')).map((one) => one.getAttribute('aria-label')),
    );
    assert.deepEqual(cards, [], 'cards without downloads');
    const tables = new Map();
    for (const button of await page.locator('.downloads button').all()) {
      const label = await button.getAttribute('aria-label');
      const [name, content] = await bytes(button);
      if (!label.startsWith('CSV: ')) {
        const isPicture = name.endsWith('.svg') ? content.includes('</svg>') : content.subarray(1, 4).equals(Buffer.from('PNG'));
        assert.ok(isPicture && content.length > 2000, `${name}: ${content.length} bytes`);
      } else {
        const lines = content.toString().trimEnd().split('\n');
        assert.ok(name.endsWith('.csv') && lines.length > 1 && lines[0].length > 3, `${name}: ${lines.slice(0, 2)}`);
        tables.set(label.replace('CSV: ', ''), lines);
      }
    }
    await page.locator('#setup summary').click();
    // The scene gives the plan, the map its states.
    const plan = tables.get('The cell in three dimensions');
    assert.deepEqual([plan[0].split(',').length, plan.length], [Object.keys(plans[0][0]).length, plans[0].length + 1]);
    assert.equal(+plan[5].split(',')[plan[0].split(',').indexOf('point')], 4);
    // Under the names of the controller stand its angles, also as shares of their ranges.
    const joints = tables.get('Joints within their limits').map((line) => line.split(','));
    const ends = await page.locator('.gauges:not(.shares) .g').evaluateAll((all) => all.map((one) => [...one.querySelectorAll('span')].map((end) => +end.textContent)));
    for (const point of [0, 40, 90]) {
      const angles = await page.evaluate((angles) => window.stead.shownAngles(angles), [1, 2, 3, 4, 5, 6].map((j) => +plans[0][point][`theta${j}_deg`]));
      angles.forEach((angle, j) => {
        assert.match(joints[0][j + 1], new RegExp(`^A${j + 1} `));
        const share = (100 * (angle - ends[j][0])) / (ends[j][1] - ends[j][0]);
        assert.ok(Math.abs(joints[point + 1][j + 1] - share) < 0.5, `A${j + 1} at ${point}: ${joints[point + 1][j + 1]} % of its range, ${share}`);
      });
    }
    const states = table(join(folder, 'deflection-map-best.csv'));
    const map = tables.get('Deflection map').slice(1).map((line) => line.split(','));
    assert.equal(map.length, states.length);
    states.forEach((row, k) => k % 97 || assert.ok(row.reason ? map[k][4] === row.reason : Math.abs(map[k][2] - row.score_mm) < 1e-4, `${map[k]}`));
    return `${tables.size} tables`;
  },
});
