// Goals of inverse kinematics: a marker at each goal's place, a line to it, the chain of joints that
// takes part, and by how much the goal is missed.

import {
  BufferAttribute,
  BufferGeometry,
  Color,
  Group,
  Line,
  LineBasicMaterial,
  Mesh,
  MeshBasicMaterial,
  OctahedronGeometry,
  Vector3,
} from 'three';
import { view } from './motion.js';

const NUMBERS = 9; // a frame: from, to, strength, distance, angle
const GOAL_COLOURS = ['#d6336c', '#1c7c8c', '#8a5cd6', '#b8860b', '#3f7d20', '#c2453d'];
const WITH_DISTANCE = new Set(['position', 'pose', 'balance']);
const WITH_ANGLE = new Set(['orientation', 'pose', 'look-at', 'pole']);

const DEGREES = 180 / Math.PI;
const digits = (value) => (value >= 100 ? value.toFixed(0) : value.toPrecision(2));
const exact = (value, unit) => (value < 0.005 ? `< 0.01 ${unit}` : `${digits(value)} ${unit}`);

// Drawn over the body, which would hide what is inside it.
const over = (Material, color) => new Material({ color, depthTest: false, transparent: true });

export class Goals {
  // `size` is the character's; markers are in proportion to it.
  constructor(list, motion, bytes, size) {
    this.motion = motion;
    this.group = new Group();
    this.goals = list.map(({ name, kind, chain, frames }, index) => {
      const colour = new Color(GOAL_COLOURS[index % GOAL_COLOURS.length]);
      const goal = {
        name,
        kind,
        chain,
        colour: `#${colour.getHexString()}`,
        frames: view(bytes, Float32Array, frames),
        from: new Vector3(),
        to: new Vector3(),
        marker: new Mesh(new OctahedronGeometry(size * 0.014), over(MeshBasicMaterial, colour)),
        line: this.makeLine(2, over(LineBasicMaterial, colour)),
        limb: this.makeLine(Math.max(chain.length, 1), over(LineBasicMaterial, colour)),
      };
      for (const part of [goal.marker, goal.line, goal.limb]) {
        part.renderOrder = 2;
        this.group.add(part);
      }
      return goal;
    });
  }

  makeLine(points, material) {
    const geometry = new BufferGeometry();
    geometry.setAttribute('position', new BufferAttribute(new Float32Array(points * 3), 3));
    const line = new Line(geometry, material);
    line.frustumCulled = false;
    return line;
  }

  // After the motion's own pose(time).
  update(time) {
    const { motion } = this;
    const frame = Math.min(Math.max(Math.round(time * motion.rate), 0), motion.frames - 1);
    for (const goal of this.goals) {
      const at = frame * NUMBERS;
      goal.from.fromArray(goal.frames, at);
      goal.to.fromArray(goal.frames, at + 3);
      [goal.strength, goal.distance, goal.angle] = goal.frames.subarray(at + 6, at + NUMBERS);
      const active = goal.strength > 0;
      for (const part of [goal.marker, goal.line, goal.limb]) {
        part.visible = active;
        part.material.opacity = 0.25 + 0.75 * goal.strength;
      }
      if (!active) continue;
      goal.marker.position.copy(goal.to);
      this.setPoints(goal.line, [goal.from, goal.to]);
      this.setPoints(goal.limb, goal.chain.map((joint) => motion.positions[joint]));
    }
  }

  setPoints(line, points) {
    const { position } = line.geometry.attributes;
    points.forEach((point, i) => point.toArray(position.array, i * 3));
    position.needsUpdate = true;
  }
}

// By how much a goal is missed. While it fades it is not meant to be met.
export function missText({ kind, strength, distance, angle }) {
  if (!(strength > 0)) return 'not active';
  if (strength < 1) return `fades, ${Math.round(strength * 100)} %`;
  const parts = [];
  if (WITH_DISTANCE.has(kind)) parts.push(exact(distance * 1000, 'mm'));
  if (WITH_ANGLE.has(kind)) parts.push(exact(angle * DEGREES, '°'));
  return `off by ${parts.join(', ')}`;
}
