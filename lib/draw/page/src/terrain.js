// A ground that is not level: its surface, with a grid of metres on it.

import { BufferAttribute, BufferGeometry, DoubleSide, Mesh, MeshStandardMaterial } from 'three';
import { GRID } from './ground.js';
import { view } from './motion.js';

// Lines on the surface, in the colour of the ink. Walls have none: they are seen from above as a
// line, over which the grid would be smeared.
const COLOUR = `
#include <color_fragment>
  vec4 lines = grid();
  diffuseColor.rgb = mix( diffuseColor.rgb, ink, lines.a * smoothstep( 0.1, 0.3, abs( vUpward ) ) );
`;

export class Terrain extends Mesh {
  // `ink`: the colour of the lines, which the level ground has, too.
  constructor({ positions, normals, triangles }, bytes, ink) {
    const geometry = new BufferGeometry();
    geometry.setAttribute('position', new BufferAttribute(view(bytes, Float32Array, positions), 3));
    geometry.setAttribute('normal', new BufferAttribute(view(bytes, Float32Array, normals), 3));
    geometry.setIndex(new BufferAttribute(view(bytes, Uint32Array, triangles), 1));
    const material = new MeshStandardMaterial({ roughness: 0.95, metalness: 0, side: DoubleSide });
    material.onBeforeCompile = (shader) => {
      shader.uniforms.ink = { value: ink };
      shader.vertexShader = `varying vec2 vGround;\nvarying float vUpward;\n${shader.vertexShader}`.replace(
        '#include <begin_vertex>',
        '#include <begin_vertex>\nvGround = position.xz;\nvUpward = normal.y;');
      shader.fragmentShader = `varying float vUpward;\n${GRID}${shader.fragmentShader}`
        .replace('#include <color_fragment>', COLOUR);
    };
    super(geometry, material);
    this.castShadow = true;
    this.receiveShadow = true;
  }
}
