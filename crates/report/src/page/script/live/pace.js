// Drawing that gives way to figures: where a machine draws slowly, as in software, it draws less often while the part is moved.

/** A frame that takes less is no burden. ms */
const LIGHT_MS = 45;

/**
 * A drawing that is done when it can be, not as often as it is asked for: after a slow frame it waits so many times as long as that took.
 * @param {() => void} draw @param {number} times @returns {() => void}
 */
export function paced(draw, times) {
  let isAsked = false;
  let isBusy = false;
  const next = () => {
    if (isBusy || !isAsked) return;
    [isAsked, isBusy] = [false, true];
    const begun = performance.now();
    draw();
    // The second frame begins when the first one is on the screen.
    requestAnimationFrame(() =>
      requestAnimationFrame(() => {
        const took = performance.now() - begun;
        setTimeout(
          () => {
            isBusy = false;
            next();
          },
          took > LIGHT_MS ? times * took : 0,
        );
      }),
    );
  };
  return () => {
    isAsked = true;
    next();
  };
}
