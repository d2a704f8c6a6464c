// How soon krok-view's page shows its actor and how smoothly it plays, beside three.js's own
// example of skinning (skinning_peer.html) with the same body and motion, 10,000 vertices and 5,000
// frames, in a picture as large. Headless Chromium draws both without a graphics card; a new browser
// for each opening, the two in turn; medians over the rounds. The ratios compare across machines,
// the times do not.
//
//   node tests/page/opening_bench.mjs build/bin . [ROUNDS]
//
// KROK_CHROMIUM names the browser, /usr/bin/chromium otherwise; without one nothing is measured.

import { execFileSync } from 'node:child_process';
import { existsSync, mkdtempSync, readFileSync, rmSync, statSync, writeFileSync } from 'node:fs';
import { createServer } from 'node:http';
import { tmpdir } from 'node:os';
import { dirname, join, normalize } from 'node:path';
import { fileURLToPath } from 'node:url';
import { chromium } from 'playwright-core';

const LONG = 5000; // frames
const MEGABYTE = 1e6;
const WARM_UP = 500; // milliseconds of playing before it is measured
const PLAYING = 3000; // milliseconds that are measured
const WINDOW = { width: 900, height: 600 };

const here = dirname(fileURLToPath(import.meta.url));
const [, , bin, source, rounds = '7'] = process.argv;
const executablePath = process.env.KROK_CHROMIUM ?? '/usr/bin/chromium';
if (!bin || !source) {
  console.error('usage: node opening_bench.mjs BIN_FOLDER SOURCE_FOLDER [ROUNDS]');
  process.exit(2);
}
if (!existsSync(executablePath)) {
  console.log(`skipped: no ${executablePath}; KROK_CHROMIUM may name a Chromium elsewhere`);
  process.exit(0);
}

const folder = mkdtempSync(join(tmpdir(), 'krok-opening-'));
const made = (name) => join(folder, name);
const run = (tool, ...words) => execFileSync(join(bin, tool), [...words, '--quiet'], { stdio: ['ignore', 'ignore', 'inherit'] });
const megabytes = (name) => `${(statSync(made(name)).size / MEGABYTE).toFixed(2)} MB`;

function median(values) {
  const sorted = [...values].sort((a, b) => a - b);
  const middle = sorted.length >> 1;
  return sorted.length % 2 === 1 ? sorted[middle] : (sorted[middle - 1] + sorted[middle]) / 2;
}

// The walk of the samples, again and again: `frames` of it, or as many as make `bytes`.
function repeatWalk(name, { frames = Infinity, bytes = Infinity }) {
  const text = readFileSync(join(source, 'samples/captures/walk.bvh'), 'utf8');
  const [, head, time, body] = text.match(/^([^]*)Frames: \d+\n(Frame Time: .*\n)([^]*)$/);
  const rows = body.trimEnd().split('\n').map((row) => `${row}\n`);
  const kept = [];
  for (let size = head.length; kept.length < frames; ) {
    const row = rows[kept.length % rows.length];
    size += row.length;
    if (size > bytes) break;
    kept.push(row);
  }
  writeFileSync(made(name), `${head}Frames: ${kept.length}\n${time}${kept.join('')}`);
}

// Runs in the page before its own scripts. Notes when the actor has been drawn first and how far
// apart the page's animation frames are.
function watch() {
  const seen = { shown: null, frames: [], work: [] };
  let drawnIn = null;
  const draw = WebGL2RenderingContext.prototype.drawElements;
  WebGL2RenderingContext.prototype.drawElements = function (mode, count, type, offset) {
    if (count > 10000) drawnIn = this; // nothing but the body has so many corners
    return draw.call(this, mode, count, type, offset);
  };
  const request = globalThis.requestAnimationFrame.bind(globalThis);
  globalThis.requestAnimationFrame = (callback) => request((now) => {
    const begin = performance.now();
    callback(now);
    seen.frames.push(now);
    seen.work.push(performance.now() - begin);
    if (drawnIn && seen.shown === null) {
      // Drawing goes on after the calls have returned; reading a pixel waits for its end.
      drawnIn.readPixels(0, 0, 1, 1, drawnIn.RGBA, drawnIn.UNSIGNED_BYTE, new Uint8Array(4));
      seen.shown = performance.now();
    }
  });
  globalThis.krokBench = seen;
}

async function until(page, condition) {
  for (const end = Date.now() + 60000; Date.now() < end;) {
    if (await page.evaluate(condition)) return;
    await new Promise((wake) => { setTimeout(wake, 20); });
  }
  throw new Error(`waited in vain for ${condition}`);
}

