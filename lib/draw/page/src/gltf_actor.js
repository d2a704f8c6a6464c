// A glTF file with its own meshes, played by three.js's AnimationMixer.

import { AnimationMixer, Box3, Group, SkeletonHelper, Vector3 } from 'three';
import { GLTFLoader } from 'three/addons/loaders/GLTFLoader.js';
import { reachBeyond, widen } from './reach.js';

export class GltfActor {
  static async load(item, bytes) {
    const buffer = bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.byteLength);
    const file = await new GLTFLoader().parseAsync(buffer, '');
    return new GltfActor(item, file);
  }

  constructor(item, file) {
    this.item = item;
    this.group = new Group();
    this.group.add(file.scene);
    this.meshes = file.scene;
    this.bonesOf = [];
    file.scene.traverse((node) => {
      if (node.isMesh) {
        node.castShadow = true;
        node.frustumCulled = false; // animated meshes leave their rest pose bounds
      }
      if (node.isBone) this.bonesOf.push(node);
    });
    this.mixer = new AnimationMixer(file.scene);
    const clip = file.animations[item.animation ?? 0];
    this.duration = clip?.duration ?? 0;
    if (clip) this.mixer.clipAction(clip).play();
    this.trails = new Map();
    this.contacts = [];
    this.names = this.bonesOf.map((bone) => bone.name);
    this.helper = new SkeletonHelper(file.scene);
    this.helper.visible = false;
    this.group.add(this.helper);
  }

  get rate() {
    return this.item.rate ?? 60;
  }

  // The first joint, or the file's origin.
  root(into = new Vector3()) {
    return this.bonesOf.length > 0 ? this.jointPosition(0, into) : into.set(0, 0, 0);
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

  show({ skeleton }) {
    this.helper.visible = skeleton && this.bonesOf.length > 0;
  }

  update(time) {
    this.mixer.setTime(Math.min(time, Math.max(this.duration - 1e-6, 0)));
    this.group.updateMatrixWorld(true);
  }

  // In the group's space: without the group's offset.
  jointPosition(joint, into = new Vector3()) {
    return this.bonesOf[joint].getWorldPosition(into).sub(this.group.position);
  }
}
