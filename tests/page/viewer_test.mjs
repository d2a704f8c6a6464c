// Opens pages of krok-view in headless Chromium and holds them against the library's own figures.
// Usage: node viewer_test.mjs BIN_FOLDER SOURCE_FOLDER. Exit code 1 and a line for each fault.
// With KROK_PAGE_SHOTS=FOLDER the screenshots are kept there.

import { readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { check, drawn, expect, made, open, run, until } from './checks.mjs';

const source = process.argv[3];

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

// Of a picture of the canvas: how many different colours it has, a blank one a few, how many pixels
// are as blue as the first actor's bones (its body is paler), and as pink as the first trail.
async function look(page, name) {
  const picture = await page.locator('#view').screenshot();
  if (process.env.KROK_PAGE_SHOTS) {
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
    const pink = pixels.filter((pixel) => (pixel & 0xff) - ((pixel >> 8) & 0xff) > 90 && ((pixel >> 16) & 0xff) > 80).length;
    return { colours: new Set(pixels).size, blue, pink };
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
      if (!expected) expect(false, `${motion}: no joint is called ${name}`);
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

// Keys turn the switches beside the picture, and what is shown with them where it shows at once.
async function keysTurnSwitches(page, keys) {
  for (const [key, name, shows = true] of keys) {
    const box = page.getByLabel(`${name} (${key})`);
    const before = await box.isChecked();
    const picture = (await page.locator('#view').screenshot()).toString('base64');
    const press = () => page.keyboard.press(key);
    await (shows ? drawn(page, press) : press());
    expect((await box.isChecked()) === !before, `${key} does not turn the switch ${name}`);
    const changed = (await page.locator('#view').screenshot()).toString('base64') !== picture;
    expect(changed || !shows, `${key} does not change the picture`);
    await (shows ? drawn(page, press) : press());
    expect((await box.isChecked()) === before, `${key} does not turn the switch ${name} back`);
  }
}

// The largest distance between joints of one name, as the page tells it, against the library's.
async function differenceAgrees(page, one, other, rate) {
  const frame = 40;
  const a = positionsOf(one)[frame];
  const b = positionsOf(other)[frame];
  let largest = { distance: -1 };
  for (const name of Object.keys(a)) {
    if (!b[name]) continue;
    const distance = Math.hypot(...a[name].map((x, i) => x - b[name][i]));
    if (distance > largest.distance) largest = { name, distance };
  }
  await drawn(page, () => page.evaluate((time) => krokView.setTime(time), frame / rate));
  const text = await page.locator('#difference').textContent();
  const told = text.match(/max ([\d.e+-]+) (mm|cm|m) at (.+)/);
  expect(told !== null, `no difference is told: ${text}`);
  if (!told) return;
  const metres = Number(told[1]) * { mm: 1e-3, cm: 1e-2, m: 1 }[told[2]];
  expect(Math.abs(metres - largest.distance) < 0.01 * largest.distance + 1e-4,
    `the page tells ${text}, the library ${largest.distance} m at ${largest.name}`);
  expect(told[3] === largest.name, `the page tells ${told[3]}, the library ${largest.name}`);
}

// Every control that can be reached has a name that a screen reader can say.
async function controlsHaveNames(page) {
  const nameless = await page.evaluate(() =>
    [...document.querySelectorAll('button, input, select')]
      .filter((e) => !(e.getAttribute('aria-label') || e.textContent.trim() || e.labels?.length))
      .map((e) => e.outerHTML.slice(0, 80)));
  expect(nameless.length === 0, `controls without a name: ${nameless.join(' ')}`);
}

// A square of one metre that faces +Z, with a picture of 2 x 2 pixels on it: red, green; blue, white.
// Drawn as it is whatever the light.
function squareWithPicture() {
  const floats = (...values) => Buffer.from(new Float32Array(values).buffer);
  const parts = [
    floats(0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0),
    floats(0, 1, 1, 1, 1, 0, 0, 0),
    Buffer.from(new Uint32Array([0, 1, 2, 0, 2, 3]).buffer),
  ];
  const data = Buffer.concat(parts).toString('base64');
  const png = 'iVBORw0KGgoAAAANSUhEUgAAAAIAAAACCAIAAAD91JpzAAAAFklEQVR42mP4z8DA8J+BkYHh////DAAe9gT9CzF8CQAAAABJRU5ErkJggg==';
  let offset = 0;
  const views = parts.map((part) => {
    offset += part.length;
    return { buffer: 0, byteOffset: offset - part.length, byteLength: part.length };
  });
  return JSON.stringify({
    asset: { version: '2.0' },
    extensionsUsed: ['KHR_materials_unlit'],
    scenes: [{ nodes: [0] }],
    nodes: [{ mesh: 0 }],
    meshes: [{ primitives: [{ attributes: { POSITION: 0, TEXCOORD_0: 1 }, indices: 2, material: 0 }] }],
    materials: [{
      name: 'Flag',
      doubleSided: true,
      pbrMetallicRoughness: { baseColorTexture: { index: 0 } },
      extensions: { KHR_materials_unlit: {} },
    }],
    textures: [{ source: 0, sampler: 0 }],
    samplers: [{ magFilter: 9728 }],
    images: [{ uri: `data:image/png;base64,${png}` }],
    accessors: [
      { bufferView: 0, componentType: 5126, count: 4, type: 'VEC3', min: [0, 0, 0], max: [1, 1, 0] },
      { bufferView: 1, componentType: 5126, count: 4, type: 'VEC2' },
      { bufferView: 2, componentType: 5125, count: 6, type: 'SCALAR' },
    ],
    bufferViews: views,
    buffers: [{ byteLength: offset, uri: `data:application/octet-stream;base64,${data}` }],
  });
}

// Where on a picture of the canvas red, green and blue are: how many pixels, their mean place.
async function colourPlaces(page) {
  const picture = await page.locator('#view').screenshot();
  return page.evaluate(async (base64) => {
    const bytes = Uint8Array.from(atob(base64), (c) => c.charCodeAt(0));
    const image = await createImageBitmap(new Blob([bytes], { type: 'image/png' }));
    const pen = new OffscreenCanvas(image.width, image.height).getContext('2d');
    pen.drawImage(image, 0, 0);
    const { data } = pen.getImageData(0, 0, image.width, image.height);
    const places = [0, 1, 2].map(() => ({ count: 0, x: 0, y: 0 }));
    for (let i = 0; i < data.length; i += 4) {
      const strongest = [0, 1, 2].find((k) => [0, 1, 2].every((o) => o === k || data[i + k] > data[i + o] + 120));
      if (strongest === undefined) continue;
      const place = places[strongest];
      place.count += 1;
      place.x += (i / 4) % image.width;
      place.y += Math.floor(i / 4 / image.width);
    }
    return places.map(({ count, x, y }) => ({ count, x: x / count, y: y / count }));
  }, picture.toString('base64'));
}

// The picture lies on the character as it should: not upside down, not mirrored.
async function pictureLiesRight(page) {
  const [red, green, blue] = await colourPlaces(page);
  for (const { count } of [red, green, blue]) expect(count > 500, `${count} pixels of a picture's colour`);
  expect(red.x < green.x - 20 && Math.abs(red.y - green.y) < blue.y - red.y,
    `red at ${red.x}, ${red.y}, green at ${green.x}, ${green.y}`);
  expect(red.y < blue.y - 20 && Math.abs(red.x - blue.x) < 20,
    `red at ${red.x}, ${red.y}, blue at ${blue.x}, ${blue.y}`);
  await drawn(page, () => page.keyboard.press('s'));
  const [through] = await colourPlaces(page);
  expect(through.count === 0, 'the skeleton does not show through a body with a material');
  await drawn(page, () => page.keyboard.press('s'));
  expect((await colourPlaces(page))[0].count === red.count, 'a material is not as it was before');
}

// Goals of krok-ik on its result: the places, chains and residuals are those of its report.
async function goalsAgree(page, motion, report, rate) {
  const frame = 60;
  const place = positionsOf(motion)[frame].RightHand;
  await drawn(page, () => page.evaluate((time) => krokView.setTime(time), frame / rate));
  const [hand, head, later] = await page.evaluate(() => krokView.goals());
  const apart = (a, b) => Math.hypot(...a.map((x, i) => x - b[i]));
  expect(hand.name === 'rail' && hand.kind === 'position' && hand.strength === 1, `the first goal is ${JSON.stringify(hand)}`);
  expect(apart(hand.from, place) < 1e-3, `the goal's line begins ${apart(hand.from, place)} m from the hand`);
  expect(apart(hand.to, [-3, 1.2, 1]) < 1e-6, `the goal is drawn at ${hand.to}`);
  const names = await page.evaluate(() => krokView.joints().map(({ name }) => name));
  const chain = hand.chain.map((joint) => names[joint]);
  expect(chain.join(' ') === 'RightHand RightForeArm RightArm', `the chain is ${chain}`);
  const told = report.result.goals.map((goal) => goal.frames.find((f) => f.frame === frame));
  expect(told[0].distance > 1 && Math.abs(hand.distance - told[0].distance) < 1e-4,
    `the page has ${hand.distance} m, krok-ik ${told[0].distance} m`);
  const degrees = (head.angle * 180) / Math.PI;
  expect(Math.abs(degrees - told[1].angle) < 6e-3, `the page has ${degrees} degrees, krok-ik ${told[1].angle}`);
  expect(later.strength === 0 && told[2] === undefined, 'a goal of later is active');
  const rows = await page.locator('#goals li').allTextContents();
  expect(rows[0] === `rail (position)off by ${(told[0].distance * 1000).toFixed(0)} mm`, `the legend has ${rows[0]}`);
  expect(/^Head \(look-at\)off by .*°$/.test(rows[1]), `the legend has ${rows[1]}`);
  expect(rows[2] === 'later (position)not active', `the legend has ${rows[2]}`);
  await keysTurnSwitches(page, [['o', 'Goals']]);
  await page.keyboard.press('o');
  expect(!(await page.locator('#goals-section').isVisible()), 'o does not hide the legend');
  await page.keyboard.press('o');
  await page.evaluate((time) => krokView.setTime(time), 80 / rate);
  expect(/fades, \d+ %/.test((await page.locator('#goals li').allTextContents())[0]), 'a goal that fades is not said to');
}

await check(80, async () => {
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
  await drawn(one, () => one.keyboard.press('s'));
  const both = await look(one, 'both');
  expect(both.blue > body.blue + 1000, `the body hides the skeleton: ${body.blue}, ${both.blue} blue pixels`);
  await drawn(one, () => one.keyboard.press('b'));
  const bones = await look(one, 'skeleton');
  expect(bones.colours > 300, 'the skeleton alone is blank');
  await drawn(one, () => one.keyboard.press('s'));
  const nothing = await look(one, 'nothing');
  expect(nothing.blue * 10 < bones.blue, `b or s hides nothing: ${bones.blue}, ${nothing.blue} blue pixels`);
  await drawn(one, () => one.keyboard.press('b'));
  await keysTurnSwitches(one, [['g', 'Ground'], ['f', 'Follow', false]]);
  await drawn(one, () => one.evaluate(() => krokView.setTime(1)));
  await one.getByLabel('Joint', { exact: true }).selectOption({ label: 'LeftHand' });
  await drawn(one, () => one.getByRole('button', { name: 'Trail', exact: true }).click());
  const remove = one.getByRole('button', { name: 'Remove the trail of LeftHand' });
  expect(await remove.count() === 1, 'a trail that was chosen is not listed');
  const trail = await look(one, 'trail');
  await drawn(one, () => remove.click());
  const bare = await look(one, 'trail gone');
  expect(trail.pink > 20 && bare.pink === 0, `a trail has ${trail.pink} pixels of its own colour, ${bare.pink} when removed`);

  const moving = await open('one.html', { reducedMotion: 'no-preference' });
  await until(moving, () => krokView.playing && krokView.time > 0.1);
  expect(await moving.getByRole('button', { name: 'Pause' }).count() === 1, 'the button of a moving page does not say Pause');
  expect(!(await one.evaluate(() => krokView.playing)), 'a page plays for those who want stillness');
  await moving.close();

  const two = await open('two.html');
  await jointsAgree(two, made('turn.anim'), 60, 1);
  await differenceAgrees(two, made('walk.anim'), made('turn.anim'), 60);
  await keysTurnSwitches(two, [['a', 'Side by side']]);
  await two.keyboard.press('d');
  expect(!(await two.locator('#difference').isVisible()), 'd does not hide the difference');
  const shownFiles = () => two.evaluate(() =>
    [...document.querySelectorAll('#items input')].map((box) => box.checked).join());
  await two.keyboard.press('PageDown');
  const first = await shownFiles();
  await two.keyboard.press('PageDown');
  const second = await shownFiles();
  await two.keyboard.press('PageUp');
  expect(first !== second && [first, second].sort().join(';') === 'false,true;true,false',
    `PageDown shows ${first}, then ${second}`);
  expect((await shownFiles()) === first, 'PageUp does not go back');

  writeFileSync(made('goals.json'), JSON.stringify({ schema: 'krok.goals/1', goals: [
    { name: 'rail', joint: 'RightHand', depth: 3, keys: [{ time: 0.9, target: [-3, 1.2, 1] }], to: 1.2 },
    { kind: 'look-at', joint: 'Head', keys: [{ time: 0.5, target: [2, 1.5, 4] }], to: 2 },
    { name: 'later', joint: 'LeftHand', keys: [{ time: 3, target: [1, 1, 1] }] },
  ] }));
  run('krok-ik', made('walk.anim'), '--goals', made('goals.json'), '-o', made('reach.anim'), `--json=${made('reach.json')}`);
  run('krok-view', made('reach.anim'), '--goals', made('goals.json'), '-o', made('goals.html'));
  const goals = await open('goals.html');
  await goalsAgree(goals, made('reach.anim'), JSON.parse(readFileSync(made('reach.json'), 'utf8')), 60);
  await look(goals, 'goals');

  // Rigid bodies on the motion that they were made for: translucent, and gone without the body.
  run('krok-ragdoll', made('walk.anim'), '--duration', '0.5s', '--save-bodies', made('walk.ragdoll.json'), '-o', made('fall.anim'));
  run('krok-view', made('fall.anim'), '--bodies', made('walk.ragdoll.json'), '-o', made('bodies.html'));
  const bodies = await open('bodies.html');
  await jointsAgree(bodies, made('fall.anim'), 60);
  const shown = await look(bodies, 'bodies');
  await drawn(bodies, () => bodies.keyboard.press('b'));
  const hidden = await look(bodies, 'without_bodies');
  expect(shown.colours > hidden.colours + 200, `bodies show ${shown.colours} colours, ${hidden.colours} without them`);

  const frozen = join(source, 'tests/golden/v1');
  run('krok-view', join(frozen, 'motion.anim'), join(frozen, 'camera.cam'), '-o', made('camera.html'));
  const flown = await open('camera.html');
  const fly = flown.getByRole('button', { name: /View .*camera/ });
  const seen = async () => (await flown.locator('#view').screenshot()).toString('base64');
  const before = await seen();
  await drawn(flown, () => flown.keyboard.press('c'));
  expect(await fly.getAttribute('aria-pressed') === 'true', 'c does not fly the camera');
  expect((await seen()) !== before, 'the flown camera shows what was shown before');
  await flown.keyboard.press('c');
  expect(await fly.getAttribute('aria-pressed') === 'false', 'c does not land again');

  run('krok-view', made('walk.anim'), '--contacts', 'find', '--body', 'none', '-o', made('keys.html'));
  const keyed = await open('keys.html');
  const bars = await keyed.evaluate(() => {
    const canvas = document.getElementById('lanes');
    const pixels = new Uint32Array(canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height).data.buffer);
    // In the colours of both sides, blue and orange.
    const coloured = pixels.filter((pixel) => Math.abs((pixel & 0xff) - ((pixel >> 16) & 0xff)) > 100 && pixel >>> 24 > 200);
    return coloured.length / pixels.length;
  });
  expect(bars > 0.1, `contacts fill ${bars} of the time line`);

  const glb = await open('glb.html');
  await jointsAgree(glb, made('walk.anim'), 60);
  expect((await look(glb, 'glb')).colours > 500, 'the page of a GLB is blank');

  writeFileSync(made('flag.gltf'), squareWithPicture());
  run('krok-import', made('flag.gltf'), '--save-character', made('flag.character'));
  run('krok-view', made('flag.character'), '-o', made('flag.html'));
  const flag = await open('flag.html');
  await look(flag, 'flag');
  await pictureLiesRight(flag);

  const phone = await open('one.html', { viewport: { width: 390, height: 700 }, hasTouch: true, isMobile: true, colorScheme: 'dark' });
  expect((await look(phone, 'phone')).colours > 500, 'the page on a phone is blank');
  const wide = await phone.evaluate(() => document.documentElement.scrollWidth);
  expect(wide <= 390, `on a phone the page is ${wide} pixels wide`);
});
