// The server that the page comes from: the cookie that it has set says who asks, and it may go away.

import { keptOver } from './tab.js';

/** A name by which the server tells this page from others. @type {string} */
export const PAGE = keptOver('page', () => PAGE) ?? Array.from(crypto.getRandomValues(new Uint8Array(9)), (byte) => byte.toString(36)).join('');

/** @type {((isLost: boolean) => void)[]} */
const watchers = [];
let isLost = false;
let failures = 0;

/** @param {(isLost: boolean) => void} watch told when the server goes away, and when it is there again */
export const onLost = (watch) => void watchers.push(watch);

/** A request fails now and then while a machine is busy; two in a row are taken for an end. @param {boolean} failed */
function heard(failed) {
  failures = failed ? failures + 1 : 0;
  const now = failures > 1;
  if (now === isLost) return;
  isLost = now;
  watchers.forEach((watch) => watch(isLost));
}

/** What the server says no to, in its words. */
export class Refusal extends Error {}

/** The address of a file of a kept placement. @param {string} name @param {string} file */
export const keptFile = (name, file) => `/kept/${name}/${file}`;

/** @param {string} path @param {RequestInit} [more] @returns {Promise<any>} */
async function fetched(path, more = {}) {
  let response;
  try {
    response = await fetch(path, { ...more, headers: more.body ? { 'Content-Type': 'application/json' } : {} });
  } catch (error) {
    heard(true);
    throw error;
  }
  heard(false);
  const answer = await response.json();
  if (!response.ok) throw new Refusal(answer.error ?? `the server answers ${response.status}`);
  return answer;
}

/** Asks the server. @param {string} path @param {Record<string, any>} [body] */
export const ask = (path, body = {}) => fetched(path, { method: 'POST', body: JSON.stringify({ page: PAGE, ...body }) });

/** A look at the server is answered at once, however much it computes. ms */
const ALIVE_MS = 800;

/** What has changed at the server; one that says nothing in time has gone. */
export const serverState = () => fetched('/state', { signal: AbortSignal.timeout(ALIVE_MS) });
