// Footprints: soles in the colour of their side, with an arrow ahead of the toes and a number; those
// that a foot stands on have a border.

import {
  BufferAttribute,
  BufferGeometry,
  CanvasTexture,
  Color,
  DoubleSide,
  Group,
  InstancedMesh,
  Matrix4,
  Mesh,
  MeshBasicMaterial,
  Shape,
  ShapeGeometry,
  Vector3,
} from 'three';

export const PRINT_COLOURS = { left: '#3d7fd9', right: '#e08a1e' };
const MARK_COLOUR = '#ffd21f';
const LIFT = 0.004; // metres over the ground
const PULL = 0.02; // metres
const BORDER = 1.22; // size of a border, of the sole
const DIGIT = 64; // pixels
const DIGIT_SIZE = [0.13, 0.26]; // width and height of a digit, of the sole's length

// A material without light, drawn `pull` metres nearer to the camera than it is, so that ground that
// is curved below a sole does not show through.
function flat(options, pull) {
  const material = new MeshBasicMaterial({ side: DoubleSide, ...options });
  material.onBeforeCompile = (shader) => {
    shader.vertexShader = shader.vertexShader.replace('#include <project_vertex>', `#include <project_vertex>
      mvPosition.xyz *= max( 0.0, 1.0 - ${pull} / length( mvPosition.xyz ) );
      gl_Position = projectionMatrix * mvPosition;`);
  };
  material.customProgramCacheKey = () => `pulled by ${pull}`;
  return material;
}

// From the plane of the outline (x to the left, y ahead) to the sole's (x to the left, y up, z ahead).
function soleGeometry(outline, arrow) {
  const shapes = [new Shape(outline.map(([x, y]) => ({ x, y })))];
  if (arrow) shapes.push(new Shape([{ x: -0.06, y: 1.06 }, { x: 0.06, y: 1.06 }, { x: 0, y: 1.22 }]));
  const geometry = new ShapeGeometry(shapes);
  const { position } = geometry.attributes;
  for (let i = 0; i < position.count; ++i) position.setXYZ(i, position.getX(i), 0, position.getY(i));
  return geometry;
}

// The digits side by side, white on nothing.
function digitTexture() {
  const canvas = document.createElement('canvas');
  canvas.width = 10 * DIGIT;
  canvas.height = 2 * DIGIT;
  const pen = canvas.getContext('2d');
  pen.fillStyle = 'white';
  pen.font = `bold ${1.8 * DIGIT}px sans-serif`;
  pen.textAlign = 'center';
  pen.textBaseline = 'middle';
  for (let digit = 0; digit < 10; ++digit) pen.fillText(String(digit), (digit + 0.5) * DIGIT, 1.05 * DIGIT, DIGIT * 0.92);
  const texture = new CanvasTexture(canvas);
  texture.anisotropy = 8;
  return texture;
}

export class Prints {
  constructor({ outline, list }) {
    this.group = new Group();
    this.list = list.map((print) => {
      const forward = new Vector3(...print.forward);
      const up = new Vector3(...print.up);
      const left = new Vector3().crossVectors(up, forward).normalize();
      const matrix = new Matrix4().makeBasis(left, up, forward)
        .scale(new Vector3(print.length, print.length, print.length));
      matrix.setPosition(new Vector3(...print.heel).addScaledVector(up, LIFT));
      return { ...print, matrix, planted: false };
    });
    // Mirrored and turned round, to face up all the same.
    const shapes = { left: outline, right: outline.map(([x, y]) => [-x, y]).reverse() };
    this.borders = {};
    for (const [side, shape] of Object.entries(shapes)) {
      const prints = this.list.filter((print) => print.side === side);
      const soles = new InstancedMesh(
        soleGeometry(shape, true), flat({ color: PRINT_COLOURS[side] }, PULL + 0.002), Math.max(prints.length, 1));
      soles.count = prints.length;
      prints.forEach(({ matrix }, i) => soles.setMatrixAt(i, matrix));
      const grown = shape.map(([x, y]) => [x * (BORDER + 0.15), (y - 0.5) * BORDER + 0.5]);
      const border = new InstancedMesh(
        soleGeometry(grown, false), flat({ color: MARK_COLOUR }, PULL), Math.max(prints.length, 1));
      border.count = 0;
      this.borders[side] = border;
      for (const mesh of [soles, border]) {
        mesh.frustumCulled = false;
        this.group.add(mesh);
      }
    }
    this.group.add(this.numbers());
  }

  // One quad a digit, across the ball of the sole.
  numbers() {
    const places = [];
    const textured = [];
    const corners = [];
    const corner = new Vector3();
    for (const { number, matrix, side } of this.list) {
      const digits = String(number);
      const scale = Math.min(1, 2.2 / digits.length);
      const [wide, high] = DIGIT_SIZE.map((size) => size * scale);
      const middle = side === 'left' ? 0.01 : -0.01;
      [...digits].forEach((digit, i) => {
        const first = places.length / 3;
        // Read from behind, the left of a number is to the walker's left.
        const left = middle + (digits.length / 2 - i) * wide;
        for (const [right, above] of [[0, 0], [1, 0], [1, 1], [0, 1]]) {
          corner.set(left - right * wide, LIFT, 0.7 + (above - 0.5) * high).applyMatrix4(matrix);
          places.push(corner.x, corner.y, corner.z);
          textured.push((Number(digit) + right) / 10, above);
        }
        corners.push(first, first + 1, first + 2, first, first + 2, first + 3);
      });
    }
    const geometry = new BufferGeometry();
    geometry.setAttribute('position', new BufferAttribute(new Float32Array(places), 3));
    geometry.setAttribute('uv', new BufferAttribute(new Float32Array(textured), 2));
    geometry.setIndex(corners);
    const mesh = new Mesh(geometry, flat({
      map: digitTexture(), color: new Color('#ffffff'), transparent: true, depthWrite: false,
    }, PULL + 0.004));
    mesh.frustumCulled = false;
    return mesh;
  }

  // Marks the prints that one of `motions` stands on: lists of [print, start, end].
  update(time, motions) {
    for (const print of this.list) print.planted = false;
    for (const contacts of motions) {
      for (const [index, start, end] of contacts) {
        if (time >= start - 1e-6 && time <= end + 1e-6) this.list[index].planted = true;
      }
    }
    for (const [side, border] of Object.entries(this.borders)) {
      border.count = 0;
      for (const print of this.list) {
        if (print.planted && print.side === side) border.setMatrixAt(border.count++, print.matrix);
      }
      border.instanceMatrix.needsUpdate = true;
    }
  }
}
