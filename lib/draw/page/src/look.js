// The appearance of a body: materials and textures with glTF semantics.

import {
  ClampToEdgeWrapping,
  Color,
  DoubleSide,
  LinearSRGBColorSpace,
  MeshBasicMaterial,
  MeshStandardMaterial,
  MirroredRepeatWrapping,
  NearestFilter,
  RepeatWrapping,
  SRGBColorSpace,
  Texture,
} from 'three';

const WRAPS = { repeat: RepeatWrapping, clamp: ClampToEdgeWrapping, mirror: MirroredRepeatWrapping };

// Decodes an image file; null if it is damaged, and the texture is then skipped.
async function decode(bytes, { offset, count, type }) {
  const file = new Blob([bytes.subarray(offset, offset + count)], { type });
  try {
    return await createImageBitmap(file, { premultiplyAlpha: 'none', colorSpaceConversion: 'none' });
  } catch {
    return null;
  }
}

function makeTexture(image, described, colour) {
  const texture = new Texture(image);
  texture.flipY = false; // v points down, like image rows
  texture.wrapS = WRAPS[described.wrapU];
  texture.wrapT = WRAPS[described.wrapV];
  if (!described.smooth) texture.magFilter = NearestFilter;
  if (colour) texture.colorSpace = SRGBColorSpace;
  texture.channel = described.set ?? 0;
  if (described.transform) {
    const [[u, v], [uOfU, vOfU], [uOfV, vOfV]] = described.transform;
    texture.matrixAutoUpdate = false;
    texture.matrix.set(uOfU - u, uOfV - u, u, vOfU - v, vOfV - v, v, 0, 0, 1);
  }
  texture.needsUpdate = true;
  return texture;
}

function makeMaterial(described, textureOf, coloured) {
  const [red, green, blue, alpha] = described.color;
  const material = described.unlit ? new MeshBasicMaterial() : new MeshStandardMaterial();
  material.color.setRGB(red, green, blue, LinearSRGBColorSpace);
  material.map = textureOf('baseColor', true);
  material.vertexColors = coloured;
  if (described.doubleSided) material.side = DoubleSide;
  if (described.alpha === 'blend') {
    material.transparent = true;
    material.depthWrite = false;
    material.opacity = alpha;
  } else if (described.alpha === 'mask') {
    material.opacity = alpha;
    material.alphaTest = described.cutoff;
  }
  if (described.unlit) return material;
  material.metalness = described.metallic;
  material.roughness = described.roughness;
  material.metalnessMap = textureOf('metallicRoughness');
  material.roughnessMap = material.metalnessMap;
  material.normalMap = textureOf('normal');
  // three.js derives the tangent frame from screen-space derivatives of the texture, where v is
  // flipped.
  material.normalScale.set(described.normalScale, -described.normalScale);
  material.aoMap = textureOf('occlusion');
  material.aoMapIntensity = described.occlusion;
  material.emissive = new Color().setRGB(...described.emissive, LinearSRGBColorSpace);
  material.emissiveMap = textureOf('emissive', true);
  return material;
}

// The materials of a body, in the order of its parts' indices.
export async function makeMaterials(look, bytes) {
  const images = await Promise.all(look.pictures.map((picture) => decode(bytes, picture)));
  return look.materials.map((described) => makeMaterial(described, (name, colour = false) => {
    const texture = described.textures[name];
    const image = texture ? images[texture.picture] : null;
    return image ? makeTexture(image, texture, colour) : null;
  }, Boolean(look.colours)));
}
