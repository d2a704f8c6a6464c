// Prints how three.js shows a glTF file's meshes, as a line of JSON: for each its part's material
// with factors and the files of its textures in hexadecimal, how coordinates are used, colours; and the nodes that have neither mesh
// nor bone, with their places in the world at the file's first moment.
//
// Usage: node three_look.mjs FILE

import {ThreeScene} from './three_scene.mjs';
import {Vector3} from 'three';

const MAPS = ['map', 'metalnessMap', 'roughnessMap', 'normalMap', 'aoMap', 'emissiveMap'];

function lookOf(mesh) {
  const material = mesh.material;
  const look = {
    material: material.name,
    type: material.type,
    color: material.color.toArray(),
    opacity: material.opacity,
    transparent: material.transparent,
    alphaTest: material.alphaTest,
    doubleSided: material.side === 2,
    metalness: material.metalness,
    roughness: material.roughness,
    emissive: material.emissive?.toArray(),
    maps: {},
    placed: {}, // set of coordinates, scale, rotation, offset
    corners: {}, // of the first vertex
  };
  for (const name of MAPS) {
    const texture = material[name];
    if (texture) {
      look.maps[name] = Buffer.from(texture.image.file).toString('hex');
      const { channel, rotation } = texture;
      look.placed[name] = [channel, ...texture.repeat, rotation, ...texture.offset];
    }
  }
  for (const name of ['uv', 'uv1', 'uv2', ...(material.vertexColors ? ['color'] : [])]) {
    const attribute = mesh.geometry.attributes[name];
    if (attribute) {
      look.corners[name] = Array.from({ length: attribute.itemSize }, (_, k) => attribute.getComponent(0, k));
    }
  }
  return look;
}

try {
  const scene = await ThreeScene.open(process.argv[2]);
  scene.seek(0);
  const places = {};
  scene.root.traverse((object) => {
    if (object.type !== 'Object3D') return;
    places[object.name] = new Vector3().setFromMatrixPosition(object.matrixWorld).toArray();
  });
  console.log(JSON.stringify({meshes: scene.meshes.map(lookOf), places}));
} catch (error) {
  console.error(`three_look: ${error.message ?? error}`);
  process.exit(2);
}
