// Opens pages of walks on a ground and holds what is drawn against the footprints. See checks.mjs.
// Usage: node ground_test.mjs BIN_FOLDER SOURCE_FOLDER MAKE_WALK.

import { execFileSync } from 'node:child_process';
import { readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { check, drawn, expect, made, open, run } from './checks.mjs';

const makeWalk = process.argv[4];
const STAIRS = 'stairs:rise=10cm,run=29cm,count=6';

function fitLibrary() {
  for (const length of [50, 70]) {
    for (const rise of [0, 12]) {
      execFileSync(makeWalk, ['-q', '--steps', '4', '--step-length', `${length}cm`, '--rise', `${rise}cm`,
        '--ground', 'slope', '-o', made(`walk_${length}_${rise}.bvh`)]);
    }
  }
  writeFileSync(made('library.json'), JSON.stringify({ schema: 'krok.library/1', steps: 'auto',
    parameters: [{ name: 'length', measures: 'step.length' }, { measures: 'step.height' }],
    examples: [{ clip: 'walk_*.bvh' }] }));
  run('krok-fit', '-q', made('library.json'), '-o', made('walking.steps'));
}

// The colours of a picture of the canvas at some places, as [red, green, blue].
async function coloursAt(page, name, places) {
  const picture = await page.locator('#view').screenshot();
  if (process.env.KROK_PAGE_SHOTS) writeFileSync(join(process.env.KROK_PAGE_SHOTS, `${name}.png`), picture);
  return page.evaluate(async ([base64, points]) => {
    const bytes = Uint8Array.from(atob(base64), (c) => c.charCodeAt(0));
    const image = await createImageBitmap(new Blob([bytes], { type: 'image/png' }));
    const pen = new OffscreenCanvas(image.width, image.height).getContext('2d', { willReadFrequently: true });
    pen.drawImage(image, 0, 0);
    return points.map(({ x, y }) => [...pen.getImageData(Math.round(x), Math.round(y), 1, 1).data].slice(0, 3));
  }, [picture.toString('base64'), places]);
}

// Places of a print: in its middle between heel and number, and beside it.
const project = (page, points) => page.evaluate((all) => all.map((point) => krokView.project(...point)), points);
const along = ({ heel, forward, length }, share) => heel.map((x, i) => x + share * length * forward[i]);
const beside = (print) => {
  const [x, y, z] = along(print, 0.5);
  return [x + (print.side === 'left' ? 0.3 : -0.3), y, z];
};
const isBlue = ([red, , blue]) => blue > red + 60;
const isOrange = ([red, , blue]) => red > blue + 60;
const isGround = ([red, green, blue]) => Math.max(red, green, blue) - Math.min(red, green, blue) < 40 && green < 236;

async function printsAreDrawn(page, name, ground) {
  const prints = await page.evaluate(() => krokView.prints());
  expect(prints.length > 6, `${name}: ${prints.length} footprints`);
  for (const { number, heel } of prints) {
    const heights = await page.evaluate(([x, , z]) => krokView.groundAt(x, z), heel);
    const miss = Math.min(...heights.map((height) => Math.abs(height - heel[1])));
    expect(miss < 1e-3, `${name}: the ground is drawn ${miss} m from print ${number}`);
    const real = ground(heel[2]);
    expect(Math.abs(heel[1] - real) < 1e-4, `${name}: print ${number} is at ${heel[1]} m, the ground at ${real} m`);
  }
  await drawn(page, () => page.keyboard.press('b'));
  // Those that nothing hides: a step may be between the camera and what is behind it.
  const shown = prints.filter(({ planted }) => !planted);
  const soles = await project(page, shown.map((print) => along(print, 0.3)));
  const around = await project(page, shown.map(beside));
  const colours = await coloursAt(page, name, [...soles, ...around]);
  shown.forEach(({ number, side }, i) => {
    expect((side === 'left' ? isBlue : isOrange)(colours[i]), `${name}: print ${number}, ${side}, has the colour ${colours[i]}`);
    expect(isGround(colours[shown.length + i]), `${name}: beside print ${number} the colour is ${colours[shown.length + i]}`);
  });
  await drawn(page, () => page.keyboard.press('p'));
  const bare = await coloursAt(page, `${name} without prints`, soles);
  bare.forEach((colour) => expect(isGround(colour), `${name}: without footprints the colour is ${colour}`));
  await drawn(page, () => page.keyboard.press('g'));
  const [, ...empty] = await coloursAt(page, `${name} without ground`, soles);
  const background = empty.filter((colour) => !isGround(colour)).length;
  expect(background === empty.length, `${name}: without ground ${empty.length - background} places are not empty`);
  for (const key of 'pgb') await drawn(page, () => page.keyboard.press(key));
  return prints;
}

// Each print is marked in the time that a foot of its side is in contact, and in no other.
async function footsteps(page, walk, prints) {
  const keys = JSON.parse(readFileSync(made(`${walk}.keys.json`), 'utf8'));
  const contacts = keys.contacts.filter(({ joint }) => /Foot$/.test(joint));
  for (const { joint, start, end } of contacts) {
    const side = joint.startsWith('Left') ? 'left' : 'right';
    const marked = await page.evaluate((time) => {
      krokView.setTime(time);
      return krokView.prints().filter(({ planted }) => planted);
    }, (start + end) / 2);
    const here = marked.filter((print) => print.side === side);
    expect(here.length === 1, `${walk}: at ${(start + end) / 2} s ${here.length} prints of the ${side} foot are marked`);
    expect(marked.length <= 2, `${walk}: ${marked.length} prints are marked at once`);
  }
  const seen = new Set();
  for (let time = 0; time < await page.evaluate(() => krokView.duration); time += 0.05) {
    for (const number of await page.evaluate((at) => {
      krokView.setTime(at);
      return krokView.prints().filter(({ planted }) => planted).map((print) => print.number);
    }, time)) seen.add(number);
  }
  expect(seen.size === prints.length, `${walk}: ${seen.size} of ${prints.length} prints are stood on`);
}

await check(60, async () => {
  fitLibrary();
  run('krok-walk', '-q', made('walking.steps'), '--goal', '0m,3m', '--ground', STAIRS, '-o', made('stairs.anim'),
    '--save-prints', made('prints.csv'), '--save-page', made('stairs.html'));
  const stairs = await open('stairs.html');
  const tread = (z) => 0.1 * Math.min(6, Math.max(0, Math.floor((z - 1) / 0.29) + 1));
  const prints = await printsAreDrawn(stairs, 'stairs', tread);
  await footsteps(stairs, 'stairs', prints);
  // Both sides of a riser are where they are to be: the edge is sharp.
  const [below, above] = await stairs.evaluate(() => [krokView.groundAt(0.5, 0.9999)[0], krokView.groundAt(0.5, 1.0001)[0]]);
  expect(Math.abs(below) < 1e-5 && Math.abs(above - 0.1) < 1e-5, `at the first riser the ground is drawn at ${below} and ${above} m`);
  expect(await stairs.getByLabel('Side by side (a)').count() === 0, 'characters can be moved off their ground');

  // The same by krok-view, from the files.
  run('krok-view', made('stairs.anim'), '--ground', STAIRS, '--prints', made('prints.csv'), '-o', made('again.html'));
  const data = (name) => JSON.parse(readFileSync(made(name), 'utf8').match(/id="krok-data">(.*?)<\/script>/s)[1]);
  const [one, two] = [data('stairs.html'), data('again.html')];
  expect(JSON.stringify(one.ground) === JSON.stringify(two.ground), 'krok-view shows another ground than krok-walk');
  const apart = one.prints.list.map(({ heel }, i) => Math.hypot(...heel.map((x, k) => x - two.prints.list[i].heel[k])));
  expect(Math.max(...apart) < 2e-5, `krok-view shows prints ${Math.max(...apart)} m from those of krok-walk`);

  run('krok-walk', '-q', made('walking.steps'), '--goal', '0m,3m', '--ground', 'slope:-6deg', '-o', made('slope.anim'),
    '--save-page', made('slope.html'));
  const slope = await open('slope.html');
  await printsAreDrawn(slope, 'slope', (z) => -Math.tan((6 * Math.PI) / 180) * Math.max(0, z - 1));
});
