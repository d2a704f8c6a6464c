// Opens pages of krok-view in headless Chromium and holds them against the library's own figures.
// Usage: node viewer_test.mjs BIN_FOLDER SOURCE_FOLDER. Exit code 1 and a line for each fault.
// With KROK_PAGE_SHOTS=FOLDER the screenshots are kept there.

import { execFileSync } from 'node:child_process';
import { mkdtempSync, readFileSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { chromium } from 'playwright-core';

const [, , bin, source] = process.argv;
const folder = mkdtempSync(join(tmpdir(), 'krok-page-'));
const faults = [];
let checks = 0;

function expect(condition, text) {
  ++checks;
  if (!condition) {
    faults.push(text);
    console.log(`FAULT: ${text}`);
  }
}

const run = (tool, ...words) => execFileSync(join(bin, tool), words, { stdio: ['ignore', 'pipe', 'pipe'] });
const made = (name) => join(folder, name);

// World positions that krok-export gives: frame -> joint -> [x, y, z].
function positionsOf(motion) {
  run('krok-export', motion, '--format', 'csv', '-o', made('positions.csv'));
  const frames = [];
  const [head, ...rows] = readFileSync(made('positions.csv'), 'utf8').trim().split('\n');
  expect(head === 'frame,time,joint,x,y,z', `unexpected columns ${head}`);
  for (const row of rows) {
    const match = row.match(/^(\d+),([^,]+),(.*),([^,]+),([^,]+),([^,]+)$/);
    (frames[match[1]] ??= {})[match[3]] = match.slice(4).map(Number);
  }
  return frames;
}

const browser = await chromium.launch({
  executablePath: process.env.KROK_CHROMIUM ?? '/usr/bin/chromium',
  args: ['--no-sandbox', '--use-gl=angle', '--use-angle=swiftshader', '--enable-unsafe-swiftshader',
    '--disable-background-networking', '--disable-component-update', '--no-first-run'],
});

// The page's own security policy forbids playwright's waitForFunction to evaluate text there.
async function until(page, condition) {
  for (const end = Date.now() + 60000; Date.now() < end;) {
    if (await page.evaluate(condition)) return;
    await new Promise((wake) => { setTimeout(wake, 20); });
  }
  throw new Error(`waited in vain for ${condition}`);
}

async function open(name, options = {}) {
  const context = await browser.newContext({ viewport: { width: 900, height: 600 }, ...options });
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
  await until(page, () => globalThis.krokView?.ready);
  return page;
}

// Of a picture of the canvas: how many different colours it has, a blank one a few, and how many
// pixels are as blue as the first figure's bones; its body is paler.
async function look(page, name) {
  const picture = await page.locator('#view').screenshot();
  if (process.env.KROK_PAGE_SHOTS) {
    const { writeFileSync } = await import('node:fs');
    writeFileSync(join(process.env.KROK_PAGE_SHOTS, `${name}.png`), picture);
  }
  return page.evaluate(async (base64) => {
    const bytes = Uint8Array.from(atob(base64), (c) => c.charCodeAt(0));
    const image = await createImageBitmap(new Blob([bytes], { type: 'image/png' }));
    const canvas = new OffscreenCanvas(image.width, image.height);
    const pen = canvas.getContext('2d');
    pen.drawImage(image, 0, 0);
    const pixels = new Uint32Array(pen.getImageData(0, 0, image.width, image.height).data.buffer);
    const blue = pixels.filter((pixel) => ((pixel >> 16) & 0xff) - (pixel & 0xff) > 70).length;
    return { colours: new Set(pixels).size, blue };
  }, picture.toString('base64'));
}

async function jointsAgree(page, motion, rate, item = 0) {
  const frames = positionsOf(motion);
  for (const share of [0, 0.37, 1]) {
    const frame = Math.round(share * (frames.length - 1));
    const joints = await page.evaluate(
      ([time, which]) => { krokView.setTime(time); return krokView.joints(which); },
      [frame / rate, item],
    );
    let largest = 0;
    for (const { name, position } of joints) {
      const expected = frames[frame][name];
      if (!expected) continue;
      largest = Math.max(largest, Math.hypot(...position.map((x, i) => x - expected[i])));
    }
    expect(joints.length === Object.keys(frames[frame]).length, `${motion}: ${joints.length} joints`);
    expect(largest < 1e-3, `frame ${frame}: a joint is ${largest} m from where the library has it`);
    console.log(`frame ${frame}: joints within ${(largest * 1000).toFixed(3)} mm`);
  }
}

async function playsByKeyboard(page) {
  const state = () => page.evaluate(() => ({ time: krokView.time, playing: krokView.playing }));
  await page.keyboard.press('Home');
  expect((await state()).time === 0, 'Home does not go to the start');
  await page.keyboard.press('ArrowRight');
  expect(Math.abs((await state()).time - 1 / 60) < 1e-9, 'the right arrow is not one frame');
  await page.keyboard.press('Shift+ArrowRight');
  expect(Math.abs((await state()).time - 11 / 60) < 1e-9, 'Shift and the arrow are not ten frames');
  await page.keyboard.press('ArrowLeft');
  expect(Math.abs((await state()).time - 10 / 60) < 1e-9, 'the left arrow is not one frame back');
  await page.keyboard.press('End');
  const end = await page.evaluate(() => krokView.duration);
  expect((await state()).time === end, 'End does not go to the end');
  await page.keyboard.press('Home');
  const before = await page.evaluate(() => krokView.joints()[0].position);
  await page.keyboard.press('Space');
  await until(page, () => krokView.time > 0.2);
  expect((await state()).playing, 'Space does not play');
  const after = await page.evaluate(() => krokView.joints()[0].position);
  expect(Math.hypot(...after.map((x, i) => x - before[i])) > 0.05, 'playing moves no joint');
  expect(await page.getByRole('button', { name: 'Pause' }).count() === 1, 'the button does not say Pause');
  await page.keyboard.press('Space');
  expect(!(await state()).playing, 'Space does not pause');
}

// Every control that can be reached has a name that a screen reader can say.
async function controlsHaveNames(page) {
  const nameless = await page.evaluate(() =>
    [...document.querySelectorAll('button, input, select')]
      .filter((e) => !(e.getAttribute('aria-label') || e.textContent.trim() || e.labels?.length))
      .map((e) => e.outerHTML.slice(0, 80)));
  expect(nameless.length === 0, `controls without a name: ${nameless.join(' ')}`);
}

try {
  const samples = join(source, 'samples/captures');
  for (const name of ['walk', 'turn']) run('krok-import', join(samples, `${name}.bvh`), '-o', made(`${name}.anim`));
  run('krok-body', made('walk.anim'), '--detail', 'low', '-o', made('walk.model'));
  run('krok-skin', made('walk.model'), made('walk.anim'), '--as', 'rig', '-o', made('rig.glb'));
  run('krok-view', made('walk.anim'), '-o', made('one.html'));
  run('krok-view', made('walk.anim'), made('turn.anim'), '--difference', '-o', made('two.html'));
  run('krok-view', made('rig.glb'), '-o', made('glb.html'));

  const one = await open('one.html');
  await jointsAgree(one, made('walk.anim'), 60);
  await playsByKeyboard(one);
  await controlsHaveNames(one);
  const body = await look(one, 'one');
  expect(body.colours > 500, 'the page of a motion is blank');
  await one.keyboard.press('s');
  const both = await look(one, 'both');
  expect(both.blue > body.blue + 1000, `the body hides the skeleton: ${body.blue}, ${both.blue} blue pixels`);
  await one.keyboard.press('b');
  expect((await look(one, 'skeleton')).colours > 300, 'the skeleton alone is blank');

  const two = await open('two.html');
  await jointsAgree(two, made('turn.anim'), 60, 1);
  expect(/at \S+; red is/.test(await two.locator('#difference').textContent()), 'no difference is told');

  const glb = await open('glb.html');
  await jointsAgree(glb, made('walk.anim'), 60);
  expect((await look(glb, 'glb')).colours > 500, 'the page of a GLB is blank');

  const phone = await open('one.html', { viewport: { width: 390, height: 700 }, hasTouch: true, isMobile: true, colorScheme: 'dark' });
  expect((await look(phone, 'phone')).colours > 500, 'the page on a phone is blank');
  const wide = await phone.evaluate(() => document.documentElement.scrollWidth);
  expect(wide <= 390, `on a phone the page is ${wide} pixels wide`);
} catch (error) {
  expect(false, error.stack ?? String(error));
} finally {
  await browser.close();
  rmSync(folder, { recursive: true, force: true });
}
console.log(`${checks} checks, ${faults.length} faults`);
process.exitCode = faults.length > 0 || checks < 25 ? 1 : 0;
