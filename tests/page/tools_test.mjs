// What a person does with a page of krok-view: compares, frames, walks along the time line, selects
// joints, looks through long lists, saves pictures and links. See checks.mjs.
// Usage: node tools_test.mjs BIN_FOLDER SOURCE_FOLDER.

import { copyFileSync, mkdirSync, readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { axeFinds, check, drawn, expect, made, open, run, until } from './checks.mjs';

const source = process.argv[3];
const WALK = join(source, 'samples/captures/walk.bvh');
const RATE = 60;

// A capture whose root's rows are changed: [x, y, z, ...] in centimetres.
function changedWalk(name, change) {
  const [head, rows] = readFileSync(WALK, 'utf8').split(/(?<=Frame Time: .*\n)/);
  const changed = rows.trimEnd().split('\n').map((row, i) => change(row.trim().split(/\s+/).map(Number), i).join(' '));
  writeFileSync(made(name), `${head}${changed.join('\n')}\n`);
}

// The pixels of the canvas: [[red, green, blue], ...].
async function pixels(page, name) {
  const picture = await page.locator('#view').screenshot();
  if (process.env.KROK_PAGE_SHOTS) writeFileSync(join(process.env.KROK_PAGE_SHOTS, `${name}.png`), picture);
  const base64 = await page.evaluate(async (png) => {
    const bytes = Uint8Array.from(atob(png), (c) => c.charCodeAt(0));
    const image = await createImageBitmap(new Blob([bytes], { type: 'image/png' }));
    const pen = new OffscreenCanvas(image.width, image.height).getContext('2d');
    pen.drawImage(image, 0, 0);
    const { data } = pen.getImageData(0, 0, image.width, image.height);
    let text = '';
    for (let i = 0; i < data.length; i += 32768) text += String.fromCharCode(...data.subarray(i, i + 32768));
    return btoa(text);
  }, picture.toString('base64'));
  const data = Buffer.from(base64, 'base64');
  return Array.from({ length: data.length / 4 }, (_, i) => [data[4 * i], data[4 * i + 1], data[4 * i + 2]]);
}

// Hue in degrees of those that are not nearly grey.
const saturation = ([r, g, b]) => Math.max(r, g, b) - Math.min(r, g, b);
function hue([r, g, b]) {
  const wide = saturation([r, g, b]);
  const high = Math.max(r, g, b);
  const part = high === r ? (g - b) / wide : high === g ? 2 + (b - r) / wide : 4 + (r - g) / wide;
  return ((part * 60) + 360) % 360;
}
const near = (a, b, far) => Math.abs(((a - b + 540) % 360) - 180) <= far;

async function press(page, ...keys) {
  for (const key of keys) await page.keyboard.press(key);
}

// Both actors differ by 100 mm everywhere: the whole body has one colour, which is the end of the
// ramp, or what the ramp has at half when it goes up to 200 mm. Without a difference it has none.
async function differenceIsColoured() {
  changedWalk('moved.bvh', ([x, ...rest]) => [x + 10, ...rest]);
  run('krok-view', WALK, made('moved.bvh'), '--difference', '-o', made('moved.html'));
  const page = await open('moved.html');
  const coloured = async (name) => (await pixels(page, name)).filter((pixel) => saturation(pixel) > 60);
  const { scale, distances } = await page.evaluate(() => krokView.difference());
  expect(Math.abs(scale - 0.1) < 1e-6, `the ramp ends at ${scale} m`);
  expect(distances.every((distance) => Math.abs(distance - 0.1) < 1e-5), 'a joint is not 100 mm from its partner');
  const marks = await page.locator('#ramp-marks span').allTextContents();
  expect(marks.join(' ') === '0 50 100 mm', `the legend has ${marks}`);
  const end = await coloured('difference end');
  const red = end.filter((pixel) => near(hue(pixel), 342, 14));
  expect(end.length > 4000 && red.length > 0.97 * end.length, `${red.length} of ${end.length} pixels are dark red`);
  await page.locator('#difference-scale').fill('200');
  await drawn(page, () => page.locator('#difference-scale').press('Enter'));
  const half = await coloured('difference half');
  const orange = half.filter((pixel) => hue(pixel) > 25 && hue(pixel) < 47);
  expect(half.length > 4000 && orange.length > 0.97 * half.length, `${orange.length} of ${half.length} pixels are orange`);
  // Without ground, what is neither background nor coloured is the ghost.
  await drawn(page, () => page.keyboard.press('g'));
  const ghost = (await pixels(page, 'ghost')).filter((pixel) => saturation(pixel) < 30 && Math.max(...pixel) < 236);
  expect(ghost.length > 500, `the ghost has ${ghost.length} pixels`);
  await drawn(page, () => page.locator('#items input').nth(1).uncheck());
  expect(await page.evaluate(() => krokView.difference()) === null, 'one motion alone has a difference');
  await page.close();

  run('krok-view', WALK, WALK, '--difference', '-o', made('same.html'));
  const same = await open('same.html');
  const none = (await pixels(same, 'no difference')).filter((pixel) => saturation(pixel) > 60);
  expect(none.length === 0, `equal motions have ${none.length} coloured pixels`);
  await same.close();
}

// Two glTF files that differ by 100 mm: the second's mesh is dark red, with names as in the file.
async function differenceOfGlbsIsColoured() {
  run('krok-body', WALK, '-o', made('walker.model'));
  run('krok-skin', made('walker.model'), WALK, '-o', made('before.glb'));
  run('krok-skin', made('walker.model'), made('moved.bvh'), '-o', made('after.glb'));
  run('krok-view', made('before.glb'), made('after.glb'), '--difference', '-o', made('glbs.html'));
  const page = await open('glbs.html');
  const { scale, distances } = await page.evaluate(() => krokView.difference());
  expect(Math.abs(scale - 0.1) < 1e-6, `the ramp of the files ends at ${scale} m`);
  expect(distances.length > 1000 && distances.every((distance) => Math.abs(distance - 0.1) < 1e-4),
    'a vertex is not 100 mm from its partner');
  const coloured = (await pixels(page, 'difference of files')).filter((pixel) => saturation(pixel) > 60);
  const red = coloured.filter((pixel) => near(hue(pixel), 342, 14));
  expect(coloured.length > 4000 && red.length > 0.97 * coloured.length, `${red.length} of ${coloured.length} pixels are dark red`);
  await drawn(page, () => press(page, 'd'));
  const without = (await pixels(page, 'files')).filter((pixel) => near(hue(pixel), 342, 14) && saturation(pixel) > 60);
  expect(without.length === 0, `without the difference ${without.length} pixels are dark red`);
  await page.close();
}

// One vertex of 10,000 that is 50 mm off: the scale ends there, and the rest has no colour.
async function oneVertexIsFound() {
  const bytes = readFileSync(made('before.glb'));
  const length = bytes.readUInt32LE(12);
  const { meshes, accessors, bufferViews } = JSON.parse(bytes.subarray(20, 20 + length));
  const accessor = accessors[meshes[0].primitives[0].attributes.POSITION];
  const view = bufferViews[accessor.bufferView];
  const vertex = 4321;
  const at = 20 + length + 8 + (view.byteOffset ?? 0) + (accessor.byteOffset ?? 0) + vertex * (view.byteStride ?? 12);
  expect(accessor.count > 2 * vertex, `the body has only ${accessor.count} vertices`);
  bytes.writeFloatLE(bytes.readFloatLE(at) + 0.05, at);
  writeFileSync(made('vertex.glb'), bytes);
  run('krok-view', made('before.glb'), made('vertex.glb'), '--difference', '-o', made('vertex.html'));
  const page = await open('vertex.html');
  const { scale, distances } = await page.evaluate(() => krokView.difference());
  expect(Math.abs(scale - 0.05) < 0.0051, `the ramp ends at ${scale} m for a vertex 50 mm off`);
  expect(distances.filter((distance) => distance > 0.001).length === 1, 'not one vertex differs');
  expect((await page.locator('#difference').textContent()).includes(`vertex ${vertex}`), 'the vertex is not named');
  await page.close();
}

// "Go to the largest" is what krok-diff finds, at a moment that samples would pass by; the files are
// opened as --compress wrote them.
async function largestIsKrokDiffs() {
  const lines = readFileSync(WALK, 'utf8').split('\n');
  const spike = lines.indexOf('MOTION') + 3 + 101;
  lines[spike] = lines[spike].trim().split(/\s+/).map((value, i) => (i === 1 ? String(Number(value) + 7) : value)).join(' ');
  writeFileSync(made('spike.bvh'), lines.join('\n'));
  run('krok-skin', made('walker.model'), WALK, '--compress', '-o', made('packed.glb'));
  run('krok-skin', made('walker.model'), made('spike.bvh'), '--compress', '-o', made('spike.glb'));
  run('krok-view', made('packed.glb'), made('spike.glb'), '--difference', '-o', made('spike.html'));
  let report = {};
  try {
    run('krok-diff', made('packed.glb'), made('spike.glb'), '--match', 'order', '--json');
  } catch (differs) {
    report = JSON.parse(differs.stdout);
  }
  const { largest, where: { time } } = report.result.measures.find((one) => one.what === 'positions');
  const page = await open('spike.html');
  const text = await page.locator('#difference-worst').textContent();
  const [, millimetres, at] = text.match(/([\d.]+) mm, ([\d.]+) s/) ?? [];
  expect(Math.abs(millimetres - 1000 * largest) < 0.06 && Math.abs(at - time) < 0.006, `${text}, krok-diff: ${largest} m at ${time} s`);
  await page.locator('#difference-worst').click();
  const now = await page.locator('#difference').textContent();
  expect(Math.abs(now.match(/([\d.]+) mm/)?.[1] - 1000 * largest) < 0.11, `there the page has ${now}`);
  await page.close();
}

// Joints of a glTF file have the file's names, colons and all, which krok-ik wants.
async function namesOfGlbsAreTheFiles() {
  const walk = readFileSync(WALK, 'utf8').replace(/(ROOT|JOINT) /g, '$1 hero:');
  writeFileSync(made('named.bvh'), walk);
  run('krok-export', made('named.bvh'), '-o', made('named.glb'));
  run('krok-view', made('named.glb'), '-o', made('named.html'));
  const page = await open('named.html');
  const names = await page.evaluate(() => krokView.joints().map(({ name }) => name));
  expect(names.length > 10 && names.every((name) => name.startsWith('hero:')), `joints are called ${names.slice(0, 3)}`);
  await page.close();
}

// Fractions of the canvas that the joints of all files are at: {left, right, top, bottom}.
const extent = (page, files) => page.evaluate((count) => {
  const canvas = document.getElementById('view');
  const all = Array.from({ length: count }, (_, item) => {
    const [dx, dy, dz] = krokView.offset(item);
    return krokView.joints(item).map(({ position: [x, y, z] }) => krokView.project(x + dx, y + dy, z + dz));
  }).flat();
  if (all.includes(null)) return null;
  const xs = all.map(({ x }) => x / canvas.clientWidth);
  const ys = all.map(({ y }) => y / canvas.clientHeight);
  return { left: Math.min(...xs), right: Math.max(...xs), top: Math.min(...ys), bottom: Math.max(...ys) };
}, files);

async function framesWhatIsShown() {
  // Six that go six ways, each another far.
  const names = Array.from({ length: 6 }, (_, i) => {
    changedWalk(`way${i}.bvh`, ([x, y, z, ...rest], frame) => [
      x + Math.sin(i) * frame * 1.5 * i, y, z + Math.cos(i) * frame * 1.5 * i, ...rest]);
    return made(`way${i}.bvh`);
  });
  run('krok-view', ...names, '--layout', 'apart', '-o', made('six.html'));
  const six = await open('six.html');
  for (const share of [0, 0.3, 0.6, 1]) {
    await six.evaluate((part) => krokView.setTime(part * krokView.duration), share);
    const at = await extent(six, 6);
    const inside = at && at.left > 0 && at.right < 1 && at.top > 0 && at.bottom < 1;
    expect(inside, `at ${share} of the time six motions reach ${JSON.stringify(at)} of the picture`);
  }
  expect((await six.evaluate(() => krokView.bodies())).every(Boolean), 'a motion of six has no body');
  await six.close();

  // One that runs far is not a speck, and is followed.
  changedWalk('far.bvh', ([x, y, z, ...rest], frame) => [x, y, z + frame * 12, ...rest]);
  run('krok-view', made('far.bvh'), '-o', made('far.html'));
  const far = await open('far.html');
  for (const share of [0, 0.5, 1]) {
    await far.evaluate((part) => krokView.setTime(part * krokView.duration), share);
    const { top, bottom, left, right } = await extent(far, 1);
    expect(bottom - top > 0.5 && top > 0 && bottom < 1 && left > 0 && right < 1,
      `at ${share} of the time a runner is from ${top} to ${bottom} of the picture`);
  }
  await far.evaluate(() => krokView.setTime(1));

  const direction = () => far.evaluate(() => {
    const { position, target } = krokView.camera();
    const along = position.map((x, i) => x - target[i]);
    const length = Math.hypot(...along);
    return { along: along.map((x) => x / length), length };
  });
  for (const [key, axis] of [['1', 2], ['3', 0], ['7', 1]]) {
    await drawn(far, () => far.keyboard.press(key));
    const { along } = await direction();
    expect(along[axis] > 0.999, `${key} looks from ${along}`);
  }
  await drawn(far, () => far.keyboard.press('1'));
  // Drags that would turn the camera below the floor.
  const { x, y, width, height } = await far.locator('#view').boundingBox();
  for (let i = 0; i < 2; ++i) {
    await far.mouse.move(x + width / 2, y + height - 40);
    await far.mouse.down();
    await far.mouse.move(x + width / 2, y + 40, { steps: 8 });
    await far.mouse.up();
    const { position } = await far.evaluate(() => krokView.camera());
    expect(position[1] > 0, `the camera is at a height of ${position[1]} m`);
  }
  await drawn(far, () => far.keyboard.press('h'));
  const { length: all } = await direction();
  await far.getByLabel('Joint', { exact: true }).selectOption({ label: 'RightHand' });
  await drawn(far, () => far.getByRole('button', { name: 'Frame selected' }).click());
  const { length: close } = await direction();
  const { target } = await far.evaluate(() => krokView.camera());
  const hand = await far.evaluate(() => krokView.selected.position);
  expect(close < all / 3, `a hand is framed from ${close} m, all from ${all} m`);
  expect(Math.hypot(...target.map((place, i) => place - hand[i])) < 0.05, `framing a hand at ${hand} aims at ${target}`);
  await far.close();
}

// A root that stays on the floor where the walk began, above hips that move.
function rootOnFloor(name) {
  const [head, rows] = readFileSync(WALK, 'utf8').split(/(?<=Frame Time: .*\n)/);
  const tree = head.slice(head.indexOf('ROOT Hips'), head.indexOf('MOTION')).replace('ROOT', 'JOINT');
  const channels = 'CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation';
  writeFileSync(made(name), `HIERARCHY\nROOT Reference\n{\nOFFSET 0 0 0\n${channels}\n${tree}}\n${head.slice(head.indexOf('MOTION'))}`
    + rows.trimEnd().split('\n').map((row) => `0 0 0 0 0 0 ${row.trim()}\n`).join(''));
}

async function rootIsNoBone() {
  rootOnFloor('floor.bvh');
  const blue = async (file, name) => {
    run('krok-view', file, '--body', 'none', '-o', made(`${name}.html`));
    const page = await open(`${name}.html`);
    await drawn(page, () => page.evaluate(() => krokView.setTime(2)));
    const count = (await pixels(page, name)).filter(([r, , b]) => b > r + 70).length;
    await page.close();
    return count;
  };
  const plain = await blue(WALK, 'hips_as_root');
  const floor = await blue(made('floor.bvh'), 'root_on_floor');
  expect(Math.abs(floor - plain) < 0.2 * plain, `a root on the floor makes ${plain} blue pixels ${floor}`);
}

// Colours of a column of the lanes' canvas at a time.
const laneColours = (page, time) => page.evaluate((at) => {
  const canvas = document.getElementById('lanes');
  const ratio = devicePixelRatio;
  const pen = new OffscreenCanvas(canvas.width, canvas.height).getContext('2d', { willReadFrequently: true });
  pen.drawImage(canvas, 0, 0);
  const { data } = pen.getImageData(Math.round(krokView.placeOfTime(at) * ratio), 0, 1, canvas.height);
  return Array.from({ length: canvas.height / ratio }, (_, y) => [...data.slice(y * ratio * 4, y * ratio * 4 + 3)]);
}, time);
const isBlue = ([r, , b]) => b > r + 100;
const isOrange = ([r, , b]) => r > b + 100;

async function timelineWorks() {
  run('krok-import', WALK, '-o', made('walk.anim'));
  run('krok-keys', made('walk.anim'), '-q', '-o', made('walk.keys.json'));
  const { contacts, keytimes } = JSON.parse(readFileSync(made('walk.keys.json'), 'utf8'));
  run('krok-view', made('walk.anim'), '-o', made('time.html'));
  const page = await open('time.html');
  for (const { joint, start, end } of contacts) {
    const colours = await laneColours(page, (start + end) / 2);
    const shown = joint.startsWith('Left') ? isBlue : isOrange;
    expect(colours.some(shown), `no bar is at the middle of the contact of ${joint} from ${start} s`);
  }
  // Events: the next and the one before.
  await press(page, 'Home', '.');
  const times = keytimes.map(({ time }) => time).filter((time) => time > 1e-3);
  expect(Math.abs(await page.evaluate(() => krokView.time) - times[0]) < 1e-3, 'the next event is not the first keytime');
  await press(page, '.', ',');
  expect(Math.abs(await page.evaluate(() => krokView.time) - times[0]) < 1e-3, 'the event before is not the one before');

  // Zoom keeps the play head in view.
  const wide = () => page.evaluate(() => krokView.timeView);
  const [from, to] = await wide();
  await press(page, 'z', 'z');
  const [low, high] = await wide();
  expect(Math.abs((high - low) * 4 - (to - from)) < 1e-6 && low <= times[0] && high >= times[0], `zoomed in, ${low} to ${high} s are shown`);
  await page.getByRole('button', { name: 'Show the whole time line' }).click();
  expect((await wide()).join() === [from, to].join(), 'the whole time line is not shown again');
  // A press on the ruler goes there.
  const { x, y } = await page.locator('#time').boundingBox();
  await page.mouse.click(x + await page.evaluate(() => krokView.placeOfTime(1.5)), y + 8);
  expect(Math.abs(await page.evaluate(() => krokView.time) - 1.5) < 0.02, 'a press on the ruler does not go there');

  // A range, by keys, is what is played.
  await page.evaluate(() => krokView.setTime(0.5));
  await press(page, '[');
  await page.evaluate(() => krokView.setTime(0.7));
  await press(page, ']', 'Home');
  expect((await page.evaluate(() => krokView.range)).map((time) => time.toFixed(3)).join() === '0.500,0.700', 'keys set no range');
  const seen = await page.evaluate(async () => {
    document.activeElement?.blur();
    document.dispatchEvent(new KeyboardEvent('keydown', { key: ' ', bubbles: true }));
    const all = [];
    // Until it has begun again twice; a loaded machine takes its time.
    for (let back = 0, i = 0; back < 2 && i < 2000; ++i) {
      await new Promise(requestAnimationFrame);
      all.push(krokView.time);
      if (i > 0 && all[i] < all[i - 1]) ++back;
    }
    document.dispatchEvent(new KeyboardEvent('keydown', { key: ' ', bubbles: true }));
    return all;
  });
  const back = seen.filter((time, i) => i > 0 && time < seen[i - 1]).length;
  expect(Math.min(...seen) >= 0.5 - 1e-6 && Math.max(...seen) <= 0.7 + 1e-6 && back > 0,
    `the range plays from ${Math.min(...seen)} to ${Math.max(...seen)} s and begins again ${back} times`);
  await press(page, '\\');
  expect(await page.evaluate(() => krokView.range) === null, 'the range is not cleared');
  // By Shift and dragging on the ruler.
  const [a, b] = await page.evaluate(() => [1, 2].map((time) => krokView.placeOfTime(time)));
  await page.keyboard.down('Shift');
  await page.mouse.move(x + a, y + 8);
  await page.mouse.down();
  await page.mouse.move(x + b, y + 8, { steps: 3 });
  await page.mouse.up();
  await page.keyboard.up('Shift');
  const dragged = await page.evaluate(() => krokView.range);
  expect(Math.abs(dragged[0] - 1) < 0.02 && Math.abs(dragged[1] - 2) < 0.02, `dragging makes the range ${dragged}`);
  await contactsAreOnTheFoot(page, contacts);
  return page;
}

// On the body, the foot in contact is red, and it alone.
async function contactsAreOnTheFoot(page, contacts) {
  const { joint, start, end } = contacts.find((contact) => /Foot$/.test(contact.joint) && contact.start > 0.5);
  const redAt = async (time) => {
    await drawn(page, () => page.evaluate((at) => krokView.setTime(at), time));
    return page.evaluate(() => krokView.joints()).then(async (joints) => {
      const foot = joints.find(({ name }) => name === joint).position;
      const at = await page.evaluate((place) => krokView.project(...place), foot);
      const width = await page.evaluate(() => document.getElementById('view').clientWidth);
      const list = await pixels(page, `contact ${time}`);
      const red = list.map(([r, g, b], i) => (r > g + 70 && r > b + 70 ? i : -1)).filter((i) => i >= 0);
      const far = red.filter((i) => Math.hypot((i % width) - at.x, Math.floor(i / width) - at.y) > 90);
      return { red: red.length, far: far.length };
    });
  };
  const touching = await redAt((start + end) / 2);
  expect(touching.red > 60 && touching.far < 0.5 * touching.red, `in contact ${touching.red} pixels are red, ${touching.far} far from ${joint}`);
}

// A clicked joint's values against krok-export's positions, and a rotation that is known.
async function jointValuesAgree(page) {
  run('krok-export', made('walk.anim'), '--format', 'csv', '-o', made('walk.csv'));
  const rows = readFileSync(made('walk.csv'), 'utf8').trim().split('\n').map((row) => row.split(','));
  const placeOf = (frame) => rows.find(([f, , name]) => f === String(frame) && name === 'LeftHand').slice(3).map(Number);
  const frame = 80;
  await drawn(page, () => page.evaluate((time) => krokView.setTime(time), frame / RATE));
  const at = await page.evaluate(() => {
    const { position } = krokView.joints().find(({ name }) => name === 'LeftHand');
    return krokView.project(...position);
  });
  const box = await page.locator('#view').boundingBox();
  await page.mouse.click(box.x + at.x, box.y + at.y);
  const values = await page.evaluate(() => krokView.selected);
  expect(values?.joint === 'LeftHand', `a click on the left hand selects ${values?.joint}`);
  const [before, here, after] = [frame - 1, frame, frame + 1].map(placeOf);
  expect(Math.hypot(...here.map((x, i) => x - values.position[i])) < 1e-3, `LeftHand is at ${values.position}, exported at ${here}`);
  const speed = (Math.hypot(...after.map((x, i) => x - before[i])) * RATE) / 2;
  expect(Math.abs(values.speed - speed) < 0.02 * speed + 0.01, `LeftHand has ${values.speed} m/s, by its positions ${speed}`);
  await page.context().grantPermissions(['clipboard-read', 'clipboard-write']);
  await page.getByRole('button', { name: 'Copy the values' }).click();
  await until(page, () => document.getElementById('said').textContent === 'Values copied');
  const copied = (await page.evaluate(() => navigator.clipboard.readText())).split('\n').map((line) => line.split('\t'));
  expect(copied[0].length === copied[1].length && copied[1][1] === 'LeftHand'
    && Math.abs(Number(copied[1][4]) - here[1]) < 1e-3, `copied is ${copied}`);
  // Its curves are under the lanes, and go when it is no longer selected.
  const high = () => page.evaluate(() => document.getElementById('lanes').clientHeight);
  const withCurves = await high();
  await press(page, 'Escape');
  expect(withCurves - await high() > 120 && await page.evaluate(() => krokView.selected) === null, 'Escape does not deselect');

  writeFileSync(made('bend.bvh'), `HIERARCHY\nROOT Hips\n{\nOFFSET 0 0 0\nCHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation
JOINT Spine\n{\nOFFSET 0 50 0\nCHANNELS 3 Zrotation Xrotation Yrotation\nEnd Site\n{\nOFFSET 0 50 0\n}\n}\n}\nMOTION\nFrames: 2\nFrame Time: 0.0333333
0 100 0 0 0 0 0 30 0\n0 100 0 0 0 0 0 30 0\n`);
  run('krok-view', made('bend.bvh'), '-o', made('bend.html'), '-q');
  const bend = await open('bend.html');
  await bend.getByLabel('Joint', { exact: true }).selectOption({ label: 'Spine' });
  const { angles, turn } = await bend.evaluate(() => krokView.selected);
  const degrees = angles.map((angle) => (angle * 180) / Math.PI);
  expect(Math.abs(Math.abs(degrees[0]) - 30) < 0.05 && Math.abs(degrees[1]) < 0.05 && Math.abs(degrees[2]) < 0.05
    && Math.abs(turn - 30) < 0.05, `a turn of 30 degrees about x is ${degrees}, ${turn}`);
  await bend.close();
}

// A node that moves in two animations, keyed at 30 frames per second.
function twoClips() {
  const floats = (values) => Buffer.from(new Float32Array(values).buffer);
  const times = Array.from({ length: 31 }, (_, i) => i / 30);
  const parts = [floats([0, 0, 0, 1, 0, 0, 0, 1, 0]), floats(times), floats(times.flatMap((t) => [t, 0, 0])),
    floats(times.slice(0, 16)), floats(times.slice(0, 16).flatMap((t) => [0, 2 * t, 0]))];
  let offset = 0;
  const bufferViews = parts.map((part) => {
    offset += part.length;
    return { buffer: 0, byteOffset: offset - part.length, byteLength: part.length };
  });
  const accessor = (bufferView, count, type, min, max) => ({ bufferView, componentType: 5126, count, type, min, max });
  const animation = (name, input, output) => ({ name, samplers: [{ input, output }], channels: [{ sampler: 0, target: { node: 0, path: 'translation' } }] });
  return JSON.stringify({
    asset: { version: '2.0' }, scenes: [{ nodes: [0] }], nodes: [{ mesh: 0, name: 'Thing' }],
    meshes: [{ primitives: [{ attributes: { POSITION: 0 } }] }],
    accessors: [accessor(0, 3, 'VEC3', [0, 0, 0], [1, 1, 0]), accessor(1, 31, 'SCALAR', [0], [1]), accessor(2, 31, 'VEC3'),
      accessor(3, 16, 'SCALAR', [0], [0.5]), accessor(4, 16, 'VEC3')],
    animations: [animation('across', 1, 2), animation('up', 3, 4)],
    bufferViews, buffers: [{ byteLength: offset, uri: `data:application/octet-stream;base64,${Buffer.concat(parts).toString('base64')}` }],
  });
}

async function clipsAreChosen() {
  writeFileSync(made('clips.gltf'), twoClips());
  run('krok-view', made('clips.gltf'), '-o', made('clips.html'));
  const page = await open('clips.html');
  const state = () => page.evaluate(() => [krokView.rate, krokView.duration]);
  const [rate, duration] = await state();
  expect(rate === 30 && Math.abs(duration - 1) < 1e-6, `the first clip has ${rate} fps and ${duration} s`);
  await press(page, 'ArrowRight');
  expect(Math.abs(await page.evaluate(() => krokView.time) - 1 / 30) < 1e-6, 'a step of 30 fps is not a thirtieth');
  await page.getByLabel('Clip of clips.gltf').selectOption({ label: 'up' });
  expect(Math.abs((await state())[1] - 0.5) < 1e-6, `the second clip lasts ${(await state())[1]} s`);
  await page.close();
  run('krok-view', made('clips.gltf'), '--clip', 'up', '-o', made('up.html'));
  const up = await open('up.html');
  expect(Math.abs(await up.evaluate(() => krokView.duration) - 0.5) < 1e-6, '--clip up does not play it first');
  await up.close();
}

// Takes of a session that differ in the middle of long names can be distinguished; what belongs to a joint
// stays in view at 1280 x 720, however many contacts are under it.
async function namesAndValuesStayInView() {
  const names = ['knock_down', 'knock_back', 'slide'].map((middle) => `capture_session_2026_hero_${middle}_front_01.bvh`);
  for (const name of names) copyFileSync(WALK, made(name));
  run('krok-view', ...names.map(made), '--contacts', 'find', '-o', made('session.html'));
  const page = await open('session.html', { viewport: { width: 1280, height: 720 } });
  const shown = await page.locator('#items .name').evaluateAll((buttons) => buttons.map(({ firstChild }) => {
    const cut = [...firstChild.children].some((part) => part.scrollWidth > part.clientWidth);
    return cut ? 'cut' : firstChild.textContent;
  }));
  expect(new Set(shown).size === 3 && !shown.includes('cut'), `the names shown are ${shown}`);
  await drawn(page, () => page.locator('#joint').selectOption({ index: 3 }));
  const panel = await page.locator('#panel').boundingBox();
  const speed = await page.locator('#joint-speed').boundingBox();
  expect(speed.y >= panel.y && speed.y + speed.height <= panel.y + panel.height, 'the values of a joint are out of view');
  const scrolled = await page.locator('#time').evaluate((time) => time.scrollTop);
  expect(scrolled === 0 && await page.evaluate(() => krokView.curvesEnd) <= await page.locator('#time').evaluate((time) => time.clientHeight),
    'the curves of a joint are out of view');
  await page.close();
}

async function longListsStayQuick() {
  mkdirSync(made('takes'));
  run('krok-edit', made('walk.anim'), '--to', '0.3s', '-o', made('short.anim'));
  for (let i = 0; i < 200; ++i) copyFileSync(made('short.anim'), made(`takes/take_${String(i).padStart(3, '0')}.anim`));
  run('krok-view', made('takes'), '-o', made('takes.html'));
  const page = await open('takes.html');
  const opened = () => page.evaluate(() => krokView.opened());
  expect((await opened()).join() === '0', `of 200 files ${(await opened()).length} are opened at first`);
  const rows = () => page.locator('#items li').count();
  expect(await rows() < 40, `${await rows()} rows of 200 are made`);
  const box = async (place) => (await place.boundingBox()) ?? { y: Infinity, height: 0 };
  for (const place of [page.getByLabel('Body (b)'), page.getByLabel('Joint', { exact: true }), page.getByRole('button', { name: 'Frame all' })]) {
    const { y, height } = await box(place);
    expect(y + height <= 600, 'a control is out of view beside a list of 200 files');
  }
  await page.locator('#items-box').evaluate((list) => { list.scrollTop = list.scrollHeight; });
  await until(page, () => document.querySelector('#items').textContent.includes('take_199'));
  expect(await rows() < 40, `${await rows()} rows are made at the end`);
  await page.getByLabel('Filter files').fill('take_01');
  expect(await rows() <= 10 && /10 found/.test(await page.locator('#file-count').textContent()), `the filter finds ${await rows()} files`);
  await drawn(page, () => page.getByRole('button', { name: /^take_017/ }).click());
  expect((await opened()).join() === '0,17', `a click opens ${await opened()}`);
  expect(await page.locator('#items input:checked').count() === 1, 'a click does not show one file alone');
  await axeFinds(page, 'a long list');
  await page.close();
}

async function savesAndLinks(page) {
  await page.evaluate(() => krokView.setRange(0.2, 0.5));
  await page.evaluate(() => krokView.setTime(0.25));
  const saved = async (act, ending) => {
    const [download] = await Promise.all([page.waitForEvent('download'), act()]);
    expect(download.suggestedFilename().endsWith(ending), `${download.suggestedFilename()} is saved`);
    return readFileSync(await download.path());
  };
  const picture = await saved(() => page.getByRole('button', { name: 'Save a screenshot' }).click(), '_0015.png');
  expect(picture.subarray(1, 4).toString() === 'PNG' && picture.length > 10000, `a screenshot has ${picture.length} bytes`);
  const video = await saved(() => page.getByRole('button', { name: 'Record a video' }).click(), '.webm');
  expect(video.readUInt32BE(0) === 0x1a45dfa3 && video.length > 5000, `a video has ${video.length} bytes`);

  await press(page, '3');
  await page.evaluate(() => krokView.setTime(0.75));
  await page.getByLabel('Joint', { exact: true }).selectOption({ label: 'Head' });
  const state = (where) => where.evaluate(() => JSON.stringify(
    [krokView.time.toFixed(3), ...Object.values(krokView.camera()).flat().map((x) => x.toFixed(2)), krokView.range, krokView.selected.joint]));
  await page.getByRole('button', { name: 'Copy a link to this view' }).click();
  await until(page, () => location.hash.length > 1);
  const link = await page.evaluate(() => navigator.clipboard.readText());
  expect(link === page.url(), `the link is ${link}`);
  const other = await page.context().newPage();
  await other.goto(link);
  await until(other, () => globalThis.krokView?.ready);
  expect(await state(other) === await state(page), `a link to ${await state(page)} shows ${await state(other)}`);
  await other.close();

  const before = await pixels(page, 'filled');
  await drawn(page, () => page.keyboard.press('w'));
  const wires = await pixels(page, 'wireframe');
  expect(wires.filter((pixel, i) => pixel.join() !== before[i].join()).length > 2000, 'w shows no wireframe');
  await drawn(page, () => page.keyboard.press('w'));
}

// Tab reaches every control that is shown.
async function tabReachesAll(page) {
  const controls = await page.evaluate(() => {
    document.activeElement?.blur();
    const all = [...document.querySelectorAll('button, input, select, summary, [tabindex="0"]')]
      .filter((each) => each.checkVisibility() && !each.disabled);
    all.forEach((each, i) => { each.dataset.control = i; });
    return all.length;
  });
  const reached = new Set();
  for (let i = 0; i < controls + 5; ++i) {
    await page.keyboard.press('Tab');
    reached.add(await page.evaluate(() => document.activeElement.dataset.control));
  }
  reached.delete(undefined);
  expect(reached.size === controls, `Tab reaches ${reached.size} of ${controls} controls`);
}

await check(90, async () => {
  await differenceIsColoured();
  await differenceOfGlbsIsColoured();
  await namesAndValuesStayInView();
  await oneVertexIsFound();
  await largestIsKrokDiffs();
  await namesOfGlbsAreTheFiles();
  await framesWhatIsShown();
  await rootIsNoBone();
  const page = await timelineWorks();
  await jointValuesAgree(page);
  await savesAndLinks(page);
  await axeFinds(page, 'light');
  await tabReachesAll(page);
  await clipsAreChosen();
  await longListsStayQuick();
  const dark = await open('moved.html', { colorScheme: 'dark' });
  await axeFinds(dark, 'dark');
});
