// The contents of the scene over time: characters with one interface for all file formats, cameras,
// footprints.

import { Box3 } from 'three';
import { Difference } from './difference.js';
import { GltfDifference } from './gltf_difference.js';

export class Player {
  constructor(stage, items, prints) {
    this.stage = stage;
    this.items = items;
    this.prints = prints;
    this.time = 0;
    this.speed = 1;
    this.playing = false;
    this.loop = true;
    this.range = null; // [from, to] that is looped, in seconds
    this.selected = null; // {made, joint}
    this.framed = null; // the only character that the camera follows, or null for all
    this.shown = {
      skeleton: true, body: true, apart: false, difference: false, follow: false, goals: true, prints: true,
      wireframe: false,
    };
    this.before = null; // the bounds of the followed characters at the last moment
    this.watchers = [];
  }

  actors() {
    return this.items.filter(({ actor, visible }) => actor && visible);
  }

  // Those that the camera follows.
  followed() {
    const actors = this.actors();
    return actors.includes(this.framed) ? [this.framed] : actors;
  }

  get duration() {
    return Math.max(0, ...this.items.filter(({ visible }) => visible).map(({ duration }) => duration));
  }

  get rate() {
    return Math.max(1, ...this.items.filter(({ visible }) => visible).map(({ rate }) => rate));
  }

  get begin() {
    return this.range ? this.range[0] : 0;
  }

  get end() {
    return this.range ? this.range[1] : this.duration;
  }

  setTime(time) {
    this.time = Math.min(Math.max(time, 0), this.duration);
    this.update();
  }

  // Loops a part; null or nothing in between: all.
  setRange(from, to) {
    const [low, high] = [Math.min(from, to), Math.max(from, to)].map((time) => Math.min(Math.max(time, 0), this.duration));
    this.range = high - low > 1e-6 && (low > 0 || high < this.duration) ? [low, high] : null;
    this.changed();
  }

  step(frames) {
    this.playing = false;
    this.setTime((Math.round(this.time * this.rate) + frames) / this.rate);
  }

  advance(seconds) {
    const { begin, end } = this;
    let time = this.time + seconds * this.speed;
    // From beyond the range, it is played up to the motion's end.
    const stop = this.time > end ? this.duration : end;
    if (time > stop) {
      if (this.loop && end > begin) {
        time = begin + ((time - stop) % (end - begin));
      } else {
        time = stop;
        this.playing = false;
        this.ended?.();
      }
    }
    this.setTime(time);
  }

  // Places characters side by side along X, by their start positions, or at their own positions.
  arrange() {
    const actors = this.actors();
    const slot = Math.max(0.8, ...actors.map(({ spread }) => spread)) * 1.25;
    actors.forEach(({ actor, start }, i) => {
      const shift = actor.group.position.set(0, 0, 0);
      if (this.shown.apart) shift.set((i - (actors.length - 1) / 2) * slot - start.x, 0, -start.z);
    });
    for (const { actor, helper, visible } of this.items) {
      if (helper) helper.visible = visible;
      if (actor) {
        actor.group.visible = visible;
        actor.show(this.shown);
      }
    }
    this.stage.floor = Math.min(0, ...actors.map(({ actor }) => actor.extents.whole.min.y));
    this.compare();
    this.range = this.range && this.range[1] <= this.duration ? this.range : null;
    this.before = null;
    this.setTime(this.time);
  }

  // Compares the first two motions that are shown, or the first two glTF files: the second is coloured
  // by its distance from the first, as in the films of krok-render.
  compare() {
    const actors = this.actors().map(({ actor }) => actor);
    const motions = actors.filter(({ motion }) => motion);
    const glbs = actors.filter(({ meshes }) => meshes);
    const [other, one] = motions.length > 1 ? motions : glbs;
    const wanted = this.shown.difference && one && other;
    if (this.difference && !(wanted && this.difference.compares(one, other))) {
      this.difference.release();
      this.difference = null;
    }
    if (!wanted || this.difference) return;
    const difference = one.motion ? new Difference(one, other) : new GltfDifference(one, other);
    if (difference.shared > 0) this.difference = difference;
    else difference.release();
    for (const actor of [one, other]) actor.show(this.shown);
  }

  update() {
    for (const { actor } of this.actors()) actor.update(this.time);
    for (const { camera, helper } of this.items) {
      if (!camera) continue;
      camera.pose(this.time);
      if (helper) {
        helper.camera.position.copy(camera.position);
        helper.camera.quaternion.copy(camera.orientation);
        helper.camera.updateMatrixWorld();
        helper.update();
      }
    }
    this.prints?.update(this.time, this.actors().map(({ item }) => item.printContacts ?? []));
    this.difference?.update(this.time);
    this.followActors();
    this.stage.redraw();
    this.changed();
  }

  changed() {
    for (const watch of this.watchers) watch();
  }

  // The bounds of the followed characters, wherever their limbs are.
  bounds() {
    const box = new Box3();
    for (const { actor } of this.followed()) {
      const root = actor.smoothRootAt(this.time).add(actor.group.position);
      box.union(actor.extents.around.clone().translate(root));
    }
    return box;
  }

  // Moves the camera with them, and away or nearer as their bounds grow or shrink.
  followActors() {
    if (!this.shown.follow || this.stage.flown || this.actors().length === 0) {
      this.before = null;
      return;
    }
    const bounds = this.bounds();
    if (this.before) this.stage.follow(this.before, bounds);
    this.before = bounds;
  }
}
