// The page that krok-diff --summary writes of two folders. Would fail if pictures were missing or not
// those of the file, the worst file was not the first, a link led nowhere, the page needed another
// file or a server, or axe-core found a fault. See checks.mjs.
// Usage: node summary_test.mjs BIN_FOLDER SOURCE_FOLDER.

import { existsSync, mkdirSync, readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { axeFinds, check, expect, made, open, run, until } from './checks.mjs';

const WALK = readFileSync(join(process.argv[3], 'samples/captures/walk.bvh'), 'utf8');

// The capture, moved aside by some centimetres.
function put(name, centimetres) {
  const [head, rows] = WALK.split(/(?<=Frame Time: .*\n)/);
  const moved = rows.trimEnd().split('\n').map((row) => {
    const [x, ...rest] = row.trim().split(/\s+/).map(Number);
    return [x + centimetres, ...rest].join(' ');
  });
  writeFileSync(made(name), `${head}${moved.join('\n')}\n`);
}

// krok-diff ends with 1 where something differs.
function differ(...words) {
  try {
    run('krok-diff', ...words);
    expect(false, 'no difference was found');
  } catch (error) {
    expect(error.status === 1, `krok-diff ends with ${error.status}: ${error.stderr}`);
  }
}

const loaded = () => [...document.images].filter((image) => image.closest('.shots'))
  .every((image) => image.complete && image.naturalWidth > 0);

// The mean difference of the pixels of two pictures of the page, 0 to 255.
const apart = (page, first, second) => page.evaluate(async ([a, b]) => {
  const shots = document.querySelectorAll('article:first-of-type .shots img');
  const [one, other] = [shots[a], shots[b]].map((image) => {
    const pen = new OffscreenCanvas(image.naturalWidth, image.naturalHeight).getContext('2d');
    pen.drawImage(image, 0, 0);
    return pen.getImageData(0, 0, image.naturalWidth, image.naturalHeight).data;
  });
  return one.reduce((sum, value, i) => sum + Math.abs(value - other[i]), 0) / one.length;
}, [first, second]);

await check(20, async () => {
  for (const folder of ['golden', 'out']) mkdirSync(made(folder));
  for (const [name, before, after] of [['a_same', 0, 0], ['b little', 0, 1], ['c_large', 0, 20]]) {
    put(`golden/${name}.bvh`, before);
    put(`out/${name}.bvh`, after);
  }
  writeFileSync(made('golden/only.txt'), 'x');
  differ(made('golden'), made('out'), '--tolerance', '1mm', '--summary', made('page.html'));
  const page = await open('page.html', {}, loaded);
  const names = await page.locator('article h2').allTextContents();
  expect(names.join() === 'c_large.bvh,b little.bvh', `the order is ${names}`);
  const rows = await page.locator('tbody').nth(1).locator('tr').allTextContents();
  expect(rows.length === 3 && rows[0].includes('(200 x the tolerance)') && rows[1].includes('(10 x the tolerance)'), `the table has ${rows}`);
  expect(rows[2].startsWith('only.txtonly in'), `the last row is ${rows[2]}`);
  for (let i = 0; i < 2; ++i) {
    const shots = page.locator('article').nth(i).locator('.shots img');
    expect(await shots.count() === 3, `${names[i]} has ${await shots.count()} pictures`);
  }
  const links = await page.locator('figcaption a').evaluateAll((all) => all.map((link) => [link.getAttribute('href'), link.href]));
  expect(links.length === 4, `${links.length} links`);
  for (const [written, address] of links) {
    expect(/^(golden|out)\//.test(written), `the link ${written} is not relative`);
    expect(existsSync(new URL(address)), `${address} leads nowhere`);
  }
  expect(await apart(page, 0, 1) > 1, 'before and after look the same');
  expect(await apart(page, 1, 2) > 1, 'the difference is not coloured');
  const key = await page.locator('article').first().locator('figcaption').last().textContent();
  expect(key === 'distance from before, grey up to 0.1 cm020 cm', `the key has ${key}`);

  await page.locator('article').first().locator('.shot').first().click();
  const large = page.locator('dialog img');
  expect(await large.isVisible(), 'a picture does not open');
  for (const [press, words] of [[null, 'before'], ['ArrowRight', 'after'], ['ArrowRight', 'difference'], ['ArrowRight', 'before'], ['ArrowLeft', 'difference']]) {
    if (press) await page.keyboard.press(press);
    expect(await large.getAttribute('alt') === `c_large.bvh ${words}`, `${press} shows ${await large.getAttribute('alt')}`);
  }
  await page.keyboard.press('Escape');
  expect(!(await large.isVisible()), 'Escape does not close the picture');

  await page.locator('summary').first().click();
  await until(page, () => document.querySelector('.chart').naturalWidth > 300);
  expect(/^  positions: largest 200 mm/m.test(await page.locator('pre').first().textContent()), 'measures are missing');
  await axeFinds(page, 'light');
  const keep = async (shown, name) => {
    if (process.env.KROK_PAGE_SHOTS) {
      await shown.screenshot({ path: join(process.env.KROK_PAGE_SHOTS, name), fullPage: true });
    }
  };
  await keep(page, 'summary light.png');
  const dark = await open('page.html', { colorScheme: 'dark' }, loaded);
  await axeFinds(dark, 'dark');
  await keep(dark, 'summary dark.png');

  // Of two files, and with the same bytes on another run.
  differ(made('golden/c_large.bvh'), made('out/c_large.bvh'), '--summary', made('pair.html'), '-j1');
  const first = readFileSync(made('pair.html'));
  differ(made('golden/c_large.bvh'), made('out/c_large.bvh'), '--summary', made('pair.html'), '-j4');
  expect(first.equals(readFileSync(made('pair.html'))), 'the number of threads changes the page');
  const pair = await open('pair.html', {}, loaded);
  expect(await pair.locator('.shots img').count() === 3, 'two files have no pictures');
});
