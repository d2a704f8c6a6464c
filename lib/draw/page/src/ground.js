// The ground: a metre grid, every fifth line thicker, and the shadows on it.

import { Color, Mesh, PlaneGeometry, ShadowMaterial } from 'three';

const SIZE = 400; // metres
const HALF_WIDTHS = [1 / 128, 2.5 / 128]; // of a line and a fifth line, metres
const STRENGTHS = [0.28, 0.55];
const SHADOW = 0.28;
const SHARPEST = 1 / 128; // metres; min width of a blurred edge

// Analytic anti-aliasing: the fraction of a pixel's footprint that the lines cover. A texture would
// need many samples to stay sharp at a distance. Filtered per axis, so that a footprint stretched
// in one direction does not blur the other. A footprint is treated as a box.
export const GRID = `
uniform vec3 ink;
varying vec2 vGround;

vec2 linesUpTo( vec2 at, float apart, float halfWidth ) {
  vec2 line = floor( at / apart + 0.5 );
  return line * 2.0 * halfWidth + clamp( at - line * apart, -halfWidth, halfWidth );
}

vec2 linesIn( vec2 low, vec2 high, float apart, float halfWidth ) {
  return linesUpTo( high, apart, halfWidth ) - linesUpTo( low, apart, halfWidth );
}

vec4 grid() {
  vec2 across = dFdx( vGround );
  vec2 along = dFdy( vGround );
  vec2 box = max( sqrt( across * across + along * along ), vec2( ${SHARPEST} ) );
  vec2 low = vGround - 0.5 * box;
  vec2 high = low + box;
  vec2 fine = ( linesIn( low, high, 1.0, ${HALF_WIDTHS[0]} )
    - linesIn( low, high, 5.0, ${HALF_WIDTHS[0]} ) ) / box;
  vec2 fifth = linesIn( low, high, 5.0, ${HALF_WIDTHS[1]} ) / box;
  vec2 bare = 1.0 - fine - fifth;
  vec2 clear = 1.0 - ${STRENGTHS[0]} * fine - ${STRENGTHS[1]} * fifth;
  return vec4( ink * ( 1.0 - bare.x * bare.y ), 1.0 - clear.x * clear.y );
}
`;

// The grid with the shadow, which is black, on top. Most of the ground has neither.
const COMPOSE = `
  vec4 lines = grid();
  float lit = 1.0 - opacity * ( 1.0 - getShadowMask() );
  float cover = 1.0 - lit * ( 1.0 - lines.a );
  gl_FragColor = vec4( color, cover );
  if ( lines.a > 1e-4 ) { // less is invisible, and dividing by it is unsafe
    gl_FragColor.rgb = linearToOutputTexel( vec4( lines.rgb, 1.0 ) ).rgb * lit * lines.a / cover;
  }
`;

export class Ground extends Mesh {
  constructor() {
    const ink = new Color();
    const material = new ShadowMaterial({ opacity: SHADOW, depthWrite: false });
    material.onBeforeCompile = (shader) => {
      shader.uniforms.ink = { value: ink };
      shader.vertexShader = `varying vec2 vGround;\n${shader.vertexShader}`.replace(
        '#include <begin_vertex>', '#include <begin_vertex>\nvGround = position.xz;');
      shader.fragmentShader = GRID + shader.fragmentShader
        .replace(/gl_FragColor = .*;/, COMPOSE)
        .replace('#include <colorspace_fragment>', '');
    };
    super(new PlaneGeometry(SIZE, SIZE).rotateX(-Math.PI / 2), material);
    this.ink = ink;
    this.receiveShadow = true;
    this.renderOrder = -1;
  }
}
