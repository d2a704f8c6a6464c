// Entry point: reads the data, opens what is shown at first, runs the clock.

import { Raycaster, Vector3 } from 'three';
import { Interface } from './interface.js';
import { Item } from './items.js';
import { linked } from './link.js';
import { blobBytes } from './motion.js';
import { Player } from './player.js';
import { Prints } from './prints.js';
import { Stage } from './stage.js';

const find = (id) => document.getElementById(id);

async function main() {
  const data = JSON.parse(find('krok-data').textContent);
  const stage = new Stage(find('view'));
  const items = data.items.map((item, index) => new Item(item, index, stage));
  for (const made of items) {
    made.visible = made.item.visible ?? true;
    if (made.visible) await made.open();
  }
  if (data.ground) stage.setTerrain(data.ground, blobBytes(data.ground.blob));
  const prints = data.prints ? new Prints(data.prints) : null;
  if (prints) stage.scene.add(prints.group);
  const player = new Player(stage, items, prints);
  const controls = new Interface(player, stage, data);
  controls.rearrange();
  controls.framing.all();
  const link = linked();
  if (link) await controls.follow(link);
  // Plays at once, unless the system is set to reduced motion, or a link shows one moment.
  else if (player.duration > 0 && !matchMedia('(prefers-reduced-motion: reduce)').matches) controls.togglePlay();

  let last = null;
  let drawn = 0;
  const tick = (now) => {
    if (player.playing && last !== null) player.advance(Math.min((now - last) / 1000, 0.25));
    last = now;
    if (stage.draw()) ++drawn;
    requestAnimationFrame(tick);
  };
  requestAnimationFrame(tick);
  publish({ player, stage, items, prints, controls, drawn: () => drawn });
}

// For tests and scripts in the browser's console.
function publish({ player, stage, items, prints, controls, drawn }) {
  globalThis.krokView = {
    ready: true,
    get time() { return player.time; },
    get duration() { return player.duration; },
    get rate() { return player.rate; },
    get playing() { return player.playing; },
    get range() { return player.range; },
    get drawn() { return drawn(); },
    get selected() { return controls.joint.values(); },
    get curvesEnd() { return controls.timeline.curvesEnd; },
    get timeView() { return controls.timeline.view; },
    setTime: (time) => player.setTime(time),
    setRange: (from, to) => player.setRange(from, to),
    camera: () => ({ position: stage.camera.position.toArray(), target: stage.controls.target.toArray() }),
    placeOfTime: (time) => controls.timeline.placeOf(time),
    // What is compared: the scale's end and the distance of each joint, metres.
    difference: () => player.difference && { scale: player.difference.scale, distances: player.difference.distances() },
    // A file's goals at this time.
    goals: (item = 0) => (items[item].actor.goals?.goals ?? []).map(
      ({ name, kind, chain, from, to, strength, distance, angle }) =>
        ({ name, kind, chain, from: from.toArray(), to: to.toArray(), strength, distance, angle }),
    ),
    // Heights of the ground's surfaces at (x, z), the highest first.
    groundAt: (x, z) => (stage.terrain
      ? new Raycaster(new Vector3(x, 1e4, z), new Vector3(0, -1, 0)).intersectObject(stage.terrain).map(({ point }) => point.y)
      : [0]),
    // Where a point is seen, in pixels of the canvas.
    project: (x, y, z) => stage.project(new Vector3(x, y, z)),
    prints: () => (prints?.list ?? []).map(
      ({ number, side, heel, forward, length, planted }) => ({ number, side, heel, forward, length, planted }),
    ),
    // World positions of a file's joints, without the side-by-side offset.
    joints: (item = 0) => {
      const { actor } = items[item];
      return actor.names.map((name, joint) => ({ name, position: actor.jointPosition(joint).toArray() }));
    },
    // Where a character is placed side by side.
    offset: (item = 0) => items[item].actor.group.position.toArray(),
    bodies: () => items.map(({ actor }) => Boolean(actor?.body)),
    opened: () => items.filter(({ actor, camera }) => actor || camera).map(({ index }) => index),
  };
}

main().catch((error) => {
  const trouble = find('trouble');
  trouble.hidden = false;
  trouble.textContent = /webgl/i.test(error.message)
    ? 'WebGL is not available in this browser.'
    : `Cannot show the page: ${error.message}`;
  console.error(error);
});
