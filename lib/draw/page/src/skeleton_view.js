// Draws a skeleton: bones, joints, stubs beyond joints that end without an end site, and thin dashed
// lines from a root that only positions the character.

import {
  BufferAttribute,
  BufferGeometry,
  Color,
  DynamicDrawUsage,
  Group,
  InstancedMesh,
  LineDashedMaterial,
  LineSegments,
  Matrix4,
  MeshStandardMaterial,
  OctahedronGeometry,
  Quaternion,
  SphereGeometry,
  Vector3,
} from 'three';
import { ramp } from './ramp.js';

const UP = new Vector3(0, 1, 0);
const GHOST = 0.35; // opacity

// A bone along +Y from 0 to 1, thickest near its root.
function boneGeometry() {
  const ring = 0.22;
  const wide = 0.5;
  const corners = [
    [0, 0, 0],
    [wide, ring, 0],
    [0, ring, wide],
    [-wide, ring, 0],
    [0, ring, -wide],
    [0, 1, 0],
  ];
  const faces = [];
  for (let i = 0; i < 4; ++i) {
    const a = 1 + i;
    const b = 1 + ((i + 1) % 4);
    faces.push(0, a, b, 5, b, a);
  }
  const positions = faces.flatMap((corner) => corners[corner]);
  const geometry = new BufferGeometry();
  geometry.setAttribute('position', new BufferAttribute(new Float32Array(positions), 3));
  geometry.computeVertexNormals();
  return geometry;
}

export class SkeletonView {
  // `size`: of the character, to which bones and joints are in proportion.
  constructor(motion, item, colour, size) {
    this.motion = motion;
    this.colour = colour;
    this.pale = colour.clone().lerp(new Color('#ffffff'), 0.35);
    this.size = size;
    this.group = new Group();
    this.loose = new Set(item.loose ?? []);
    // From the parent to the joint; or for a stub from the joint to `tip`.
    this.bones = [];
    motion.parents.forEach((parent, joint) => {
      if (parent >= 0 && !this.loose.has(joint)) this.bones.push({ joint, parent });
    });
    for (const [joint, ...tip] of item.stubs ?? []) {
      this.bones.push({ joint, parent: joint, tip: new Vector3(...tip) });
    }
    this.small = new Set([...motion.endSites, ...this.loose].filter((joint) => joint !== item.hips));
    if (this.loose.size > 0) this.small.add(0);
    this.makeMeshes();
    if (this.loose.size > 0) this.makeDashes();
    this.plain();
  }

  makeMeshes() {
    const material = () => new MeshStandardMaterial({ roughness: 0.6, metalness: 0.05 });
    this.boneMesh = new InstancedMesh(boneGeometry(), material(), Math.max(this.bones.length, 1));
    this.boneMesh.count = this.bones.length;
    this.jointMesh = new InstancedMesh(
      this.motion.names.length > 500 ? new OctahedronGeometry(1) : new SphereGeometry(1, 12, 8),
      material(),
      this.motion.names.length,
    );
    for (const mesh of [this.boneMesh, this.jointMesh]) {
      mesh.castShadow = true;
      mesh.frustumCulled = false;
      mesh.instanceMatrix.setUsage(DynamicDrawUsage);
      this.group.add(mesh);
    }
  }

  makeDashes() {
    const dash = this.size * 0.012;
    const geometry = new BufferGeometry();
    geometry.setAttribute('position', new BufferAttribute(new Float32Array(this.loose.size * 6), 3));
    geometry.setAttribute('lineDistance', new BufferAttribute(new Float32Array(this.loose.size * 2), 1));
    this.dashes = new LineSegments(geometry, new LineDashedMaterial({
      color: this.colour, dashSize: dash, gapSize: dash, transparent: true, opacity: 0.7,
    }));
    this.dashes.frustumCulled = false;
    this.group.add(this.dashes);
  }

  plain() {
    this.setColours(() => null);
  }

  // Colours bones and joints by a value from 0 to 1 per joint; null is the plain colour.
  paint(shareOf) {
    const painted = new Color();
    this.setColours((joint) => {
      const share = shareOf(joint);
      return share === null ? null : ramp(share, painted);
    });
  }

  // Joints in contact are red, and the bones from there on: the foot, not the shank.
  mark(joints, colour) {
    this.setColours((joint) => (joints.includes(joint) ? colour : null), 'parent');
  }

  // A bone has the colour of the joint that it leads to, or of its `parent`.
  setColours(colourOf, end = 'joint') {
    this.motion.names.forEach((_, joint) => this.jointMesh.setColorAt(joint, colourOf(joint) ?? this.pale));
    this.bones.forEach((bone, i) => this.boneMesh.setColorAt(i, colourOf(bone[end]) ?? this.colour));
    this.jointMesh.instanceColor.needsUpdate = true;
    if (this.boneMesh.instanceColor) this.boneMesh.instanceColor.needsUpdate = true;
  }

  // Translucent, as what another is compared with.
  setGhost(ghost) {
    for (const { material } of [this.boneMesh, this.jointMesh]) {
      material.needsUpdate = material.transparent !== ghost;
      material.transparent = ghost;
      material.depthWrite = !ghost;
      material.opacity = ghost ? GHOST : 1;
    }
  }

  place() {
    const { motion } = this;
    const matrix = new Matrix4();
    const turn = new Quaternion();
    const along = new Vector3();
    const scale = new Vector3();
    this.bones.forEach(({ joint, parent, tip }, i) => {
      if (tip) along.copy(tip).applyQuaternion(motion.orientations[joint]);
      else along.subVectors(motion.positions[joint], motion.positions[parent]);
      const length = along.length();
      turn.setFromUnitVectors(UP, length > 1e-9 ? along.divideScalar(length) : UP);
      const width = Math.min(length * 0.28, this.size * 0.03);
      matrix.compose(motion.positions[parent], turn, scale.set(width, length, width));
      this.boneMesh.setMatrixAt(i, matrix);
    });
    this.boneMesh.instanceMatrix.needsUpdate = true;
    const radius = this.size * 0.009;
    turn.identity();
    motion.positions.forEach((position, joint) => {
      const r = this.small.has(joint) ? radius * 0.6 : radius;
      matrix.compose(position, turn, scale.set(r, r, r));
      this.jointMesh.setMatrixAt(joint, matrix);
    });
    this.jointMesh.instanceMatrix.needsUpdate = true;
    if (this.dashes) this.placeDashes();
  }

  placeDashes() {
    const { motion } = this;
    const { position, lineDistance } = this.dashes.geometry.attributes;
    let i = 0;
    for (const joint of this.loose) {
      const from = motion.positions[motion.parents[joint]];
      const to = motion.positions[joint];
      from.toArray(position.array, i * 3);
      to.toArray(position.array, i * 3 + 3);
      lineDistance.array[i + 1] = from.distanceTo(to);
      i += 2;
    }
    position.needsUpdate = true;
    lineDistance.needsUpdate = true;
  }
}
