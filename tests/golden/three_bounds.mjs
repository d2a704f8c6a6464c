// Plays a glTF file in three.js at every tenth frame (and the last) and holds what it shows against
// something else.
//
// Usage: node three_bounds.mjs FILE [--every N] [--tolerance METRES]
//          [--against OTHER.glb]   the same vertices at the same times, shown by three.js from another file: a rig
//                                  against its bake, say
//          [--joints TABLE.csv]    frame,time,joint,x,y,z: the joints' world positions; the file
//                                  must show every joint and frame of the table
//          [--bounds FILE.json]    [{"frame", "min": [x,y,z], "max": [x,y,z]}, ...]
//          [--write-bounds]        prints such a list instead
// Exit code 0: within the tolerance (default 1e-5 m). 1: not. 2: trouble.

import {readFileSync} from 'node:fs';
import {parseArgs} from 'node:util';
import {ThreeScene} from './three_scene.mjs';

function parseTable(path) {
  const rows = readFileSync(path, 'utf8').split('\n').slice(1).filter((row) => row !== '');
  const frames = new Map();
  for (const row of rows) {
    const match = /^(\d+),([^,]+),(?:"((?:[^"]|"")*)"|([^,]*)),([^,]+),([^,]+),([^,]+)$/.exec(row);
    if (!match) throw new Error(`${path}: a row that does not parse: ${row}`);
    const frame = Number(match[1]);
    if (!frames.has(frame)) frames.set(frame, {time: Number(match[2]), joints: []});
    const name = match[3] !== undefined ? match[3].replaceAll('""', '"') : match[4];
    const at = match.slice(5, 8).map(Number);
    if (!at.every(Number.isFinite)) throw new Error(`${path}: not a number: ${row}`);
    frames.get(frame).joints.push({name, at});
  }
  return frames;
}

function bounds(vertices) {
  const min = [Infinity, Infinity, Infinity], max = [-Infinity, -Infinity, -Infinity];
  for (let i = 0; i < vertices.length; i++) {
    min[i % 3] = Math.min(min[i % 3], vertices[i]);
    max[i % 3] = Math.max(max[i % 3], vertices[i]);
  }
  return {min, max};
}

// Largest distance between two lists of points, and where.
function farthest(a, b) {
  if (a.length !== b.length) throw new Error(`${a.length / 3} vertices against ${b.length / 3}`);
  let largest = {distance: 0, at: 0};
  for (let i = 0; i < a.length; i += 3) {
    const distance = Math.hypot(a[i] - b[i], a[i + 1] - b[i + 1], a[i + 2] - b[i + 2]);
    if (!(distance <= largest.distance)) largest = {distance, at: i / 3};
  }
  return largest;
}

class Worst {
  distance = 0;
  text = 'nothing differs';
  add(distance, text) {
    // NaN is the worst of all, and stays.
    if (Number.isNaN(this.distance) || distance <= this.distance) return;
    this.distance = distance;
    this.text = text;
  }
}

function compareJoints(scene, table, frame, worst) {
  const row = table.get(frame);
  if (!row) throw new Error(`the table has no frame ${frame}`);
  if (Math.abs(row.time - scene.times[frame]) > 1e-6 * Math.max(1, row.time)) {
    throw new Error(`frame ${frame} is at ${scene.times[frame]} s, in the table at ${row.time} s`);
  }
  for (const {name, at} of row.joints) {
    const shown = scene.joint(name);
    if (!shown) throw new Error(`the file has no joint ${name}`);
    worst.add(farthest(shown, at).distance, `joint ${name}, frame ${frame}`);
  }
}

async function main() {
  const {values, positionals} = parseArgs({
    allowPositionals: true,
    options: {
      every: {type: 'string', default: '10'},
      tolerance: {type: 'string', default: '1e-5'},
      against: {type: 'string'},
      joints: {type: 'string'},
      bounds: {type: 'string'},
      'write-bounds': {type: 'boolean', default: false},
    },
  });
  const scene = await ThreeScene.open(positionals[0]);
  const other = values.against ? await ThreeScene.open(values.against) : undefined;
  const table = values.joints ? parseTable(values.joints) : undefined;
  const wanted = values.bounds ? JSON.parse(readFileSync(values.bounds, 'utf8')) : undefined;
  if (other && Math.abs(other.times.at(-1) - scene.times.at(-1)) > 1e-3) {
    throw new Error(`${scene.times.at(-1)} s against ${other.times.at(-1)} s`);
  }
  if (table && table.size !== scene.times.length) {
    throw new Error(`${scene.times.length} frames, the table has ${table.size}`);
  }

  const every = Number(values.every);
  const last = scene.times.length - 1;
  const written = [], worst = new Worst();
  let frames = 0, vertexCount = 0;
  for (let frame = 0; frame <= last; frame = frame === last ? last + 1 : Math.min(frame + every, last)) {
    scene.seek(scene.times[frame]);
    const vertices = scene.vertices();
    if (vertices.some((value) => !Number.isFinite(value))) {
      throw new Error(`frame ${frame} has a vertex that is not finite`);
    }
    vertexCount = vertices.length / 3;
    frames++;
    if (values['write-bounds']) written.push({frame, ...bounds(vertices)});
    if (other) {
      other.seek(scene.times[frame]);
      const {distance, at} = farthest(vertices, other.vertices());
      worst.add(distance, `vertex ${at}, frame ${frame}`);
    }
    if (table) compareJoints(scene, table, frame, worst);
    if (wanted) {
      const expected = wanted.find((entry) => entry.frame === frame);
      if (!expected) throw new Error(`the bounds have no frame ${frame}`);
      const shown = bounds(vertices);
      worst.add(farthest(shown.min, expected.min).distance, `least corner, frame ${frame}`);
      worst.add(farthest(shown.max, expected.max).distance, `largest corner, frame ${frame}`);
    }
  }
  if (values['write-bounds']) {
    console.log(JSON.stringify(written));
    return 0;
  }
  const within = worst.distance <= Number(values.tolerance);
  console.log(`${positionals[0]}: ${frames} frames of ${vertexCount} vertices, ${
      scene.joints.size} joints: at most ${worst.distance} m off (${worst.text}), ${
      within ? 'within' : 'BEYOND'} ${values.tolerance} m`);
  return within ? 0 : 1;
}

try {
  process.exit(await main());
} catch (error) {
  console.error(`three_bounds: ${error.message ?? error}`);
  process.exit(2);
}
