// Two motions compared: one is coloured by its distance from the other, which is a ghost.

import { Matrix4, Vector3 } from 'three';
import { ComparedPair } from './compared_pair.js';

const SAMPLES = 400; // of the motions, for the largest distance

export const lengthText = (metres) =>
  metres < 0.1 ? `${(metres * 1000).toPrecision(3)} mm`
    : metres < 1 ? `${(metres * 100).toPrecision(3)} cm` : `${metres.toPrecision(3)} m`;

export class Difference extends ComparedPair {
  constructor(one, other) {
    super(one, other);
    const place = new Map(other.motion.names.map((name, joint) => [name, joint]));
    // For each joint of the one the other's of the same name, or -1; and the nearest joint at or
    // above it that has one, with which a joint without moves.
    this.partner = one.motion.names.map((name) => place.get(name) ?? -1);
    this.carrier = [];
    one.motion.parents.forEach((parent, joint) => {
      this.carrier[joint] = this.partner[joint] >= 0 || parent < 0 ? joint : this.carrier[parent];
    });
    this.shared = this.partner.filter((joint) => joint >= 0).length;
    this.makeBinds();
    this.measure(SAMPLES, () => Math.max(...this.distances()));
    this.one.setMode('difference');
    this.other.setMode('ghost');
  }

  release() {
    this.one.setMode('own');
    this.other.setMode('own');
  }

  // From the one's joints to the other's in their bind poses, if the bodies are bound in the same
  // pose: orientations of joints may differ by convention. Otherwise as if they did not.
  makeBinds() {
    const { one, other } = this;
    if (!one.body || !other.body) return;
    const apart = this.partner.some((joint, i) => {
      if (joint < 0) return false;
      const here = new Vector3().setFromMatrixPosition(one.body.bindOf(i));
      return here.distanceTo(new Vector3().setFromMatrixPosition(other.body.bindOf(joint))) > 0.02 * one.size;
    });
    if (apart) return;
    this.binds = this.partner.map((joint, i) => (joint < 0 ? null
      : other.body.bindOf(joint).invert().multiply(one.body.bindOf(i))));
  }

  distances() {
    const { one, other } = this;
    return this.partner.map((joint, i) => (joint < 0 ? null
      : one.motion.positions[i].distanceTo(other.motion.positions[joint])));
  }

  pose(time) {
    this.one.motion.pose(time);
    this.other.motion.pose(time);
  }

  // After both were updated to the same time.
  update(time) {
    const { one, other } = this;
    const distances = this.distances();
    let largest = { distance: 0, name: '' };
    distances.forEach((distance, joint) => {
      if (distance > largest.distance) largest = { distance, name: one.names[joint] };
    });
    this.note(largest, time);
    one.skeleton.paint((joint) => (distances[joint] === null ? null : distances[joint] / this.scale));
    if (!one.body?.mesh.visible) return;
    const back = new Matrix4();
    one.body.compare((joint, into) => {
      const carrier = this.carrier[joint];
      const partner = this.partner[carrier];
      if (partner < 0) return one.jointMatrix(joint, into);
      other.jointMatrix(partner, into);
      if (this.binds) into.multiply(this.binds[carrier]);
      if (carrier === joint) return into;
      // Moves with the joint above.
      return into.multiply(one.jointMatrix(carrier, back).invert()).multiply(one.jointMatrix(joint, back));
    }, this.scale);
  }
}
