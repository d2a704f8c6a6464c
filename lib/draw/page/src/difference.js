// Two motions compared: the first is coloured by its distance from the second, the second is a ghost.

import { Matrix4, Vector3 } from 'three';

const SAMPLES = 400; // of the motions, for the largest distance

export const lengthText = (metres) =>
  metres < 0.1 ? `${(metres * 1000).toPrecision(3)} mm`
    : metres < 1 ? `${(metres * 100).toPrecision(3)} cm` : `${metres.toPrecision(3)} m`;

const STEPS = [1, 1.5, 2, 3, 4, 5, 6, 8, 10];

// One of these times a power of ten: the least that is not smaller, but for rounding errors.
function roundUp(value) {
  const power = 10 ** Math.floor(Math.log10(value));
  return STEPS.map((step) => step * power).find((step) => step >= value * (1 - 1e-4));
}

export class Difference {
  constructor(one, other) {
    this.one = one;
    this.other = other;
    const place = new Map(other.motion.names.map((name, joint) => [name, joint]));
    // For each joint of the first the second's of the same name, or -1; and the nearest joint at or
    // above it that has one, with which a joint without moves.
    this.partner = one.motion.names.map((name) => place.get(name) ?? -1);
    this.carrier = [];
    one.motion.parents.forEach((parent, joint) => {
      this.carrier[joint] = this.partner[joint] >= 0 || parent < 0 ? joint : this.carrier[parent];
    });
    this.shared = this.partner.filter((joint) => joint >= 0).length;
    this.makeBinds();
    this.measure();
    this.one.setMode('difference');
    this.other.setMode('ghost');
  }

  release() {
    this.one.setMode('own');
    this.other.setMode('own');
  }

  // From the first's joints to the second's in their bind poses, if the bodies are bound in the same
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

  // The largest distance of joints over time, which sets the scale; for the time line, too.
  measure() {
    const { one, other } = this;
    const duration = Math.min(one.duration, other.duration);
    const count = Math.min(SAMPLES, Math.round(duration * Math.max(one.rate, other.rate)) + 1);
    this.values = new Float32Array(count);
    this.rate = count > 1 ? (count - 1) / duration : 1;
    for (let i = 0; i < count; ++i) {
      one.motion.pose(i / this.rate);
      other.motion.pose(i / this.rate);
      this.values[i] = Math.max(0, ...this.distances());
    }
    this.worstDistance = Math.max(...this.values);
    this.worst = this.values.indexOf(this.worstDistance) / this.rate;
    this.scale = this.ownScale = roundUp(Math.max(this.worstDistance, 1e-6));
  }

  // For the time line.
  curve() {
    return {
      name: 'Difference', unit: 'mm', floor: 0, colour: '#8f1237', rate: this.rate,
      values: this.values.map((metres) => metres * 1000),
    };
  }

  // After both were updated to the same time.
  update() {
    const { one, other } = this;
    const distances = this.distances();
    this.largest = { distance: 0, name: '' };
    distances.forEach((distance, joint) => {
      if (distance > this.largest.distance) this.largest = { distance, name: one.names[joint] };
    });
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
