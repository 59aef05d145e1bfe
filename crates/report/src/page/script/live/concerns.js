// What keeps the figures of a placement from being those of a part that can be cut there: seen at once, and asked before it is pinned.

import { DOUBTS } from '../run/data.js';
import { shown } from './follow.js';

/** @typedef {{ level: '' | 'stale' | 'doubt' | 'bad', text: string }} Concern of the first level what is common to all placements */

/** How much a line of the summary weighs by what it is about; nothing where it is no concern. @param {string} about @returns {Concern['level'] | null} */
const levelOf = (about) => (DOUBTS.has(about) ? 'doubt' : about === 'RESTS ON' ? '' : null);
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
  const said = summary.flatMap(({ about, text }) => {
    const level = about !== 'WARNING' || (isWhole && !isFollowing) ? levelOf(about) : null;
    return level === null ? [] : [{ level, text: `${about.toLowerCase()}: ${text}` }];
  });
  const [some, all] = answer.points;
  const out = [
    ...(answer.outside_cell ? [{ level: /** @type {const} */ ('bad'), text: answer.outside_cell }] : []),
    ...said.filter(({ text }) => !(answer.outside_cell && text.includes('outside the cell'))),
    ...(some < all ? [{ level: /** @type {const} */ ('doubt'), text: `an estimate on ${some} of ${all} points` }] : []),
    ...(isFollowing ? [{ level: /** @type {const} */ ('stale'), text: 'figures of the placement before' }] : []),
  ];
  return out.sort((a, b) => WORST_FIRST.indexOf(a.level) - WORST_FIRST.indexOf(b.level));
}
