// A motion stored in the page: packed local rotations, sampled at any time.

import { Matrix4, Quaternion, Vector3 } from 'three';

const ROTATION_WORDS = 3; // 16-bit words per joint and frame
const COMPONENT_LIMIT = Math.SQRT1_2; // bound of the three smaller quaternion components

const decoded = new Map();

// Decodes a base64 script element, once.
export function blobBytes(id) {
  if (decoded.has(id)) return decoded.get(id);
  const element = document.getElementById(id);
  const text = atob(element.textContent.trim());
  element.textContent = ''; // frees the text, so that the data is not held twice
  const bytes = new Uint8Array(text.length);
  for (let i = 0; i < text.length; ++i) bytes[i] = text.charCodeAt(i);
  decoded.set(id, bytes);
  return bytes;
}

// Arrays in a blob are 4-byte aligned.
export const view = (bytes, Type, place) =>
  new Type(bytes.buffer, bytes.byteOffset + place.offset, place.count);

// Unpacks 48 bits: 2 bits are the index of the dropped component (the largest, made positive), the
// others take 15 bits each in the order x, y, z, w.
export function unpackRotation(words, at, into) {
  const a = words[at];
  const b = words[at + 1];
  const c = words[at + 2];
  const left = (a >> 15) | ((b >> 15) << 1);
  const unpack = (word) => ((word & 0x7fff) / 32767) * 2 * COMPONENT_LIMIT - COMPONENT_LIMIT;
  const p = unpack(a);
  const q = unpack(b);
  const r = unpack(c);
  const rest = Math.sqrt(Math.max(0, 1 - p * p - q * q - r * r));
  if (left === 0) into.set(rest, p, q, r);
  else if (left === 1) into.set(p, rest, q, r);
  else if (left === 2) into.set(p, q, rest, r);
  else into.set(p, q, r, rest);
  return into;
}

export class Motion {
  constructor(item, bytes) {
    this.names = item.joints;
    this.parents = item.parents;
    this.endSites = new Set(item.endSites);
    this.rate = item.rate;
    this.frames = item.frames;
    this.offsets = view(bytes, Float32Array, item.offsets);
    this.referenceRotations = view(bytes, Float32Array, item.referenceRotations);
    // Relative to the parent in the reference pose.
    this.rest = view(bytes, Float32Array, item.rest);
    // Joints with a changing rotation, in the order of the packed rotations.
    this.turning = item.turning;
    this.turningAt = new Map(item.turning.map((joint, i) => [joint, i]));
    this.rotations = view(bytes, Uint16Array, item.rotations);
    // Joints with a changing local translation, the root first.
    this.moving = item.moving;
    this.movingAt = new Map(item.moving.map((joint, i) => [joint, i]));
    this.translations = view(bytes, Float32Array, item.translations);

    const count = this.names.length;
    this.local = Array.from({ length: count }, (_, joint) => ({
      position: new Vector3().fromArray(this.offsets, joint * 3),
      rotation: new Quaternion().fromArray(this.referenceRotations, joint * 4),
    }));
    this.positions = Array.from({ length: count }, () => new Vector3());
    this.orientations = Array.from({ length: count }, () => new Quaternion());
    this.from = new Quaternion();
    this.to = new Quaternion();
    this.there = new Vector3();
  }

  get duration() {
    return this.frames > 1 ? (this.frames - 1) / this.rate : 0;
  }

  // Computes all joints' world positions and orientations at `time` seconds.
  pose(time) {
    if (this.frames > 0) this.readFrames(time);
    for (let joint = 0; joint < this.names.length; ++joint) {
      const parent = this.parents[joint];
      const { position, rotation } = this.local[joint];
      if (parent < 0) {
        this.positions[joint].copy(position);
        this.orientations[joint].copy(rotation);
        continue;
      }
      this.positions[joint]
        .copy(position)
        .applyQuaternion(this.orientations[parent])
        .add(this.positions[parent]);
      this.orientations[joint].multiplyQuaternions(this.orientations[parent], rotation);
    }
  }

