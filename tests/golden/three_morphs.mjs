// Opens a float texture of morph targets with three.js's own EXR loader and holds the texels against
// shapes in OBJ files, by the rules of formats/morph_exr/SPEC.md.
//
// Usage: node three_morphs.mjs FACE.exr TARGET.obj...   (in the texture's order; with v lines only)
// Exit code 0: every position is where the rules say, to the bit, and every normal has length 1.
// 1: not. 2: trouble.

import {readFileSync} from 'node:fs';

globalThis.self ??= globalThis;
const THREE = await import('three');
const {EXRLoader} = await import('three/addons/loaders/EXRLoader.js');

function positionsOf(path) {
  return readFileSync(path, 'utf8').split('\n').filter((line) => line.startsWith('v '))
      .map((line) => line.split(' ').slice(1, 4).map((word) => Math.fround(Number(word))));
}

const [texture, ...shapes] = process.argv.slice(2);
try {
  const bytes = readFileSync(texture);
  const loader = new EXRLoader().setDataType(THREE.FloatType);
  const picture = loader.parse(
      bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.byteLength));
  const {width, height, data} = picture;
  const channels = data.length / (width * height);
  // The loader's rows begin at the bottom, the file's at the top.
  const texel = (column, row) => {
    const at = ((height - 1 - row) * width + column) * channels;
    return [data[at], data[at + 1], data[at + 2]];
  };
  let faults = 0, checked = 0;
  shapes.forEach((path, target) => {
    const positions = positionsOf(path);
    positions.forEach((expected, vertex) => {
      const n = target * positions.length + vertex;
      const column = n % width, row = Math.floor(n / width);
      const found = texel(column, row);
      const normal = texel(column, row + height / 2);
      checked++;
      const same = found.every((value, axis) => value === expected[axis]);
      if (same && Math.abs(Math.hypot(...normal) - 1) < 1e-5) return;
      if (faults++ < 10) {
        console.log(`${path}: vertex ${vertex} is ${found}, expected ${expected}; normal ${normal}`);
      }
    });
  });
  console.log(`${width} x ${height} texels, ${checked} vertices checked, ${faults} faults`);
  process.exit(faults === 0 && checked > 0 ? 0 : 1);
} catch (error) {
  console.error(`three_morphs: ${error.message ?? error}`);
  process.exit(2);
}
