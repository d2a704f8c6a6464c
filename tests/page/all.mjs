// All tests of pages, in one Chromium.
// Usage: node all.mjs BIN_FOLDER SOURCE_FOLDER MAKE_WALK.

import { keepBrowser, browser } from './checks.mjs';

keepBrowser();
for (const test of ['tools', 'viewer', 'ground', 'summary']) {
  console.log(`== ${test}`);
  await import(`./${test}_test.mjs`);
}
await browser.close();
