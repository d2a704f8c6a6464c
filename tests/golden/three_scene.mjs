// Opens a glTF file with three.js's own loader, without a browser, and plays its animation.

import {readFileSync} from 'node:fs';
import {dirname} from 'node:path';

// What the loader expects of a browser and Node lacks.
globalThis.self ??= globalThis;
globalThis.ProgressEvent ??= class ProgressEvent extends Event {};
// A picture is not decoded: `file` is what it is decoded from.
globalThis.createImageBitmap ??= async (blob) => (
    {file: new Uint8Array(await blob.arrayBuffer()), width: 1, height: 1, close() {}});

const THREE = await import('three');
const {GLTFLoader} = await import('three/addons/loaders/GLTFLoader.js');
const {MeshoptDecoder} = await import('three/addons/libs/meshopt_decoder.module.js');

export class ThreeScene {
  static async open(path) {
    const bytes = readFileSync(path);
    const data = bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.byteLength);
    const loader = new GLTFLoader().setMeshoptDecoder(MeshoptDecoder);
    const gltf = await loader.parseAsync(data, dirname(path) + '/');
    return new ThreeScene(gltf);
  }

  constructor(gltf) {
    this.root = gltf.scene;
    this.animations = gltf.animations;
    this.meshes = [];
    this.joints = new Map();
    const names = new Map();
    for (const [object, reference] of gltf.parser.associations) {
      if (reference?.nodes !== undefined) {
        names.set(object, gltf.parser.json.nodes[reference.nodes].name);
      }
    }
    this.root.traverse((object) => {
      if (object.isMesh) this.meshes.push(object);
      // The loader changes names that hold its own separators; the file's are what counts here.
      if (object.isBone) this.joints.set(names.get(object) ?? object.name, object);
    });
    this.times = [0];
    if (gltf.animations.length > 0) {
      this.mixer = new THREE.AnimationMixer(this.root);
      this.action = this.mixer.clipAction(gltf.animations[0]);
      this.action.setLoop(THREE.LoopOnce);
      this.action.clampWhenFinished = true;
      for (const track of gltf.animations[0].tracks) {
        if (track.times.length > this.times.length) this.times = Array.from(track.times);
      }
    }
  }

  seek(time) {
    if (this.mixer) {
      this.action.reset().play();
      this.mixer.setTime(time);
    }
    this.root.updateMatrixWorld(true);
  }

  // World positions of all vertices of all meshes, morphed and skinned by three.js: x, y, z, ...
  vertices() {
    const result = [];
    const point = new THREE.Vector3();
    for (const mesh of this.meshes) {
      const count = mesh.geometry.attributes.position.count;
      for (let v = 0; v < count; v++) {
        mesh.getVertexPosition(v, point).applyMatrix4(mesh.matrixWorld);
        result.push(point.x, point.y, point.z);
      }
    }
    return result;
  }

  // World position of a joint by the name in the file, or nothing.
  joint(name) {
    const bone = this.joints.get(name);
    if (!bone) return undefined;
    const point = new THREE.Vector3().setFromMatrixPosition(bone.matrixWorld);
    return [point.x, point.y, point.z];
  }
}
