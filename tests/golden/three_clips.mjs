// Plays the clips of a glTF file by name in three.js and holds its bones against tables of
// krok-export.
//
// Usage: three_clips.mjs FILE.glb NAME=POSITIONS.csv...
// POSITIONS.csv has world positions in long form. Exit code 1 and a line for each difference.

import {readFileSync} from 'node:fs';

import {ThreeScene} from './three_scene.mjs';

const THREE = await import('three');
const TOLERANCE = 1e-4;  // metres

const [file, ...clips] = process.argv.slice(2);
const scene = await ThreeScene.open(file);
let worst = 0, compared = 0;
for (const argument of clips) {
  const [name, path] = argument.split('=');
  const clip = THREE.AnimationClip.findByName(scene.animations, name);
  if (!clip) {
    console.log(`no clip ${name} among ${scene.animations.map((each) => each.name)}`);
    process.exit(1);
  }
  const mixer = new THREE.AnimationMixer(scene.root);
  const action = mixer.clipAction(clip);
  action.setLoop(THREE.LoopOnce);
  action.clampWhenFinished = true;
  action.play();
  const rows = readFileSync(path, 'utf8').trim().split('\n').slice(1).map((row) => row.split(','));
  for (const [, time, joint, ...place] of rows) {
    action.reset();
    mixer.setTime(Number(time));
    scene.root.updateMatrixWorld(true);
    const at = new THREE.Vector3().setFromMatrixPosition(scene.joints.get(joint).matrixWorld);
    worst = Math.max(worst, at.distanceTo(new THREE.Vector3(...place.map(Number))));
    ++compared;
  }
  mixer.stopAllAction();
}
if (!(compared > 0 && worst < TOLERANCE)) {
  console.log(`${compared} joints compared, up to ${1000 * worst} mm away`);
  process.exit(1);
}
console.log(`OK ${1000 * worst} mm, ${compared} joints`);
