// The files of the page. Each is decoded and drawn when it is first shown.

import { CameraHelper, PerspectiveCamera, Vector3 } from 'three';
import { COLOURS, Actor } from './actor.js';
import { GltfActor } from './gltf_actor.js';
import { CameraTrack, Motion, blobBytes } from './motion.js';

export class Item {
  constructor(item, index, stage) {
    this.item = item;
    this.index = index;
    this.stage = stage;
    this.name = item.name;
    this.visible = false;
    this.colour = item.kind === 'camera' ? undefined : COLOURS[index % COLOURS.length];
    this.length = item.frames > 1 ? (item.frames - 1) / item.rate : 0;
  }

  get duration() {
    return this.actor?.duration ?? this.length;
  }

  get rate() {
    return this.actor?.rate ?? this.item.rate ?? 1;
  }

  open() {
    this.opened ??= this.make();
    return this.opened;
  }

  async make() {
    const { item, stage } = this;
    const bytes = item.blob ? blobBytes(item.blob) : null;
    if (item.kind === 'camera') {
      this.camera = new CameraTrack(item, bytes);
      this.camera.pose(0);
      const shown = new PerspectiveCamera((this.camera.fieldOfView * 180) / Math.PI, 16 / 9, 0.02, 0.3);
      this.helper = new CameraHelper(shown);
      stage.scene.add(this.helper);
      return;
    }
    if (item.kind === 'gltf') {
      this.actor = await GltfActor.load(item, bytes);
    } else {
      this.actor = new Actor(item, new Motion(item, bytes), bytes, this.index);
      await this.actor.dress();
    }
    this.measure();
    stage.scene.add(this.actor.group);
  }

  // Where the character is at first, and how wide.
  measure() {
    const { actor } = this;
    actor.update(0);
    this.spread = actor.boxNow().getSize(new Vector3()).x;
    this.start = actor.root(new Vector3());
  }
}
