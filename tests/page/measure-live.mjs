// How quick the live page is in software rendering: prints, asserts nothing.
//
//   STEAD=target/release/stead node measure-live.mjs RUN [MORE ..]     MORE are further arguments of `stead live`
import { loadavg } from 'node:os';
import { launch } from './browser.mjs';
import { atRest, openLive, partAt, startLive } from './live.mjs';

const MOVES = 60;
const EVERY_MS = 100;
const [run, ...more] = process.argv.slice(2);
const session = startLive(run, more);
const address = new URL(await session.address);

/** Times of the server alone, without a browser: moved placements, one at rest, those moved while one at rest is computed, the whole map. ms */
const ask = (path, body) =>
  fetch(new URL(path, address.origin), {
    method: 'POST',
    headers: { 'X-Stead-Token': address.searchParams.get('token') },
    body: JSON.stringify({ page: 'measured', ...body }),
  }).then((answer) => answer.json());
const timed = async (work) => {
  const begun = performance.now();
  await work();
  return performance.now() - begun;
};
const html = await (await fetch(address)).text();
const { placement_exact: at0, ...setup } = JSON.parse(html.match(/id="data">([^]*?)<\/script>/)[1]).live.place;
const placed = (id) => ({ ...at0, ...setup, z_mm: at0.z_mm - (id % 20) / 10, id });
const previews = [];
for (let k = 0; k < 40; k++) previews.push(await timed(() => ask('/preview', placed(k))));
previews.sort((a, b) => a - b);
const scored = await timed(() => ask('/whole', placed(0)));
const interrupting = [];
for (let k = 0; k < 20; k++) {
  const whole = ask('/whole', placed(k));
  await new Promise((done) => setTimeout(done, (scored * k) / 20));
  interrupting.push(await timed(() => ask('/preview', placed(k + 1))));
  await whole;
}
interrupting.sort((a, b) => a - b);
const mapped = await timed(async () => {
  for (let from = 0, made = 1; made; from += made) made = (await ask('/map', { ...placed(0), from })).columns.points.length;
});
console.log(
  `${run}: the server alone: a moved placement ${previews[20].toFixed(1)} ms in the median, ${previews[38].toFixed(0)} ms at the 95th percentile; ` +
    `moved while one at rest was computed ${interrupting[10].toFixed(0)} ms, at most ${interrupting[19].toFixed(0)} ms; ` +
    `one at rest ${scored.toFixed(0)} ms, its map ${mapped.toFixed(0)} ms; load ${loadavg()[0].toFixed(1)}`,
);

const browser = await launch();
const { page, close } = await openLive(browser, address.href);
await atRest(page);
const first = await page.evaluate(() => window.stead.first);

/**
 * Of every move of the pointer, from its own time on, the time until the frame with the mean of the place that it led to, or of a later one;
 * of the last also the time until all of it is known.
 */
await page.evaluate(() => {
  const times = [];
  let [moves, isAnswered] = [[], false];
  const moved = (event) => event.buttons && moves.push({ at: event.timeStamp, id: Infinity });
  // A movement is told twice where the browser tells it at once, too.
  addEventListener('onpointerrawupdate' in window ? 'pointerrawupdate' : 'pointermove', moved, { capture: true });
  const ask = window.fetch;
  window.fetch = (path, options) => {
    if (path === '/preview') moves.forEach((move) => (move.id = Math.min(move.id, JSON.parse(options.body).id)));
    return ask(path, options);
  };
  new MutationObserver(() => {
    if (isAnswered) return;
    isAnswered = true;
    requestAnimationFrame(() =>
      setTimeout(() => {
        isAnswered = false;
        const { id } = window.stead.shown.answer;
        times.push(...moves.filter((move) => move.id <= id).map((move) => performance.now() - move.at));
        moves = moves.filter((move) => move.id > id);
      }),
    );
  }).observe(document.getElementById('live-mean'), { childList: true, characterData: true, subtree: true });
  window.measured = { times };
});
const at = await partAt(page);
await page.mouse.move(...at);
await page.mouse.down();
for (let k = 0; k < MOVES; k++) {
  await page.mouse.move(at[0] + 6 * Math.sin(k / 3) + k / 10, at[1] + 3 * Math.cos(k / 4));
  await page.waitForTimeout(EVERY_MS);
}
await page.evaluate(() => (window.measured.last = performance.now()));
await page.mouse.up();
await atRest(page);
const whole = await page.evaluate(() => performance.now() - window.measured.last);
const times = (await page.evaluate(() => window.measured.times)).sort((a, b) => a - b);
const share = (part) => times[Math.min(times.length - 1, Math.floor(part * times.length))].toFixed(0);
const points = await page.evaluate(() => window.stead.shown.answer.points[1]);
console.log(
  `${run}: ${points} points; first view ${(first / 1000).toFixed(2)} s; of ${MOVES} moves ${times.length} means on the screen after ` +
    `${share(0.5)} ms in the median, ${share(0.95)} ms at the 95th percentile; all of it ${(whole / 1000).toFixed(2)} s after the last; ` +
    `load ${loadavg()[0].toFixed(1)}`,
);
await close();
await browser.close();
await session.close();
process.exit(0);
