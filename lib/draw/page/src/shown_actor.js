// What all characters have in common, whatever file they are from: trails, and how far they reach.
// A subclass has names, duration, rate, pathOf(joint), turnsOf(joint), root(), boxNow(), update(time).

import { Box3, BufferAttribute, BufferGeometry, Color, Group, Line, LineBasicMaterial, Vector3 } from 'three';

const SAMPLES = 60; // of a motion, to measure its extent
const SMOOTH = [0.25, 0.5]; // seconds to both sides over which the camera's way is averaged, ground and up
// Apart from each other and from the colours of characters.
const TRAIL_COLOURS = ['#d6336c', '#1c7c8c', '#8a5cd6', '#b8860b', '#3f7d20', '#c2453d', '#0b63ce', '#7a4a2a'];

export class ShownActor {
  constructor(item) {
    this.item = item;
    this.group = new Group();
    this.trails = new Map();
    this.contacts = item.contacts ?? [];
  }

  // The bounds over the motion, and those relative to the root; in the group's space.
  get extents() {
    if (!this.measured) {
      const whole = new Box3();
      const around = new Box3();
      const count = this.duration > 0 ? SAMPLES : 1;
      for (let i = 0; i < count; ++i) {
        this.update(count > 1 ? (i / (count - 1)) * this.duration : 0);
        const box = this.boxNow();
        whole.union(box);
        around.union(box.translate(this.root(new Vector3()).negate()));
      }
      this.measured = { whole, around };
    }
    return this.measured;
  }

  // The root's exact place.
  rootAt(time, into = new Vector3()) {
    const { points, rate } = this.rootPath;
    return placeAt(points, time * rate, into);
  }

  // The root's place averaged over some time, for a camera that does not shake.
  smoothRootAt(time, into = new Vector3()) {
    this.smoothed ??= smooth(this.rootPath);
    return placeAt(this.smoothed, time * this.rootPath.rate, into);
  }

  get rootPath() {
    this.rootPoints ??= this.pathOf(this.rootJoint);
    return this.rootPoints;
  }

  // Returns whether the joint has a trail now.
  toggleTrail(joint) {
    const old = this.trails.get(joint);
    if (old) {
      this.group.remove(old.line);
      old.line.geometry.dispose();
      this.trails.delete(joint);
      return false;
    }
    const used = new Set([...this.trails.values()].map(({ colour }) => colour));
    const colour = TRAIL_COLOURS.find((each) => !used.has(each)) ?? TRAIL_COLOURS[this.trails.size % TRAIL_COLOURS.length];
    const geometry = new BufferGeometry();
    geometry.setAttribute('position', new BufferAttribute(this.pathOf(joint).points, 3));
    const line = new Line(geometry, new LineBasicMaterial({ color: new Color(colour) }));
    line.frustumCulled = false;
    this.group.add(line);
    this.trails.set(joint, { line, colour });
    return true;
  }

  // Angle from the reference pose (degrees), height (metres) and speed (metres per second) of a joint,
  // one number per frame.
  seriesOf(joint) {
    this.series ??= new Map();
    if (!this.series.has(joint)) {
      const { points, rate } = this.pathOf(joint);
      const count = points.length / 3;
      const height = new Float32Array(count);
      const speed = new Float32Array(count);
      const here = new Vector3();
      const there = new Vector3();
      for (let i = 0; i < count; ++i) {
        height[i] = points[i * 3 + 1];
        const before = Math.max(i - 1, 0);
        const after = Math.min(i + 1, count - 1);
        here.fromArray(points, before * 3);
        there.fromArray(points, after * 3);
        speed[i] = after > before ? (here.distanceTo(there) * rate) / (after - before) : 0;
      }
      this.series.set(joint, { angle: this.turnsOf(joint), height, speed, rate });
    }
    return this.series.get(joint);
  }
}

function placeAt(points, at, into) {
  const last = points.length / 3 - 1;
  const clamped = Math.min(Math.max(at, 0), last);
  const frame = Math.floor(clamped);
  const share = clamped - frame;
  const next = Math.min(frame + 1, last);
  return into.set(...[0, 1, 2].map((k) => points[frame * 3 + k] * (1 - share) + points[next * 3 + k] * share));
}

function smooth({ points, rate }) {
  const count = points.length / 3;
  const result = new Float32Array(points.length);
  for (let axis = 0; axis < 3; ++axis) {
    const sums = new Float64Array(count + 1);
    for (let i = 0; i < count; ++i) sums[i + 1] = sums[i] + points[i * 3 + axis];
    const half = Math.round(SMOOTH[axis === 1 ? 1 : 0] * rate);
    for (let i = 0; i < count; ++i) {
      // As many before as after, or the ends would be drawn inward.
      const reach = Math.min(half, i, count - 1 - i);
      result[i * 3 + axis] = (sums[i + reach + 1] - sums[i - reach]) / (2 * reach + 1);
    }
  }
  return result;
}
