// A motion: its skeleton and body.

import { Box3, Color, Matrix4, Quaternion, Vector3 } from 'three';
import { BodyView } from './body_view.js';
import { Goals } from './goals.js';
import { ShownActor } from './shown_actor.js';
import { SkeletonView } from './skeleton_view.js';
import { blobBytes } from './motion.js';
import { widen } from './reach.js';

export const COLOURS = ['#3d7fd9', '#e08a1e', '#2f9e63', '#b0509e', '#7a6a58', '#c2453d'];
export const CONTACT_COLOUR = '#e8412c';

const DEGREES = 180 / Math.PI;

export class Actor extends ShownActor {
  constructor(item, motion, bytes, index) {
    super(item);
    this.motion = motion;
    this.names = motion.names;
    this.colour = new Color(COLOURS[index % COLOURS.length]);
    this.rootJoint = item.hips ?? 0;

    motion.pose(0);
    this.size = this.measure();
    this.skeleton = new SkeletonView(motion, item, this.colour, this.size);
    this.group.add(this.skeleton.group);
    if (item.body) {
      this.body = new BodyView(item.body, blobBytes(item.body.blob), motion.names.length, this.colour,
        new Color(CONTACT_COLOUR), this.contacts.length > 0);
      this.group.add(this.body.mesh);
    }
    if (item.goals) {
      this.goals = new Goals(item.goals, motion, bytes, this.size);
      this.group.add(this.goals.group);
    }
  }

  // The body's own materials.
  async dress() {
    if (this.body) await this.body.dress(this.item.body.look, blobBytes(this.item.body.blob));
  }

  // The character's extent in its first frame, which sets the size of bones and joints.
  measure() {
    const { motion, rootJoint } = this;
    const box = new Box3();
    // A root that only positions the character may be far away.
    const below = motion.parents.map((_, joint) => {
      let at = joint;
      while (at > rootJoint) at = motion.parents[at];
      return at === rootJoint;
    });
    motion.positions.forEach((position, joint) => { if (below[joint]) box.expandByPoint(position); });
    return Math.max(box.getSize(new Vector3()).length(), 1e-3);
  }

  get duration() {
    return this.motion.duration;
  }

  get rate() {
    return this.motion.rate;
  }

  root(into = new Vector3()) {
    return into.copy(this.motion.positions[this.rootJoint]);
  }

  jointPosition(joint) {
    return this.motion.positions[joint];
  }

  // A joint's rotation from the reference pose, relative to its parent.
  jointTurn(joint) {
    return this.motion.turn(joint);
  }

  pathOf(joint) {
    return { points: this.motion.path(joint), rate: this.motion.rate };
  }

  turnsOf(joint) {
    const { motion } = this;
    const turns = new Float32Array(Math.max(motion.frames, 1));
    const position = new Vector3();
    const rotation = new Quaternion();
    const turn = new Quaternion();
    turns.forEach((_, frame) => {
      motion.localAt(frame, joint, position, rotation);
      const { w } = motion.turn(joint, rotation, turn);
      turns[frame] = 2 * Math.acos(Math.min(Math.abs(w), 1)) * DEGREES;
    });
    return turns;
  }

  // Bounds of the joints in their current pose, extended by the body around them, in the group's
  // space.
  boxNow() {
    const { motion, skeleton } = this;
    const box = new Box3();
    motion.positions.forEach((position, joint) => {
      if (!skeleton.small.has(joint) || motion.endSites.has(joint)) box.expandByPoint(position);
    });
    if (box.isEmpty()) box.setFromPoints(motion.positions);
    return this.body ? widen(box, this.body.reach) : box;
  }

  // Shows or hides bones, joints and body. Without a body, the skeleton is always shown.
  show({ skeleton, body, goals, wireframe }) {
    if (this.goals) this.goals.group.visible = goals;
    this.skeleton.group.visible = skeleton || !this.body;
    if (!this.body) return;
    this.body.mesh.visible = body;
    this.body.setWireframe(wireframe);
    this.body.letThrough(this.skeleton.group.visible);
  }

  update(time) {
    const { motion } = this;
    motion.pose(time);
    if (this.skeleton.group.visible) this.skeleton.place();
    if (this.body?.mesh.visible) this.body.place(motion);
    if (this.contacts.length > 0) this.markContacts(time);
    this.goals?.update(time);
  }

  // Colours the joints in contact, of the skeleton and of the body.
  markContacts(time) {
    const touching = this.contacts.filter(({ start, end }) => time >= start && time <= end).map(({ joint }) => joint);
    this.body?.touch(touching);
    const state = touching.join();
    if (this.marked === state || this.painted) return;
    this.marked = state;
    this.skeleton.mark(touching, new Color(CONTACT_COLOUR));
  }

  // As one of two that are compared: 'own' (of none), 'difference' or 'ghost'.
  setMode(mode) {
    this.body?.setMode(mode);
    this.skeleton.setGhost(mode === 'ghost');
    this.painted = mode === 'difference';
    this.marked = null;
    this.skeleton.plain();
  }

  jointMatrix(joint, into = new Matrix4()) {
    return this.motion.matrix(joint, into);
  }
}
