// Draws a motion: bones and joints, a skinned body, trails.

import {
  Bone,
  Box3,
  BufferAttribute,
  BufferGeometry,
  Color,
  DynamicDrawUsage,
  Group,
  InstancedMesh,
  Line,
  LineBasicMaterial,
  Matrix4,
  MeshStandardMaterial,
  OctahedronGeometry,
  Quaternion,
  Skeleton,
  SkinnedMesh,
  SphereGeometry,
  Vector3,
} from 'three';
import { Goals } from './goals.js';
import { makeMaterials } from './look.js';
import { view } from './motion.js';
import { reachBeyond, widen } from './reach.js';

export const COLOURS = ['#3d7fd9', '#e08a1e', '#2f9e63', '#b0509e', '#7a6a58', '#c2453d'];
export const CONTACT_COLOUR = '#e8412c';

const UP = new Vector3(0, 1, 0);

// Maps 0, 1/2, 1 to blue, yellow, red.
function ramp(share) {
  const stops = [new Color('#2a78d6'), new Color('#e8c84a'), new Color('#d03b3b')];
  const at = Math.min(Math.max(share, 0), 1) * 2;
  return at < 1 ? stops[0].lerp(stops[1], at) : stops[1].lerp(stops[2], at - 1);
}

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

export class Actor {
  constructor(item, motion, bytes, index) {
    this.item = item;
    this.motion = motion;
    this.colour = new Color(COLOURS[index % COLOURS.length]);
    this.group = new Group();
    this.bones = [];
    motion.parents.forEach((parent, joint) => {
      if (parent >= 0) this.bones.push({ joint, parent });
    });
    this.trails = new Map();
    this.contacts = item.contacts ?? [];

    motion.pose(0);
    this.size = this.measure();
    this.makeSkeleton();
    if (item.body) this.makeBody(item.body, bytes);
    if (item.goals) {
      this.goals = new Goals(item.goals, motion, bytes, this.size);
      this.group.add(this.goals.group);
    }
  }

  // The character's extent in its reference pose or first frame, which sets the size of bones and
  // joints.
  measure() {
    const low = new Vector3(Infinity, Infinity, Infinity);
    const high = new Vector3(-Infinity, -Infinity, -Infinity);
    for (const position of this.motion.positions) {
      low.min(position);
      high.max(position);
    }
    return Math.max(high.sub(low).length(), 1e-3);
  }

