// Draws a skinned body: in its colour or materials, with the joints in contact marked; coloured by its
// distance from another pose of the same skeleton; or as a ghost.

import {
  Bone,
  Box3,
  BufferAttribute,
  BufferGeometry,
  Color,
  Matrix4,
  MeshStandardMaterial,
  Quaternion,
  Skeleton,
  SkinnedMesh,
  Vector3,
} from 'three';
import { makeMaterials } from './look.js';
import { view } from './motion.js';
import { RAMP } from './ramp.js';
import { reachBeyond } from './reach.js';

const NARROW = 65536; // vertices up to which corners take 16 bits, as in pack_motion.cpp
const MARKED = 8; // joints in contact at once that are marked

// What a body's vertices have of the joints in contact, and their distance from the other pose.
const VERTEX = `
uniform float krokTouching[${MARKED}];
varying float vKrokTouch;
#ifdef KROK_OTHER
uniform highp sampler2D krokOther;
varying float vKrokApart;
mat4 krokOtherBone( const in float i ) {
  int size = textureSize( krokOther, 0 ).x;
  int j = int( i ) * 4;
  int x = j % size;
  int y = j / size;
  return mat4( texelFetch( krokOther, ivec2( x, y ), 0 ), texelFetch( krokOther, ivec2( x + 1, y ), 0 ),
    texelFetch( krokOther, ivec2( x + 2, y ), 0 ), texelFetch( krokOther, ivec2( x + 3, y ), 0 ) );
}
#endif
`;
const TOUCH = `
#include <skinning_vertex>
vKrokTouch = 0.0;
for ( int i = 0; i < ${MARKED}; ++ i ) {
  vKrokTouch += dot( skinWeight, vec4( equal( skinIndex, vec4( krokTouching[ i ] ) ) ) );
}
#ifdef KROK_OTHER
vec4 krokThere = krokOtherBone( skinIndex.x ) * skinVertex * skinWeight.x
  + krokOtherBone( skinIndex.y ) * skinVertex * skinWeight.y
  + krokOtherBone( skinIndex.z ) * skinVertex * skinWeight.z
  + krokOtherBone( skinIndex.w ) * skinVertex * skinWeight.w;
vKrokApart = distance( krokThere.xyz, skinned.xyz );
#endif
`;
const COLOUR = `
#include <color_fragment>
#ifdef KROK_OTHER
diffuseColor.rgb = krokRamp( vKrokApart / krokScale );
#endif
diffuseColor.rgb = mix( diffuseColor.rgb, krokContact, 0.85 * clamp( vKrokTouch, 0.0, 1.0 ) );
`;

export class BodyView {
  // `contact`: the colour of joints in contact; `marks`: whether there are any.
  constructor(body, bytes, joints, colour, contact, marks) {
    this.marks = marks;
    this.uniforms = {
      krokTouching: { value: new Float32Array(MARKED).fill(-1) },
      krokContact: { value: contact },
      krokOther: { value: null },
      krokScale: { value: 1 },
    };
    const geometry = new BufferGeometry();
    geometry.setAttribute('position', new BufferAttribute(view(bytes, Float32Array, body.positions), 3));
    geometry.setAttribute('normal', new BufferAttribute(view(bytes, Int8Array, body.normals), 4, true));
    geometry.setAttribute('skinIndex', new BufferAttribute(view(bytes, Uint16Array, body.joints), 4));
    geometry.setAttribute('skinWeight', new BufferAttribute(view(bytes, Uint8Array, body.weights), 4, true));
    const Corners = body.positions.count <= 3 * NARROW ? Uint16Array : Uint32Array;
    geometry.setIndex(new BufferAttribute(view(bytes, Corners, body.triangles), 1));
    this.reference = view(bytes, Float32Array, body.reference);
    this.inverses = [];
    const box = new Box3();
    this.bones = Array.from({ length: joints }, (_, joint) => {
      const bind = this.bindOf(joint);
      box.expandByPoint(new Vector3().setFromMatrixPosition(bind));
      this.inverses.push(bind.invert());
      return makeBone();
    });
    geometry.computeBoundingBox();
    this.reach = reachBeyond(box, geometry.boundingBox);
    this.own = new MeshStandardMaterial({
      color: colour.clone().lerp(new Color('#ffffff'), 0.55),
      roughness: 0.75,
    });
    this.patch(this.own);
    this.mesh = new SkinnedMesh(geometry, this.own);
    // Bones are in the character's own space, which the group then offsets.
    this.mesh.bind(new Skeleton(this.bones, this.inverses), new Matrix4());
    this.mesh.bindMode = 'detached';
    this.mesh.frustumCulled = false;
    this.mesh.castShadow = true;
    this.mode = 'own';
  }

