// A glTF file with its own meshes, played by three.js's AnimationMixer.

import { AnimationMixer, Box3, Quaternion, SkeletonHelper, Vector3 } from 'three';
import { MeshoptDecoder } from 'three/addons/libs/meshopt_decoder.module.js';
import { GLTFLoader } from 'three/addons/loaders/GLTFLoader.js';
import { reachBeyond, widen } from './reach.js';
import { ShownActor } from './shown_actor.js';

const MOST_SAMPLES = 600; // of a joint's way
const DEGREES = 180 / Math.PI;

export class GltfActor extends ShownActor {
  static async load(item, bytes) {
    const buffer = bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.byteLength);
    const file = await new GLTFLoader().setMeshoptDecoder(MeshoptDecoder).parseAsync(buffer, '');
    return new GltfActor(item, file);
  }

  constructor(item, file) {
    super(item);
    this.group.add(file.scene);
    this.meshes = file.scene;
    this.bonesOf = [];
    this.materials = new Set();
    file.scene.traverse((node) => {
      if (node.isMesh) {
        node.castShadow = true;
        node.frustumCulled = false; // animated meshes leave their rest pose bounds
        for (const material of [node.material].flat()) this.materials.add(material);
      }
      if (node.isBone) this.bonesOf.push(node);
    });
    this.rest = this.bonesOf.map((bone) => bone.quaternion.clone().invert());
    // GLTFLoader leaves out of names what its animations cannot have, such as colons.
    this.names = this.bonesOf.map((bone) => bone.userData.name ?? bone.name);
    this.rootJoint = 0;
    this.mixer = new AnimationMixer(file.scene);
    this.clips = file.animations;
    this.choose(item.animation ?? 0);
    this.helper = new SkeletonHelper(file.scene);
    this.helper.visible = false;
    this.group.add(this.helper);
    this.update(0);
    this.size = Math.max(this.boxNow().getSize(new Vector3()).length(), 1e-3);
  }

  // Plays another of the file's animations.
  choose(animation) {
    const clip = this.clips[animation];
    this.animation = animation;
    this.mixer.stopAllAction();
    if (clip) this.mixer.clipAction(clip).play();
    this.duration = clip?.duration ?? 0;
    this.rate = this.item.rates?.[animation] ?? 60;
    // What was measured was of another animation.
    for (const joint of [...this.trails.keys()]) this.toggleTrail(joint);
    this.measured = this.rootPoints = this.smoothed = this.series = undefined;
  }

  // The first joint, or the file's origin.
  root(into = new Vector3()) {
    return this.bonesOf.length > 0 ? this.jointPosition(0, into) : into.set(0, 0, 0);
  }

  // Takes the joint in as many frames as the clip has, or fewer.
  sampled(take) {
    const { time } = this;
    const frames = Math.min(Math.round(this.duration * this.rate) + 1, MOST_SAMPLES);
    const rate = frames > 1 ? (frames - 1) / this.duration : 1;
    for (let frame = 0; frame < frames; ++frame) {
      this.update(frame / rate);
      take(frame);
    }
    this.update(time);
    return { frames, rate };
  }

  pathOf(joint) {
    const points = [];
    const place = new Vector3();
    const { rate } = this.sampled((frame) => {
      if (this.bonesOf.length > 0) this.jointPosition(joint, place);
      place.toArray(points, frame * 3);
    });
    return { points: new Float32Array(points), rate };
  }

  turnsOf(joint) {
    const turns = [];
    this.sampled((frame) => {
      turns[frame] = 2 * Math.acos(Math.min(Math.abs(this.jointTurn(joint).w), 1)) * DEGREES;
    });
    return new Float32Array(turns);
  }

  jointTurn(joint) {
    return new Quaternion().multiplyQuaternions(this.rest[joint], this.bonesOf[joint].quaternion);
  }

  boxNow() {
    const shift = this.group.position.clone();
    this.group.position.set(0, 0, 0);
    this.group.updateMatrixWorld(true);
    const box = this.bonesOf.length > 1 ? this.jointBox() : new Box3().setFromObject(this.group);
    if (this.bonesOf.length > 1) {
      this.reach ??= reachBeyond(box, new Box3().setFromObject(this.meshes));
      widen(box, this.reach);
    }
    this.group.position.copy(shift);
    this.group.updateMatrixWorld(true);
    return box;
  }

  jointBox() {
    const box = new Box3();
    this.bonesOf.forEach((_, joint) => box.expandByPoint(this.jointPosition(joint)));
    return box;
  }

  show({ skeleton, body, wireframe }) {
    this.helper.visible = skeleton && this.bonesOf.length > 0;
    this.meshes.traverse((node) => { if (node.isMesh) node.visible = body; });
    for (const material of this.materials) material.wireframe = wireframe;
  }

  update(time) {
    this.time = time;
    this.mixer.setTime(Math.min(time, Math.max(this.duration - 1e-6, 0)));
    this.group.updateMatrixWorld(true);
  }

  // In the group's space: without the group's offset.
  jointPosition(joint, into = new Vector3()) {
    return this.bonesOf[joint].getWorldPosition(into).sub(this.group.position);
  }
}
