// Colours of a difference: pale for none, then yellow and orange to dark red, ever darker, so that
// they stay in order in greyscale and for the colour-blind.

import { Color } from 'three';

const STOPS = ['#dfe6ec', '#f6d13a', '#e8742a', '#8f1237'].map((text) => new Color(text));

// `share` from 0 to 1.
export function ramp(share, into = new Color()) {
  const at = Math.min(Math.max(share, 0), 1) * (STOPS.length - 1);
  const low = Math.min(Math.floor(at), STOPS.length - 2);
  return into.lerpColors(STOPS[low], STOPS[low + 1], at - low);
}

const number = (value) => value.toFixed(5);
const vector = ({ r, g, b }) => `vec3( ${number(r)}, ${number(g)}, ${number(b)} )`;

// The same in a shader: vec3 krokRamp( float share ).
export const RAMP = `
vec3 krokRamp( float share ) {
  float at = clamp( share, 0.0, 1.0 ) * ${STOPS.length - 1}.0;
  vec3 colour = ${vector(STOPS[0])};
  ${STOPS.slice(1).map((stop, i) => `colour = mix( colour, ${vector(stop)}, clamp( at - ${i}.0, 0.0, 1.0 ) );`).join('\n  ')}
  return colour;
}
`;

// The same as a background of a page.
export function gradient() {
  const colours = Array.from({ length: 13 }, (_, i) => ramp(i / 12).getStyle());
  return `linear-gradient(90deg, ${colours.join(', ')})`;
}
