// What keeps the figures of a placement from being those of a part that can be cut there: seen at once, and asked before it is pinned.

import { shown } from './follow.js';

/** @typedef {{ level: '' | 'stale' | 'doubt' | 'bad', text: string }} Concern of the first level what is common to all placements */

/** What a line of the summary is about, and how much it weighs. @type {Record<string, Concern['level']>} */
const LEVELS = { WARNING: 'doubt', INTERRUPTED: 'doubt', 'NOT CHECKED': 'doubt', 'RESTS ON': '' };
/** @type {Concern['level'][]} */
const WORST_FIRST = ['bad', 'doubt', 'stale', ''];

/** The summary of the last placement that was scored as a whole. @type {{ about: string, text: string }[]} */
let summary = [];

/** What is to be known of the placement as it is shown, the worst first. @returns {Concern[]} */
export function concerns() {
  const { answer, isFollowing, isWhole } = shown;
  if (!answer) return [];
  if (isWhole && answer.document?.summary) summary = answer.document.summary;
  // A warning is of the placement that it came with, and its own line below says that this one is outside.
  const isOf = (/** @type {string} */ about) => about in LEVELS && (about !== 'WARNING' || (isWhole && !isFollowing));
  const said = summary.filter(({ about }) => isOf(about)).map(({ about, text }) => ({ level: LEVELS[about], text: `${about.toLowerCase()}: ${text}` }));
  const [some, all] = answer.points;
  const out = [
    ...(answer.outside_cell ? [{ level: /** @type {const} */ ('bad'), text: answer.outside_cell }] : []),
    ...said.filter(({ text }) => !(answer.outside_cell && text.includes('outside the cell'))),
    ...(some < all ? [{ level: /** @type {const} */ ('doubt'), text: `an estimate on ${some} of ${all} points` }] : []),
    ...(isFollowing ? [{ level: /** @type {const} */ ('stale'), text: 'figures of the placement before' }] : []),
  ];
  return out.sort((a, b) => WORST_FIRST.indexOf(a.level) - WORST_FIRST.indexOf(b.level));
}
