// What pages weigh and how quick they are, in software rendering: prints, asserts nothing.
//
//   node measure.mjs FOLDER [FOLDER ..]     folders with report.html; each opened five times, the least time counts
import { statSync } from 'node:fs';
import { join, resolve } from 'node:path';
import { pathToFileURL } from 'node:url';
import { launch } from './browser.mjs';
import { open } from './suite.mjs';

const RUNS = 5;
const STEPS = 20;
const PLAY_MS = 4000;
const browser = await launch();
const least = (values) => Math.min(...values);
const middle = (values) => [...values].sort((a, b) => a - b)[values.length >> 1];

/** Times of slider steps with their drawing: until the frame behind that of the step begins. */
const steps = (page) =>
  page.evaluate(async (count) => {
    const slider = document.getElementById('slider');
    const frames = () => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)));
    const times = [];
    for (let k = 0; k < count; k++) {
      await frames();
      const begun = performance.now();
      slider.value = String(Math.round(((k + 1) / (count + 1)) * slider.max));
      slider.dispatchEvent(new Event('input', { bubbles: true }));
      await frames();
      times.push(performance.now() - begun);
    }
    return times;
  }, STEPS);

/** Frames a second while it plays. */
const rate = (page) =>
  page.evaluate(async (length) => {
    const button = document.getElementById('play');
    window.stead.set({ t: 0 }, true);
    const before = window.stead.steps.count;
    button.click();
    const begun = performance.now();
    await new Promise((done) => setTimeout(done, length));
    button.click();
    return ((window.stead.steps.count - before) * 1000) / (performance.now() - begun);
  }, PLAY_MS);

for (const folder of process.argv.slice(2).map((name) => resolve(name))) {
  const file = join(folder, 'report.html');
  const [first, whole, medians, slowest, rates] = [[], [], [], [], []];
  let points = '';
  for (let run = 0; run < RUNS; run++) {
    const { page, close } = await open(browser, pathToFileURL(file).href);
    first.push(await page.evaluate(() => window.stead.first));
    // With the view drawn at its finest and read back: an upper bound.
    whole.push(await page.evaluate(() => window.stead.picture() && performance.now()));
    points = await page.evaluate(() => document.getElementById('now').textContent.match(/of (\d+)/)[1]);
    const times = await steps(page);
    medians.push(middle(times));
    slowest.push(Math.max(...times));
    rates.push(await rate(page));
    await close();
  }
  const megabytes = (statSync(file).size / 1e6).toFixed(3);
  console.log(
    `${folder}: ${+points + 1} points, ${megabytes} MB; first view ${(least(first) / 1000).toFixed(2)} s, read back at its finest ${(least(whole) / 1000).toFixed(2)} s; ` +
      `slider step ${least(medians).toFixed(0)} ms in the middle, ${least(slowest).toFixed(0)} ms the slowest; ` +
      `${Math.max(...rates).toFixed(1)} frames/s while playing`,
  );
}
await browser.close();