// Milliseconds from navigation to the drawn actor; those from frame to frame while playing, the
// mean, for a browser draws at whole parts of the display's rate only; of them the script's; the
// picture's size.
async function measure(address, viewport, play) {
  const browser = await chromium.launch({
    executablePath,
    args: ['--no-sandbox', '--use-gl=angle', '--use-angle=swiftshader', '--enable-unsafe-swiftshader',
      '--disable-background-networking', '--disable-component-update', '--no-first-run'],
  });
  try {
    const page = await browser.newPage({ viewport });
    // A browser in use has drawn before.
    await page.evaluate(() => document.createElement('canvas').getContext('webgl2').finish());
    await page.addInitScript(watch);
    await page.goto(address, { waitUntil: 'commit' });
    await until(page, () => globalThis.krokBench?.shown);
    await play(page);
    await page.waitForTimeout(WARM_UP);
    await page.evaluate(() => { krokBench.frames.length = krokBench.work.length = 0; });
    await page.waitForTimeout(PLAYING);
    const { shown, frames, work } = await page.evaluate(() => krokBench);
    const apart = (frames.at(-1) - frames[0]) / (frames.length - 1);
    const size = await page.evaluate(() => {
      const { clientWidth: width, clientHeight: height } = document.querySelector('canvas');
      return { width, height };
    });
    return { shown, apart, script: median(work), size };
  } finally {
    await browser.close();
  }
}

// The peer's page asks for its modules and its actor, as it would of three.js's own server.
async function servePeer() {
  const three = join(here, '../node_modules/three');
  const types = { js: 'text/javascript', html: 'text/html', glb: 'model/gltf-binary' };
  const server = createServer((request, response) => {
    const path = normalize(new URL(request.url, 'http://localhost').pathname);
    const file = path === '/rig.glb' ? made('rig.glb')
      : path === '/peer.html' ? join(here, 'skinning_peer.html')
        : path.startsWith('/three/') ? join(three, path.slice('/three/'.length)) : '';
    if (!existsSync(file)) {
      response.writeHead(404).end();
      return;
    }
    response.writeHead(200, { 'Content-Type': types[file.split('.').at(-1)] });
    response.end(readFileSync(file));
  });
  await new Promise((listening) => { server.listen(0, '127.0.0.1', listening); });
  return { address: `http://127.0.0.1:${server.address().port}/peer.html`, close: () => server.close() };
}

// The page opens still; Space plays it.
async function playPage(page) {
  if (!await page.evaluate(() => krokView.playing)) await page.keyboard.press('Space');
  await until(page, () => krokView.playing && krokView.time > 0);
}

function report(samples) {
  const middle = (name, key) => median(samples[name].map((sample) => sample[key]));
  const row = (text, key, digits) => {
    const page = middle('page', key);
    const peer = middle('peer', key);
    const numbers = [page, peer].map((value) => `${value.toFixed(digits)} ms`.padStart(11)).join('');
    console.log(`${text.padEnd(34)}${numbers}${(page / peer).toFixed(2).padStart(8)}`);
  };
  console.log(`${''.padEnd(34)}${'krok-view'.padStart(11)}${'three.js'.padStart(11)}${'ratio'.padStart(8)}`);
  row('opening until the actor is drawn', 'shown', 0);
  row('from frame to frame, playing', 'apart', 1);
  row('  of it the script', 'script', 2);
  console.log(`frames a second: ${(1000 / middle('page', 'apart')).toFixed(0)}, `
    + `three.js ${(1000 / middle('peer', 'apart')).toFixed(0)}; the display's rate here is 60`);
  const line = median(samples.line.map(({ tool }) => tool));
  const both = median(samples.line.map(({ tool, shown }) => tool + shown));
  console.log(`1 MB of BVH, krok-view: ${line.toFixed(0)} ms; with the page's opening: ${both.toFixed(0)} ms`);
}

const peer = await servePeer();
try {
  repeatWalk('long.bvh', { frames: LONG });
  repeatWalk('megabyte.bvh', { bytes: MEGABYTE });
  run('krok-import', made('long.bvh'), '-o', made('long.anim'));
  run('krok-body', made('long.anim'), '-o', made('long.model'));
  run('krok-skin', made('long.model'), made('long.anim'), '--as', 'rig', '-o', made('rig.glb'));
  run('krok-view', made('long.bvh'), '-o', made('long.html'));
  console.log(`${LONG} frames: page ${megabytes('long.html')}, GLB ${megabytes('rig.glb')}; ${rounds} rounds`);

  const openLong = () => measure(`file://${made('long.html')}`, WINDOW, playPage);
  const { size } = await openLong();
  const samples = { page: [], peer: [], line: [] };
  const turns = {
    page: openLong,
    peer: () => measure(peer.address, size, async () => {}),
    line: async () => {
      const begin = performance.now();
      run('krok-view', made('megabyte.bvh'), '-o', made('megabyte.html'));
      const tool = performance.now() - begin;
      return { tool, ...await measure(`file://${made('megabyte.html')}`, WINDOW, playPage) };
    },
  };
  for (let round = 0; round < Number(rounds); ++round) {
    const order = Object.entries(turns);
    if (round % 2 === 1) order.reverse();
    for (const [name, turn] of order) samples[name].push(await turn());
  }
  report(samples);
} finally {
  peer.close();
  rmSync(folder, { recursive: true, force: true });
}