  readFrames(time) {
    const at = Math.min(Math.max(time * this.rate, 0), this.frames - 1);
    // A time computed from a frame index gives exactly that frame.
    const frame = Math.min(Math.floor(at + 1e-6), this.frames - 1);
    const fraction = Math.max(at - frame, 0);
    const next = Math.min(frame + 1, this.frames - 1);
    const words = this.turning.length * ROTATION_WORDS;
    this.turning.forEach((joint, i) => {
      const { rotation } = this.local[joint];
      unpackRotation(this.rotations, frame * words + i * ROTATION_WORDS, rotation);
      if (fraction > 0) {
        unpackRotation(this.rotations, next * words + i * ROTATION_WORDS, this.to);
        rotation.slerp(this.to, fraction);
      }
    });
    const numbers = this.moving.length * 3;
    this.moving.forEach((joint, i) => {
      const { position } = this.local[joint];
      position.fromArray(this.translations, frame * numbers + i * 3);
      if (fraction > 0) {
        position.lerp(this.there.fromArray(this.translations, next * numbers + i * 3), fraction);
      }
    });
  }

  // A joint relative to its parent in one frame.
  localAt(frame, joint, position, rotation) {
    const moving = this.movingAt.get(joint);
    if (moving !== undefined && this.frames > 0) {
      position.fromArray(this.translations, (frame * this.moving.length + moving) * 3);
    } else {
      position.fromArray(this.offsets, joint * 3);
    }
    const turning = this.turningAt.get(joint);
    if (turning !== undefined && this.frames > 0) {
      unpackRotation(this.rotations, (frame * this.turning.length + turning) * ROTATION_WORDS, rotation);
    } else {
      rotation.fromArray(this.referenceRotations, joint * 4);
    }
  }

  // World positions of one joint, three numbers per frame.
  path(joint) {
    const chain = [];
    for (let at = joint; at >= 0; at = this.parents[at]) chain.push(at);
    const count = Math.max(this.frames, 1);
    const path = new Float32Array(count * 3);
    const place = new Vector3();
    const position = new Vector3();
    const rotation = new Quaternion();
    for (let frame = 0; frame < count; ++frame) {
      place.set(0, 0, 0);
      for (const at of chain) {
        this.localAt(frame, at, position, rotation);
        place.applyQuaternion(rotation).add(position);
      }
      place.toArray(path, frame * 3);
    }
    return path;
  }

  // A joint's rotation from the reference pose, relative to its parent.
  turn(joint, local = this.local[joint].rotation, into = new Quaternion()) {
    return into.fromArray(this.rest, joint * 4).invert().multiply(local);
  }

  // joint_to_world of a joint after pose().
  matrix(joint, into = new Matrix4()) {
    return into.compose(this.positions[joint], this.orientations[joint], new Vector3(1, 1, 1));
  }
}

export class CameraTrack {
  constructor(item, bytes) {
    this.rate = item.rate;
    this.frames = item.frames;
    this.cuts = new Set(item.cuts);
    this.positions = view(bytes, Float32Array, item.positions);
    this.rotations = view(bytes, Float32Array, item.orientations);
    this.fields = view(bytes, Float32Array, item.fieldsOfView);
    this.position = new Vector3();
    this.orientation = new Quaternion();
    this.fieldOfView = 0.7;
    this.to = new Quaternion();
    this.there = new Vector3();
  }

  get duration() {
    return this.frames > 1 ? (this.frames - 1) / this.rate : 0;
  }

  pose(time) {
    if (this.frames === 0) return;
    const at = Math.min(Math.max(time * this.rate, 0), this.frames - 1);
    const frame = Math.min(Math.floor(at + 1e-6), this.frames - 1);
    const next = Math.min(frame + 1, this.frames - 1);
    const fraction = this.cuts.has(next) ? 0 : Math.max(at - frame, 0);
    this.position.fromArray(this.positions, frame * 3);
    this.position.lerp(this.there.fromArray(this.positions, next * 3), fraction);
    this.orientation.fromArray(this.rotations, frame * 4);
    this.orientation.slerp(this.to.fromArray(this.rotations, next * 4), fraction);
    this.fieldOfView = this.fields[frame] * (1 - fraction) + this.fields[next] * fraction;
  }
}
