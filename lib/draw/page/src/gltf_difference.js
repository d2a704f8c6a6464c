// Two glTF files compared: the vertices of one are coloured by their distance from those of the other,
// which is a ghost. Meshes match by name, else in their order, if they have as many vertices.

import { BufferAttribute, Color, MeshStandardMaterial, Vector3 } from 'three';
import { ghostMaterial } from './body_view.js';
import { ComparedPair } from './compared_pair.js';
import { ramp } from './ramp.js';

const SAMPLES = 60; // of the animations, for the largest distance
const LOOKED_AT = 3000; // vertices at each of these

const countOf = (mesh) => mesh.geometry.attributes.position.count;

function meshesOf(actor) {
  const meshes = [];
  actor.meshes.traverse((node) => { if (node.isMesh) meshes.push(node); });
  return meshes;
}

export class GltfDifference extends ComparedPair {
  constructor(one, other) {
    super(one, other);
    const others = meshesOf(other);
    this.own = new Map([...others, ...meshesOf(one)].map((mesh) => [mesh, {
      material: mesh.material, castShadow: mesh.castShadow, colour: mesh.geometry.attributes.color,
    }]));
    this.pairs = meshesOf(one).map((mesh, i) => {
      const partner = others.find(({ name }) => name === mesh.name) ?? others[i];
      return partner && countOf(partner) === countOf(mesh) ? { mesh, partner } : null;
    }).filter(Boolean);
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
    this.measure(SAMPLES, () => this.most(Math.ceil(this.vertices / LOOKED_AT)));
  }

  get vertices() {
    return this.pairs.reduce((sum, { mesh }) => sum + countOf(mesh), 0);
  }

  release() {
    for (const [mesh, { material, castShadow, colour }] of this.own) {
      Object.assign(mesh, { material, castShadow });
      if (colour) mesh.geometry.setAttribute('color', colour);
      else mesh.geometry.deleteAttribute('color');
    }
  }

  // Calls take(mesh, vertex, metres) for each `step`th vertex.
  each(step, take) {
    const here = new Vector3();
    const there = new Vector3();
    for (const { mesh, partner } of this.pairs) {
      for (let i = 0; i < countOf(mesh); i += step) {
        mesh.getVertexPosition(i, here).applyMatrix4(mesh.matrixWorld).sub(this.one.group.position);
        partner.getVertexPosition(i, there).applyMatrix4(partner.matrixWorld).sub(this.other.group.position);
        take(mesh, i, here.distanceTo(there));
      }
    }
  }

  most(step) {
    let most = 0;
    this.each(step, (mesh, vertex, metres) => { most = Math.max(most, metres); });
    return most;
  }

  distances() {
    const all = [];
    this.each(1, (mesh, vertex, metres) => all.push(metres));
    return all;
  }

  // After both were updated to the same time.
  update() {
    const colour = new Color();
    this.largest = { distance: 0, name: '' };
    this.each(1, (mesh, vertex, distance) => {
      if (distance > this.largest.distance) this.largest = { distance, name: `vertex ${vertex} of ${mesh.userData.name ?? mesh.name}` };
      ramp(distance / this.scale, colour).toArray(mesh.geometry.attributes.color.array, 3 * vertex);
    });
    for (const { mesh } of this.pairs) mesh.geometry.attributes.color.needsUpdate = true;
  }
}
