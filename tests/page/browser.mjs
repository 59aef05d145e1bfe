// Debian's Chromium as the tests use it, and pages that are broken on purpose.
import { chromium } from 'playwright-core';
import { createHash } from 'node:crypto';
import assert from 'node:assert/strict';

/** The browser, with software rendering and nothing that asks the network of its own accord. */
export const launch = () =>
  chromium.launch({
    executablePath: process.env.CHROMIUM ?? '/usr/bin/chromium',
    args: [
      '--no-sandbox',
      '--use-angle=swiftshader',
      '--enable-unsafe-swiftshader',
      '--disable-background-networking',
      '--disable-component-update',
      '--disable-sync',
      '--no-first-run',
    ],
  });

/** A page with another script, which its policy allows. */
export function withScript(html, change) {
  const [, script] = html.match(/<script>([^]*?)<\/script>/);
  const changed = change(script);
  assert.notEqual(changed, script, 'nothing to break was found');
  const digest = (text) => createHash('sha256').update(text).digest('base64');
  return html.replace(script, () => changed).replace(digest(script), () => digest(changed));
}

/** What is said of an error in a line. */
export const inShort = (error) => String(error.message).split('\n').filter(Boolean).slice(0, 6).join(' ');
