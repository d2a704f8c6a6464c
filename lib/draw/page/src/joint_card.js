// The selected joint: where it is, how it is turned, how fast it is; its trail and curves.

import { Euler, Mesh, MeshBasicMaterial, SphereGeometry, Vector3 } from 'three';
import { iconButton } from './icons.js';

const DEGREES = 180 / Math.PI;
const CURVES = [
  ['angle', 'Angle', '°', '#8a5cd6'],
  ['height', 'Height', 'm', '#2f8f5b'],
  ['speed', 'Speed', 'm/s', '#c2453d'],
];
const find = (id) => document.getElementById(id);
const metres = (value) => `${value.toFixed(3)} m`;
const degrees = (value) => `${(value * DEGREES).toFixed(1)}°`;

export class JointCard {
  // `changed()`: after another joint is selected or its trail changes.
  constructor(player, stage, { changed, frame }) {
    this.player = player;
    this.stage = stage;
    this.changed = changed;
    this.marker = new Mesh(
      new SphereGeometry(1, 16, 12),
      new MeshBasicMaterial({ color: '#ffb000', depthTest: false, transparent: true, opacity: 0.85 }),
    );
    this.marker.renderOrder = 3;
    this.marker.visible = false;
    stage.scene.add(this.marker);
    this.select = find('joint');
    this.select.addEventListener('change', () => {
      const [item, joint] = this.select.value.split(':').map(Number);
      this.choose(this.select.value === '' ? null : { made: player.items[item], joint });
    });
    this.trail = iconButton('trail', 'Trail', 't', () => this.toggleTrail());
    this.copy = iconButton('copy', 'Copy the values', null, () => this.copyText());
    find('joint-tools').append(
      this.trail,
      iconButton('frameSelected', 'Frame the joint', 'v', frame),
      this.copy,
      iconButton('clear', 'Deselect', 'Esc', () => this.choose(null)),
    );
  }

  // `picked`: {made, joint} or null.
  choose(picked) {
    this.player.selected = picked;
    find('joint-card').hidden = !picked;
    this.marker.visible = Boolean(picked);
    this.select.value = picked ? `${picked.made.index}:${picked.joint}` : '';
    this.changed();
    this.refresh();
    if (picked) find('joint-card').scrollIntoView({ block: 'nearest' });
    this.stage.redraw();
  }

  // The joints of all that is shown.
  fill() {
    const { player } = this;
    this.select.replaceChildren(new Option('Click a joint, or choose', ''));
    const actors = player.actors().filter(({ actor }) => actor.names.length > 0);
    for (const { actor, name, index } of actors) {
      const group = document.createElement('optgroup');
      group.label = name;
      actor.names.forEach((joint, place) => group.append(new Option(joint, `${index}:${place}`)));
      this.select.append(group);
    }
    find('joint-section').hidden = actors.length === 0;
    const { selected } = player;
    if (selected && !actors.includes(selected.made)) this.choose(null);
    else if (selected) this.select.value = `${selected.made.index}:${selected.joint}`;
    this.listTrails();
  }

  toggleTrail(picked = this.player.selected) {
    if (!picked) return;
    picked.made.actor.toggleTrail(picked.joint);
    this.listTrails();
    this.stage.redraw();
  }

  listTrails() {
    const rows = [];
    for (const made of this.player.actors()) {
      for (const [joint, { colour }] of made.actor.trails) {
        const row = document.createElement('li');
        const name = made.actor.names[joint];
        const swatch = document.createElement('span');
        swatch.className = 'swatch';
        swatch.style.background = colour;
        const label = document.createElement('span');
        label.textContent = `Trail of ${name}`;
        row.append(swatch, label, iconButton('clear', `Remove the trail of ${name}`, null,
          () => this.toggleTrail({ made, joint })));
        rows.push(row);
      }
    }
    find('trails').replaceChildren(...rows);
    const { selected } = this.player;
    this.trail.setAttribute('aria-pressed', String(Boolean(selected?.made.actor.trails.has(selected.joint))));
  }

  curves() {
    const { selected } = this.player;
    if (!selected) return [];
    const series = selected.made.actor.seriesOf(selected.joint);
    return CURVES.map(([key, name, unit, colour]) => ({ name, unit, colour, values: series[key], rate: series.rate }));
  }

  // What is known of the joint at this time.
  values() {
    const { selected, time } = this.player;
    if (!selected) return null;
    const { made: { actor, name }, joint } = selected;
    const series = actor.seriesOf(joint);
    const frame = Math.min(Math.round(time * series.rate), series.speed.length - 1);
    const { x, y, z } = new Euler().setFromQuaternion(actor.jointTurn(joint), 'XYZ');
    return {
      joint: actor.names[joint],
      file: name,
      time,
      position: actor.jointPosition(joint).toArray(),
      angles: [x, y, z],
      turn: series.angle[frame],
      speed: series.speed[frame],
    };
  }

  refresh() {
    const values = this.values();
    if (!values) return;
    const { selected } = this.player;
    const { actor } = selected.made;
    this.marker.position.copy(actor.jointPosition(selected.joint)).add(actor.group.position);
    this.marker.scale.setScalar(actor.size * 0.012);
    find('joint-name').textContent = values.joint;
    find('joint-file').textContent = values.file;
    const put = (id, text) => { find(id).textContent = text; };
    'xyz'.split('').forEach((axis, i) => {
      put(`joint-${axis}`, metres(values.position[i]));
      put(`joint-r${axis}`, degrees(values.angles[i]));
    });
    put('joint-turn', `${values.turn.toFixed(1)}°`);
    put('joint-speed', `${values.speed.toFixed(2)} m/s`);
  }

  // A line of names and a line of values, as tables take them.
  async copyText() {
    const { joint, file, time, position, angles, turn, speed } = this.values();
    const columns = [
      ['file', file], ['joint', joint], ['time (s)', time.toFixed(4)],
      ...'xyz'.split('').map((axis, i) => [`${axis} (m)`, position[i].toFixed(5)]),
      ...'xyz'.split('').map((axis, i) => [`r${axis} (deg)`, (angles[i] * DEGREES).toFixed(3)]),
      ['turn (deg)', turn.toFixed(3)], ['speed (m/s)', speed.toFixed(4)],
    ];
    const text = [0, 1].map((i) => columns.map((column) => column[i]).join('\t')).join('\n');
    await copy(text);
    this.said?.('Values copied');
  }
}

// To the clipboard; pages opened from disk may have no other way than the old one.
export async function copy(text) {
  try {
    await navigator.clipboard.writeText(text);
  } catch {
    const area = document.createElement('textarea');
    area.value = text;
    document.body.append(area);
    area.select();
    document.execCommand('copy');
    area.remove();
  }
}

// The joint nearest to a point of the canvas, within `reach` pixels: {made, joint, name, x, y} or null.
export function nearestJoint(player, stage, x, y, reach = 14) {
  let best = null;
  let nearest = reach;
  const place = new Vector3();
  for (const made of player.actors()) {
    const { actor } = made;
    actor.names.forEach((name, joint) => {
      place.copy(actor.jointPosition(joint)).add(actor.group.position);
      const seen = stage.project(place);
      if (!seen) return;
      const distance = Math.hypot(seen.x - x, seen.y - y);
      if (distance < nearest) {
        nearest = distance;
        best = { made, joint, name, ...seen };
      }
    });
  }
  return best;
}
