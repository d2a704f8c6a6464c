// What the tests of pages share: headless Chromium, a folder, checks that are counted.
// Arguments of a test: BIN_FOLDER SOURCE_FOLDER. With KROK_PAGE_SHOTS=FOLDER the screenshots are kept
// there.

import { execFileSync } from 'node:child_process';
import { mkdtempSync, readFileSync, rmSync } from 'node:fs';
import { createRequire } from 'node:module';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { chromium } from 'playwright-core';

const AXE = readFileSync(createRequire(import.meta.url).resolve('axe-core/axe.min.js'), 'utf8');
const bin = process.argv[2];
let folder;
let faults = [];
let checks = 0;
let kept = false;

// For several tests, one after the other, in one process.
export const keepBrowser = () => { kept = true; };

export function expect(condition, text) {
  ++checks;
  if (!condition) {
    faults.push(text);
    console.log(`FAULT: ${text}`);
  }
}

export const run = (tool, ...words) => execFileSync(join(bin, tool), words, { stdio: ['ignore', 'pipe', 'pipe'] });
export const made = (name) => join(folder ??= mkdtempSync(join(tmpdir(), 'krok-page-')), name);

export const browser = await chromium.launch({
  executablePath: process.env.KROK_CHROMIUM ?? '/usr/bin/chromium',
  args: ['--no-sandbox', '--use-gl=angle', '--use-angle=swiftshader', '--enable-unsafe-swiftshader',
    '--disable-background-networking', '--disable-component-update', '--no-first-run'],
});

// The page's own security policy forbids playwright's waitForFunction to evaluate text there.
export async function until(page, condition) {
  for (const end = Date.now() + 60000; Date.now() < end;) {
    if (await page.evaluate(condition)) return;
    await new Promise((wake) => { setTimeout(wake, 20); });
  }
  throw new Error(`waited in vain for ${condition}`);
}

// `ready` is asked of the page, before it is handed out.
export async function open(name, options = {}, ready = () => globalThis.krokView?.ready) {
  // A page moves at once, which most checks have no use for.
  const context = await browser.newContext({ viewport: { width: 900, height: 600 }, reducedMotion: 'reduce', ...options });
  const page = await context.newPage();
  page.on('console', (line) => {
    if (line.type() === 'error' || line.type() === 'warning') {
      // Chromium's own remark on drawing without a graphics card.
      if (!/GPU stall|software WebGL|swiftshader/i.test(line.text())) {
        expect(false, `${name}: console ${line.type()}: ${line.text()}`);
      }
    }
  });
  page.on('pageerror', (error) => expect(false, `${name}: ${error.message}`));
  page.on('request', (request) => {
    const url = request.url();
    if (!/^(data|blob):/.test(url) && url !== `file://${made(name)}`) {
      expect(false, `${name}: asks for ${url.slice(0, 100)}`);
    }
  });
  await page.goto(`file://${made(name)}`);
  await until(page, ready);
  return page;
}

// Does something that changes the picture, and waits until it is drawn: a loaded machine takes its
// time.
export async function drawn(page, act) {
  const before = await page.evaluate(() => krokView.drawn);
  await act();
  for (const end = Date.now() + 20000; Date.now() < end;) {
    if (await page.evaluate((count) => krokView.drawn > count, before)) return;
    await new Promise((wake) => { setTimeout(wake, 20); });
  }
  expect(false, `nothing is drawn after ${act}`);
}

// Without findings of axe-core: names, roles, contrast.
export async function axeFinds(page, where) {
  await page.evaluate(AXE);
  const { violations } = await page.evaluate(() => axe.run(document, { resultTypes: ['violations'] }));
  for (const { id, nodes } of violations) {
    expect(false, `axe-core, ${where}: ${id}: ${nodes.map(({ target }) => target.join(' ')).join(', ')}`);
  }
  expect(violations.length === 0, `axe-core, ${where}: ${violations.length} findings`);
}

// Does the checks of a test; exit code 1 if one fails, or fewer than `least` were done.
export async function check(least, test) {
  try {
    await test();
  } catch (error) {
    expect(false, error.stack ?? String(error));
  } finally {
    if (kept) await Promise.all(browser.contexts().map((context) => context.close()));
    else await browser.close();
    if (folder) rmSync(folder, { recursive: true, force: true });
    folder = undefined;
  }
  console.log(`${checks} checks, ${faults.length} faults`);
  if (faults.length > 0 || checks < least) process.exitCode = 1;
  faults = [];
  checks = 0;
}
