// What a tab keeps while its page is loaded anew, as the values of the run have changed: for its next page alone.

const KEY = 'stead-live';

/** @type {Record<string, any>} */
let kept = {};
try {
  kept = JSON.parse(sessionStorage.getItem(KEY) ?? '{}');
  // A tab that is copied is another one.
  sessionStorage.removeItem(KEY);
} catch {
  // A browser that keeps nothing loses the steps back, and no more.
}

/** @type {Record<string, () => any>} */
const makers = {};

/** What the page before has kept under a name; from now on what the page keeps is made by `make`. @param {string} name @param {() => any} make */
export function keptOver(name, make) {
  makers[name] = make;
  return kept[name];
}

/** Loads the page anew. */
export function loadAnew() {
  try {
    sessionStorage.setItem(KEY, JSON.stringify(Object.fromEntries(Object.entries(makers).map(([name, make]) => [name, make()]))));
  } catch {
    // As above.
  }
  location.reload();
}
