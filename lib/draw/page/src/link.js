// A link to what is seen: time, camera, range, files and joint, after the page's address.

import { Vector3 } from 'three';

const numbers = (values) => values.map((value) => Number(value.toFixed(4))).join(',');

export function linkTo(player, stage) {
  const { camera, controls } = stage;
  const parts = [
    `t=${numbers([player.time])}`,
    `camera=${numbers([...camera.position.toArray(), ...controls.target.toArray()])}`,
    `files=${player.items.filter(({ visible }) => visible).map(({ index }) => index).join(',')}`,
  ];
  if (player.range) parts.push(`range=${numbers(player.range)}`);
  if (player.selected) parts.push(`joint=${player.selected.made.index},${player.selected.joint}`);
  return `${location.href.split('#')[0]}#${parts.join('&')}`;
}

// What such a link has; null for another.
export function linked(hash = location.hash) {
  const given = new URLSearchParams(hash.slice(1));
  if (!given.has('t')) return null;
  const list = (name, count) => {
    const values = (given.get(name) ?? '').split(',').map(Number);
    const valid = given.has(name) && values.every(Number.isFinite) && (count === undefined || values.length === count);
    return valid ? values : null;
  };
  return { time: list('t', 1)?.[0] ?? 0, camera: list('camera', 6), files: list('files'), range: list('range', 2), joint: list('joint', 2) };
}

export function placeCamera(stage, camera) {
  stage.controls.target.copy(new Vector3(...camera.slice(3)));
  stage.camera.position.copy(new Vector3(...camera.slice(0, 3)));
  stage.reachTo(stage.distance);
  stage.controls.update();
  stage.redraw();
}
