// Plays a glTF file in three.js and holds its camera against where it should be.
//
// Usage: node three_camera.mjs FILE EXPECTED.json [TOLERANCE]
//   EXPECTED.json: {"fov": degrees, "aspect": number or null, "moments": [{"time": seconds,
//   "position": [x, y, z], "forward": [x, y, z], "up": [x, y, z]}, ...]}
// Exit code 0: within the tolerance (default 1e-5) at all moments. 1: not. 2: trouble.

import {readFileSync} from 'node:fs';
import {ThreeScene} from './three_scene.mjs';
import {Vector3} from 'three';

const [file, expectedFile, toleranceText] = process.argv.slice(2);
try {
  const expected = JSON.parse(readFileSync(expectedFile, 'utf8'));
  const tolerance = toleranceText ? Number(toleranceText) : 1e-5;
  const scene = await ThreeScene.open(file);
  const cameras = [];
  scene.root.traverse((object) => object.isCamera && cameras.push(object));
  if (cameras.length !== 1 || expected.moments.length === 0) {
    console.error(`${cameras.length} cameras, ${expected.moments.length} moments`);
    process.exit(2);
  }
  const camera = cameras[0];
  let off = Math.abs(camera.fov - expected.fov);
  if (expected.aspect) off = Math.max(off, Math.abs(camera.aspect - expected.aspect));
  for (const moment of expected.moments) {
    scene.seek(moment.time);
    const place = new Vector3().setFromMatrixPosition(camera.matrixWorld);
    const forward = new Vector3(0, 0, -1).transformDirection(camera.matrixWorld);
    const up = new Vector3(0, 1, 0).transformDirection(camera.matrixWorld);
    const distances = [[place, moment.position], [forward, moment.forward], [up, moment.up]].map(
        ([found, wanted]) => found.distanceTo(new Vector3(...wanted)));
    console.log(`${moment.time} s: off by ${distances.map((d) => d.toExponential(2)).join(', ')}`);
    off = Math.max(off, ...distances);
  }
  process.exit(off <= tolerance ? 0 : 1);
} catch (error) {
  console.error(`three_camera: ${error.message ?? error}`);
  process.exit(2);
}