  bindOf(joint) {
    const at = joint * 7;
    return new Matrix4().compose(
      new Vector3().fromArray(this.reference, at),
      new Quaternion().fromArray(this.reference, at + 3),
      new Vector3(1, 1, 1),
    );
  }

  // Replaces the plain colour by the body's materials, if it has any.
  async dress(look, bytes) {
    if (!look) return;
    const { geometry } = this.mesh;
    const add = (name, blob, size) => {
      geometry.setAttribute(name, new BufferAttribute(view(bytes, Float32Array, blob), size));
    };
    look.coordinates?.forEach((set, i) => add(i ? `uv${i}` : 'uv', set, 2));
    if (look.colours) add('color', look.colours, 4);
    for (const { first, count, material } of look.parts) geometry.addGroup(first, count, material);
    this.own = this.mesh.material = await makeMaterials(look, bytes);
    this.own.forEach((material) => this.patch(material));
  }

  patch(material, other = false) {
    if (!other && !this.marks) return;
    if (other) material.defines = { ...material.defines, KROK_OTHER: '' };
    material.onBeforeCompile = (shader) => {
      Object.assign(shader.uniforms, this.uniforms);
      shader.vertexShader = VERTEX + shader.vertexShader.replace('#include <skinning_vertex>', TOUCH);
      shader.fragmentShader = `varying float vKrokTouch;\nuniform vec3 krokContact;\n`
        + (other ? `varying float vKrokApart;\nuniform float krokScale;\n${RAMP}` : '')
        + shader.fragmentShader.replace('#include <color_fragment>', COLOUR);
    };
    material.customProgramCacheKey = () => `krok body ${other}`;
  }

  // 'own', 'difference' or 'ghost'.
  setMode(mode) {
    if (mode === this.mode) return;
    this.mode = mode;
    if (mode === 'difference' && !this.difference) {
      this.difference = new MeshStandardMaterial({ roughness: 0.85 });
      this.patch(this.difference, true);
      this.otherBones = this.bones.map(makeBone);
      this.other = new Skeleton(this.otherBones, this.inverses);
      this.other.computeBoneTexture();
      this.uniforms.krokOther.value = this.other.boneTexture;
    }
    this.ghost ??= ghostMaterial();
    const shown = { own: this.own, difference: this.difference, ghost: this.ghost }[mode];
    // A body of several parts has as many materials.
    this.mesh.material = Array.isArray(this.own) && !Array.isArray(shown) ? this.own.map(() => shown) : shown;
    this.mesh.castShadow = mode !== 'ghost';
  }

  setWireframe(wireframe) {
    for (const material of [this.own, this.difference ?? []].flat()) material.wireframe = wireframe;
  }

  // Makes the body translucent while the skeleton is visible, otherwise restores its material.
  letThrough(through) {
    for (const material of [this.own, this.difference ?? []].flat()) {
      const own = material.userData.own ??= {
        transparent: material.transparent,
        opacity: material.opacity,
        depthWrite: material.depthWrite,
      };
      // Transparency is compiled into a material's shader.
      if (material.transparent !== (through || own.transparent)) material.needsUpdate = true;
      material.transparent = through || own.transparent;
      material.opacity = through ? 0.45 * own.opacity : own.opacity;
      material.depthWrite = !through && own.depthWrite;
    }
  }

  // `motion` after its pose().
  place(motion) {
    this.bones.forEach((bone, joint) => motion.matrix(joint, bone.matrixWorld));
  }

  touch(joints) {
    this.uniforms.krokTouching.value.fill(-1);
    joints.slice(0, MARKED).forEach((joint, i) => { this.uniforms.krokTouching.value[i] = joint; });
  }

  // Colours by the distance to where `matrixOf(joint, into)` would carry the vertices; `scale` metres
  // are the end of the ramp.
  compare(matrixOf, scale) {
    this.otherBones.forEach((bone, joint) => matrixOf(joint, bone.matrixWorld));
    this.other.update();
    this.uniforms.krokScale.value = scale;
  }
}

// Farther than a body at the same place, which then hides it.
export const ghostMaterial = () => new MeshStandardMaterial({
  color: '#8a94a0', roughness: 0.9, transparent: true, opacity: 0.3, depthWrite: false,
  polygonOffset: true, polygonOffsetFactor: 2, polygonOffsetUnits: 4,
});

function makeBone() {
  const bone = new Bone();
  bone.matrixAutoUpdate = false;
  bone.matrixWorldAutoUpdate = false;
  return bone;
}
