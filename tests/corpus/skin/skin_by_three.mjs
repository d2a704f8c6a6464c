// Holds a mesh that Krok skinned against three.js's own skinning of the rig that it came from.
//
// Usage: node skin_by_three.mjs RIG SECONDS POSE
// Prints the largest distance of two vertices in metres.

import {ThreeScene} from '../../golden/three_scene.mjs';

const [rigPath, seconds, posePath] = process.argv.slice(2);
const rig = await ThreeScene.open(rigPath);
const pose = await ThreeScene.open(posePath);
// glTF asks for rotations of length 1; a file of the corpus has them rounded to three digits.
for (const {name, values} of rig.action.getClip().tracks) {
  for (let i = 0; name.endsWith('.quaternion') && i < values.length; i += 4) {
    const length = Math.hypot(...values.subarray(i, i + 4));
    for (let k = i; k < i + 4; k++) values[k] /= length;
  }
}
rig.seek(Number(seconds));
pose.seek(0);
const wanted = rig.vertices(), found = pose.vertices();
if (wanted.length !== found.length) {
  console.error(`${wanted.length / 3} vertices and ${found.length / 3}`);
  process.exit(2);
}
let largest = 0;
for (let i = 0; i < wanted.length; i += 3) {
  const across = [0, 1, 2].map((k) => wanted[i + k] - found[i + k]);
  largest = Math.max(largest, Math.hypot(...across));
}
console.log(largest.toExponential(3));