  makeSkeleton() {
    this.skeleton = new Group();
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
      this.skeleton.add(mesh);
    }
    this.group.add(this.skeleton);
    this.plainColours();
  }

  plainColours() {
    this.bones.forEach((_, i) => this.boneMesh.setColorAt(i, this.colour));
    const pale = this.colour.clone().lerp(new Color('#ffffff'), 0.35);
    this.motion.names.forEach((_, joint) => this.jointMesh.setColorAt(joint, pale));
    this.pale = pale;
    this.refreshColours();
  }

  // Colours bones and joints by a value from 0 to 1 per joint; null restores the plain colour.
  paint(shareOf) {
    this.motion.names.forEach((_, joint) => {
      const share = shareOf(joint);
      this.jointMesh.setColorAt(joint, share === null ? this.pale : ramp(share));
    });
    this.bones.forEach(({ joint }, i) => {
      const share = shareOf(joint);
      this.boneMesh.setColorAt(i, share === null ? this.colour : ramp(share));
    });
    this.refreshColours();
  }

  refreshColours() {
    if (this.boneMesh.instanceColor) this.boneMesh.instanceColor.needsUpdate = true;
    if (this.jointMesh.instanceColor) this.jointMesh.instanceColor.needsUpdate = true;
  }

  makeBody(body, bytes) {
    const geometry = new BufferGeometry();
    geometry.setAttribute('position', new BufferAttribute(view(bytes, Float32Array, body.positions), 3));
    geometry.setAttribute('normal', new BufferAttribute(view(bytes, Int8Array, body.normals), 4, true));
    geometry.setAttribute('skinIndex', new BufferAttribute(view(bytes, Uint16Array, body.joints), 4));
    geometry.setAttribute('skinWeight', new BufferAttribute(view(bytes, Uint8Array, body.weights), 4, true));
    geometry.setIndex(new BufferAttribute(view(bytes, Uint32Array, body.triangles), 1));
    const material = new MeshStandardMaterial({
      color: this.colour.clone().lerp(new Color('#ffffff'), 0.55),
      roughness: 0.75,
    });
    const reference = view(bytes, Float32Array, body.reference);
    const inverses = [];
    const joints = new Box3();
    this.bodyBones = this.motion.names.map((_, joint) => {
      const bone = new Bone();
      bone.matrixAutoUpdate = false;
      bone.matrixWorldAutoUpdate = false;
      const at = joint * 7;
      const position = new Vector3().fromArray(reference, at);
      joints.expandByPoint(position);
      inverses.push(
        new Matrix4()
          .compose(
            position,
            new Quaternion().fromArray(reference, at + 3),
            new Vector3(1, 1, 1),
          )
          .invert(),
      );
      return bone;
    });
    geometry.computeBoundingBox();
    this.reach = reachBeyond(joints, geometry.boundingBox);
    this.body = new SkinnedMesh(geometry, material);
    // Bones are in the character's own space, which the group then offsets.
    this.body.bind(new Skeleton(this.bodyBones, inverses), new Matrix4());
    this.body.bindMode = 'detached';
    this.body.frustumCulled = false;
    this.body.castShadow = true;
    this.group.add(this.body);
  }

  // Replaces the character's plain colour by the body's materials, if it has any.
  async dress(bytes) {
    const look = this.item.body?.look;
    if (!look) return;
    const { geometry } = this.body;
    if (look.coordinates) {
      geometry.setAttribute('uv', new BufferAttribute(view(bytes, Float32Array, look.coordinates), 2));
    }
    for (const { first, count, material } of look.parts) geometry.addGroup(first, count, material);
    this.body.material = await makeMaterials(look, bytes);
  }

  get duration() {
    return this.motion.duration;
  }

  get rate() {
    return this.motion.rate;
  }

  root() {
    return this.motion.positions[0];
  }

  jointPosition(joint) {
    return this.motion.positions[joint];
  }

  // Bounds of the joints in their current pose, extended by the body around them, in the group's
  // space.
  boxNow() {
    const box = new Box3().setFromPoints(this.motion.positions);
    return this.reach ? widen(box, this.reach) : box;
  }

  // Shows or hides bones, joints and body. Without a body, the skeleton is always shown.
  show({ skeleton, body, goals }) {
    if (this.goals) this.goals.group.visible = goals;
    const hasBody = Boolean(this.body);
    this.skeleton.visible = skeleton || !hasBody;
    if (hasBody) {
      this.body.visible = body;
      [this.body.material].flat().forEach((material) => this.letThrough(material));
    }
  }

  // Makes the body translucent while the skeleton is visible, otherwise restores its material.
  letThrough(material) {
    const { transparent, opacity, depthWrite } = material.userData.own ??= {
      transparent: material.transparent,
      opacity: material.opacity,
      depthWrite: material.depthWrite,
    };
    const through = this.skeleton.visible;
    // Transparency is compiled into a material's shader.
    material.needsUpdate = material.transparent !== (through || transparent);
    material.transparent = through || transparent;
    material.opacity = through ? 0.45 * opacity : opacity;
    material.depthWrite = !through && depthWrite;
  }

  update(time) {
    const { motion } = this;
    motion.pose(time);
    if (this.skeleton.visible) this.placeSkeleton(time);
    if (this.body && this.body.visible) {
      this.bodyBones.forEach((bone, joint) => motion.matrix(joint, bone.matrixWorld));
    }
    this.goals?.update(time);
  }

  placeSkeleton(time) {
    const { motion } = this;
    const matrix = new Matrix4();
    const turn = new Quaternion();
    const along = new Vector3();
    const scale = new Vector3();
    this.bones.forEach(({ joint, parent }, i) => {
      along.subVectors(motion.positions[joint], motion.positions[parent]);
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
      const r = motion.endSites.has(joint) ? radius * 0.6 : radius;
      matrix.compose(position, turn, scale.set(r, r, r));
      this.jointMesh.setMatrixAt(joint, matrix);
    });
    this.jointMesh.instanceMatrix.needsUpdate = true;
    this.colourContacts(time);
  }

  colourContacts(time) {
    if (this.contacts.length === 0) return;
    const touching = new Set();
    for (const { joint, start, end } of this.contacts) {
      if (time >= start && time <= end) touching.add(joint);
    }
    const red = new Color(CONTACT_COLOUR);
    for (const { joint } of this.contacts) {
      this.jointMesh.setColorAt(joint, touching.has(joint) ? red : this.pale);
    }
    this.bones.forEach(({ joint }, i) => {
      if (this.contactJoints().has(joint)) {
        this.boneMesh.setColorAt(i, touching.has(joint) ? red : this.colour);
      }
    });
    this.refreshColours();
  }

  contactJoints() {
    this.contactSet ??= new Set(this.contacts.map(({ joint }) => joint));
    return this.contactSet;
  }

  toggleTrail(joint) {
    const old = this.trails.get(joint);
    if (old) {
      this.group.remove(old);
      old.geometry.dispose();
      this.trails.delete(joint);
      return false;
    }
    const geometry = new BufferGeometry();
    geometry.setAttribute('position', new BufferAttribute(this.motion.path(joint), 3));
    const line = new Line(geometry, new LineBasicMaterial({ color: this.colour }));
    line.frustumCulled = false;
    this.group.add(line);
    this.trails.set(joint, line);
    return true;
  }
}
