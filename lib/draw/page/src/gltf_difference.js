// Two glTF files compared: the vertices of one are coloured by their distance from those of the other,
// which is a ghost. Meshes match by name, else in their order, if they have as many vertices.

import { BufferAttribute, Color, MeshStandardMaterial, Vector3 } from 'three';
import { ghostMaterial } from './body_view.js';
import { ComparedPair } from './compared_pair.js';
import { ramp } from './ramp.js';

// Times of the animations for the largest distance: as many as this number of vertices allows.
const MOST_SAMPLES = 60;
const FEWEST_SAMPLES = 5;
const VERTICES = 600000;

const countOf = (mesh) => mesh.geometry.attributes.position.count;

function meshesOf(actor) {
  const meshes = [];
  actor.meshes.traverse((node) => { if (node.isMesh) meshes.push(node); });
  return meshes;
}

// [{mesh, partner}]; no mesh is the partner of two.
function pairsOf(meshes, others) {
  const free = new Set(others);
  return meshes.map((mesh, i) => {
    const fits = (other) => free.has(other) && countOf(other) === countOf(mesh);
    const partner = others.find((other) => other.name === mesh.name && fits(other)) ?? (fits(others[i]) ? others[i] : null);
    free.delete(partner);
    return partner && { mesh, partner };
  }).filter(Boolean);
}

export class GltfDifference extends ComparedPair {
  constructor(one, other) {
    super(one, other);
    const others = meshesOf(other);
    this.own = new Map([...others, ...meshesOf(one)].map((mesh) => [mesh, {
      material: mesh.material, castShadow: mesh.castShadow, colour: mesh.geometry.attributes.color,
    }]));
    this.pairs = pairsOf(meshesOf(one), others);
    this.shared = this.pairs.length;
    if (this.shared === 0) return;
    const ghost = ghostMaterial();
    for (const mesh of others) {
      mesh.material = ghost;
      mesh.castShadow = false;
    }
    const painted = new MeshStandardMaterial({ roughness: 0.85, vertexColors: true });
    for (const { mesh } of this.pairs) {
      mesh.material = painted;
      mesh.geometry.setAttribute('color', new BufferAttribute(new Float32Array(3 * countOf(mesh)), 3));
    }
    const measured = one.item.difference;
    if (measured?.from === other.item.name && measured.animation === one.animation && measured.other_animation === other.animation) {
      this.take(measured);
      return;
    }
    const vertices = this.pairs.reduce((sum, { mesh }) => sum + countOf(mesh), 0);
    const samples = Math.min(Math.max(Math.floor(VERTICES / vertices), FEWEST_SAMPLES), MOST_SAMPLES);
    this.measure(samples, () => this.distances().reduce((most, metres) => Math.max(most, metres), 0));
  }

  release() {
    for (const [mesh, { material, castShadow, colour }] of this.own) {
      Object.assign(mesh, { material, castShadow });
      if (colour) mesh.geometry.setAttribute('color', colour);
      else mesh.geometry.deleteAttribute('color');
    }
  }

  // Of all vertices, mesh by mesh, metres.
  distances() {
    const here = new Vector3();
    const there = new Vector3();
    const all = [];
    for (const { mesh, partner } of this.pairs) {
      for (let i = 0; i < countOf(mesh); ++i) {
        mesh.getVertexPosition(i, here).applyMatrix4(mesh.matrixWorld).sub(this.one.group.position);
        partner.getVertexPosition(i, there).applyMatrix4(partner.matrixWorld).sub(this.other.group.position);
        all.push(here.distanceTo(there));
      }
    }
    return all;
  }

  // After both were updated to the same time.
  update(time) {
    const distances = this.distances();
    const largest = { distance: 0, name: '' };
    let next = 0;
    for (const { mesh } of this.pairs) {
      for (let i = 0; i < countOf(mesh); ++i, ++next) {
        if (distances[next] <= largest.distance) continue;
        largest.distance = distances[next];
        largest.name = `vertex ${i} of ${mesh.userData.name ?? mesh.name}`;
      }
    }
    this.note(largest, time);
    const colour = new Color();
    next = 0;
    for (const { mesh } of this.pairs) {
      const { color } = mesh.geometry.attributes;
      for (let i = 0; i < countOf(mesh); ++i) ramp(distances[next++] / this.scale, colour).toArray(color.array, 3 * i);
      color.needsUpdate = true;
    }
  }
}
