// Along the path in real time.

import { COUNT } from './data.js';
import { timesOf } from './path.js';
import { current, remembered, set, state } from './state.js';

const SPEEDS = [1, 2, 4, 8, 0.5];
let speed = 0;
let isPlaying = false;
let lastTick = 0;

/** Times of the points of the case that is shown. */
export const clock = remembered(() => timesOf(current()));

/** Shows whether it plays; the transport puts its button in. */
let showPlaying = (/** @type {boolean} */ _) => {};

/** @param {(isPlaying: boolean) => void} show told whenever playing begins or ends */
export const onPlaying = (show) => void (showPlaying = show);

/** Takes the next speed, in turn. @returns {number} */
export function nextSpeed() {
  speed = (speed + 1) % SPEEDS.length;
  return SPEEDS[speed];
}

export function pause() {
  if (!isPlaying) return;
  isPlaying = false;
  showPlaying(isPlaying);
}

function play() {
  isPlaying = true;
  showPlaying(isPlaying);
  if (state.t >= COUNT - 1) set({ t: 0 });
  lastTick = 0;
  requestAnimationFrame(tick);
}

export const playOrPause = () => (isPlaying ? pause() : play());

/** The time at a fractional point. @param {number[]} times @param {number} t */
export function timeAt(times, t) {
  const i = Math.min(Math.floor(t), COUNT - 1);
  return times[i] + (t - i) * ((times[i + 1] ?? times[i]) - times[i]);
}

/** @param {number} now ms */
function tick(now) {
  if (!isPlaying) return;
  if (lastTick) {
    const times = clock();
    const time = timeAt(times, state.t) + ((now - lastTick) / 1000) * SPEEDS[speed];
    let [low, high] = [0, COUNT - 1];
    while (low < high) {
      const middle = (low + high + 1) >> 1;
      if (times[middle] <= time) low = middle;
      else high = middle - 1;
    }
    const isOver = low >= COUNT - 1;
    set({ t: isOver ? COUNT - 1 : low + (time - times[low]) / (times[low + 1] - times[low] || 1) }, true);
    if (isOver) return pause();
  }
  lastTick = now;
  requestAnimationFrame(tick);
}
