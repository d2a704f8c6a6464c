// Reads a BVH with three.js's own loader and holds the world positions of all joints in all frames
// against a table that krok-export wrote: three_bvh.mjs FILE.bvh POSITIONS.csv METRES TOLERANCE
// where METRES is the size of the BVH's unit. Prints the largest distance; exits 1 above TOLERANCE.

import {readFileSync} from 'node:fs';

globalThis.self ??= globalThis;
const THREE = await import('three');
const {BVHLoader} = await import('three/addons/loaders/BVHLoader.js');

const [bvhPath, csvPath, metres, tolerance] = process.argv.slice(2);
const {skeleton, clip} = new BVHLoader().parse(readFileSync(bvhPath, 'utf8'));
const bones = skeleton.bones;
const moving = bones.filter((bone) => bone.name !== 'ENDSITE');
if (clip.tracks.length !== 2 * moving.length) throw new Error('a track is missing');

const rows = readFileSync(csvPath, 'utf8').trim().split('\n').slice(1).map((line) => {
  const cells = line.match(/("([^"]|"")*"|[^,]*)(,|$)/g).map((cell) => cell.replace(/,$/, ''));
  return {frame: Number(cells[0]), position: cells.slice(3, 6).map(Number)};
});
const frames = clip.tracks[0].times.length;
if (rows.length !== frames * bones.length) {
  throw new Error(`${rows.length} positions in the table, ${frames * bones.length} in the BVH`);
}

let largest = 0;
const place = new THREE.Vector3();
for (let frame = 0; frame < frames; ++frame) {
  moving.forEach((bone, i) => {
    bone.position.fromArray(clip.tracks[2 * i].values, 3 * frame);
    bone.quaternion.fromArray(clip.tracks[2 * i + 1].values, 4 * frame);
  });
  bones[0].updateMatrixWorld(true);
  bones.forEach((bone, i) => {
    place.setFromMatrixPosition(bone.matrixWorld).multiplyScalar(Number(metres));
    const row = rows[frame * bones.length + i];
    largest = Math.max(largest, place.distanceTo(new THREE.Vector3(...row.position)));
  });
}
console.log(`${frames} frames, ${bones.length} joints: at most ${largest.toExponential(2)} m apart`);
process.exit(largest <= Number(tolerance) ? 0 : 1);
