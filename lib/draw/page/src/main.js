// Entry point: reads the data, creates characters and cameras, runs the clock, handles the
// controls.

import { Box3, CameraHelper, PerspectiveCamera, Raycaster, Vector3 } from 'three';
import { COLOURS, CONTACT_COLOUR, Actor } from './actor.js';
import { missText } from './goals.js';
import { GltfActor } from './gltf_actor.js';
import { Lanes } from './lanes.js';
import { CameraTrack, Motion, blobBytes } from './motion.js';
import { Prints } from './prints.js';
import { Stage } from './stage.js';

const SPEEDS = [0.1, 0.25, 0.5, 1, 1.5, 2, 4];
const PLAY_ICON = 'M4 2.5 13 8l-9 5.5z';
const PAUSE_ICON = 'M3.5 2.5h3.2v11H3.5zM9.3 2.5h3.2v11H9.3z';
const find = (id) => document.getElementById(id);

// The contents of the scene: characters with one interface for all file formats.
class Player {
  constructor(stage, items, prints) {
    this.stage = stage;
    this.items = items;
    this.prints = prints;
    this.time = 0;
    this.speed = 1;
    this.playing = false;
    this.loop = true;
    this.shown = { skeleton: true, body: true, apart: false, difference: false, follow: false, goals: true, prints: true };
    this.lastRoot = null;
  }

  actors() {
    return this.items.filter(({ actor, visible }) => actor && visible);
  }

  get duration() {
    return Math.max(0, ...this.items.filter(({ visible }) => visible).map(({ duration }) => duration));
  }

  get rate() {
    return Math.max(1, ...this.items.filter(({ visible }) => visible).map(({ rate }) => rate));
  }

  setTime(time) {
    this.time = Math.min(Math.max(time, 0), this.duration);
    this.update();
  }

  step(frames) {
    this.playing = false;
    this.setTime((Math.round(this.time * this.rate) + frames) / this.rate);
  }

  advance(seconds) {
    let time = this.time + seconds * this.speed;
    if (time > this.duration) {
      if (this.loop && this.duration > 0) {
        time %= this.duration;
      } else {
        time = this.duration;
        this.playing = false;
      }
    }
    this.setTime(time);
  }

  // Places characters side by side along X, by their start positions, or at their own positions.
  arrange() {
    const actors = this.actors();
    const slot = Math.max(0.8, ...actors.map(({ spread }) => spread)) * 1.25;
    actors.forEach(({ actor, start }, i) => {
      const shift = actor.group.position.set(0, 0, 0);
      if (this.shown.apart) shift.set((i - (actors.length - 1) / 2) * slot - start.x, 0, -start.z);
    });
    for (const { actor, visible } of this.items) {
      if (actor) {
        actor.group.visible = visible;
        actor.show(this.shown);
      }
    }
    this.lastRoot = null;
    this.update();
  }

  update() {
    for (const { actor } of this.actors()) actor.update(this.time);
    for (const { camera, helper } of this.items) {
      if (!camera) continue;
      camera.pose(this.time);
      if (helper) {
        helper.camera.position.copy(camera.position);
        helper.camera.quaternion.copy(camera.orientation);
        helper.camera.updateMatrixWorld();
        helper.update();
      }
    }
    this.prints?.update(this.time, this.actors().map(({ item }) => item.printContacts ?? []));
    this.difference = this.shown.difference ? this.colourDifference() : null;
    this.followRoot();
    this.stage.redraw();
    this.changed?.();
  }

  // The mean ground position of the visible characters.
  root() {
    const middle = new Vector3();
    const actors = this.actors();
    for (const { actor } of actors) middle.add(actor.root()).add(actor.group.position);
    return middle.divideScalar(Math.max(actors.length, 1)).setY(0);
  }

  followRoot() {
    if (this.actors().length === 0) return;
    const root = this.root();
    if (this.shown.follow && this.lastRoot && !this.stage.flown) {
      this.stage.follow(root.clone().sub(this.lastRoot));
    }
    this.lastRoot = root;
  }

  // Colours joints of the same name in the first two characters by their distance.
  colourDifference() {
    const [a, b] = this.actors().map(({ actor }) => actor).filter(({ motion }) => motion);
    if (!a || !b) return null;
    const place = new Map(b.motion.names.map((name, joint) => [name, joint]));
    let largest = { distance: 0, name: '' };
    let shared = 0;
    const distances = a.motion.names.map((name, joint) => {
      const other = place.get(name);
      if (other === undefined) return null;
      ++shared;
      const distance = a.motion.positions[joint].distanceTo(b.motion.positions[other]);
      if (distance > largest.distance) largest = { distance, name };
      return distance;
    });
    if (shared === 0) return null;
    const scale = Math.max(this.differenceScale ?? 0, largest.distance, 1e-6);
    this.differenceScale = scale;
    a.paint((joint) => distances[joint] === null ? null : distances[joint] / scale);
    b.paint((joint) => {
      const at = a.motion.names.indexOf(b.motion.names[joint]);
      return at < 0 || distances[at] === null ? null : distances[at] / scale;
    });
    return { ...largest, scale };
  }
}

const lengthText = (metres) =>
  metres < 0.01 ? `${(metres * 1000).toPrecision(3)} mm`
    : metres < 1 ? `${(metres * 100).toPrecision(3)} cm` : `${metres.toPrecision(3)} m`;

async function makeItem(item, index, stage) {
  const bytes = item.blob ? blobBytes(item.blob) : null;
  const made = { name: item.name, visible: item.visible ?? true, item, duration: 0, rate: item.rate ?? 1 };
  if (item.kind === 'motion') {
    made.actor = new Actor(item, new Motion(item, bytes), bytes, index);
    await made.actor.dress(bytes);
  }
  if (item.kind === 'gltf') made.actor = await GltfActor.load(item, bytes);
  if (made.actor) {
    const { actor } = made;
    made.duration = actor.duration;
    made.rate = actor.rate;
    made.box = boxOverTime(actor);
    actor.update(0);
    made.spread = actor.boxNow().getSize(new Vector3()).x;
    made.start = actor.root().clone();
    made.colour = COLOURS[index % COLOURS.length];
    stage.scene.add(actor.group);
  } else if (item.kind === 'camera') {
    made.camera = new CameraTrack(item, bytes);
    made.duration = made.camera.duration;
    made.camera.pose(0);
    const shown = new PerspectiveCamera((made.camera.fieldOfView * 180) / Math.PI, 16 / 9, 0.02, 0.3);
    made.helper = new CameraHelper(shown);
    stage.scene.add(made.helper);
  }
  return made;
}

// Bounds of a character over at most sixty frames, in its group's space.
function boxOverTime(actor) {
  const box = new Box3();
  const count = actor.duration > 0 ? 60 : 1;
  for (let i = 0; i < count; ++i) {
    actor.update(count > 1 ? (i / (count - 1)) * actor.duration : 0);
    box.union(actor.boxNow());
  }
  return box;
}

class Interface {
  constructor(player, stage, data) {
    this.player = player;
    this.stage = stage;
    this.data = data;
    this.lanes = new Lanes(find('lanes'));
    find('title').textContent = data.title;
    document.title = `${data.title} – Krok`;
    this.makeTransport();
    this.makeItems();
    this.makeSwitches();
    this.makeTrails();
    this.makeCameras();
    this.makeKeys();
    this.watchPointer();
    player.changed = () => this.refresh();
    find('panel-toggle').addEventListener('click', () => this.togglePanel());
    if (globalThis.innerWidth < 700) this.togglePanel();
    globalThis.addEventListener('resize', () => this.lanes.draw());
  }

  togglePanel() {
    const closed = find('panel').classList.toggle('closed');
    find('panel-toggle').setAttribute('aria-expanded', String(!closed));
  }

  makeTransport() {
    const { player } = this;
    find('play').addEventListener('click', () => this.togglePlay());
    find('to-start').addEventListener('click', () => player.setTime(0));
    find('step-back').addEventListener('click', () => player.step(-1));
    find('step-forward').addEventListener('click', () => player.step(1));
    find('loop').addEventListener('change', (event) => { player.loop = event.target.checked; });
    const speed = find('speed');
    for (const value of SPEEDS) speed.add(new Option(`${value}×`, value, value === 1, value === 1));
    speed.addEventListener('change', () => { player.speed = Number(speed.value); });
    const slider = find('time');
    slider.addEventListener('input', () => {
      player.playing = false;
      player.setTime(Number(slider.value));
    });
  }

  togglePlay() {
    const { player } = this;
    if (!player.playing && player.time >= player.duration) player.setTime(0);
    player.playing = !player.playing && player.duration > 0;
    this.refresh();
  }

  changeSpeed(steps) {
    const at = SPEEDS.indexOf(this.player.speed);
    this.player.speed = SPEEDS[Math.min(Math.max(at + steps, 0), SPEEDS.length - 1)];
    find('speed').value = String(this.player.speed);
  }

  makeItems() {
    const list = find('items');
    this.player.items.forEach((made, index) => {
      const row = document.createElement('li');
      const box = document.createElement('input');
      box.type = 'checkbox';
      box.id = `item-${index}`;
      box.checked = made.visible;
      box.addEventListener('change', () => {
        made.visible = box.checked;
        if (made.helper) made.helper.visible = made.visible;
        this.rearrange();
      });
      const label = document.createElement('label');
      label.htmlFor = box.id;
      label.textContent = made.name;
      const facts = document.createElement('span');
      facts.className = 'facts';
      facts.textContent = made.item.facts ?? '';
      label.append(facts);
      const swatch = document.createElement('span');
      swatch.className = 'swatch';
      swatch.style.background = made.colour ?? 'transparent';
      row.append(box, swatch, label);
      list.append(row);
      made.box_element = box;
    });
  }

  // Shows only the next or previous file of a list.
  turnPage(step) {
    const { items } = this.player;
    const at = items.findIndex(({ visible }) => visible);
    const next = (at + step + items.length) % items.length;
    items.forEach((made, index) => {
      made.visible = index === next;
      made.box_element.checked = made.visible;
      if (made.helper) made.helper.visible = made.visible;
    });
    this.player.setTime(0);
    this.rearrange();
    this.frame();
  }

  rearrange() {
    this.player.arrange();
    this.fillTrails();
    this.setLanes();
    find('time').max = String(this.player.duration);
    find('time').step = String(1 / this.player.rate / 10);
    find('difference-section').hidden = !this.player.shown.difference;
    this.listGoals();
  }

  makeSwitches() {
    const { player, stage } = this;
    const actors = player.items.filter(({ actor }) => actor);
    const hasBody = actors.some(({ actor }) => actor.body || !actor.motion);
    player.shown.skeleton = !hasBody;
    player.shown.apart = Boolean(this.data.apart);
    player.shown.difference = Boolean(this.data.difference);
    const switches = [
      ['skeleton', 'Skeleton (s)', true],
      ['body', 'Body (b)', hasBody],
      // Not beside a ground, on which they would stand elsewhere than they do.
      ['apart', 'Side by side (a)', actors.length > 1 && !stage.terrain && !player.prints],
      ['difference', 'Colour the difference (d)', actors.length > 1],
      ['goals', 'Goals (o)', actors.some(({ actor }) => actor.goals)],
      ['prints', 'Footprints (p)', Boolean(player.prints)],
      ['follow', 'Follow (f)', actors.length > 0],
      ['grid', 'Ground (g)', true],
    ];
    player.shown.grid = true;
    this.switches = new Map();
    for (const [key, text, useful] of switches) {
      if (!useful) continue;
      const label = document.createElement('label');
      label.className = 'check';
      const box = document.createElement('input');
      box.type = 'checkbox';
      box.checked = player.shown[key];
      box.addEventListener('change', () => this.flip(key, box.checked));
      label.append(box, ` ${text}`);
      find('switches').append(label);
      this.switches.set(key, box);
    }
  }

  flip(key, value = !this.player.shown[key]) {
    if (!this.switches.has(key)) return;
    const { player, stage } = this;
    player.shown[key] = value;
    this.switches.get(key).checked = value;
    if (key === 'grid') stage.ground.visible = value;
    if (key === 'prints') player.prints.group.visible = value;
    if (key === 'difference' && !value) {
      for (const { actor } of player.items) actor?.motion && actor.plainColours();
    }
    this.rearrange();
    if (key === 'apart') this.frame();
  }

  makeTrails() {
    find('trail-joint').addEventListener('change', (event) => {
      if (event.target.value === '') return;
      const [item, joint] = event.target.value.split(':').map(Number);
      this.player.items[item].actor.toggleTrail(joint);
      event.target.value = '';
      this.listTrails();
      this.stage.redraw();
    });
  }

  fillTrails() {
    const select = find('trail-joint');
    select.replaceChildren(new Option('Select a joint', ''));
    let any = false;
    this.player.items.forEach(({ actor, name, visible }, item) => {
      if (!actor?.motion || !visible) return;
      any = true;
      const group = document.createElement('optgroup');
      group.label = name;
      actor.motion.names.forEach((joint, place) => group.append(new Option(joint, `${item}:${place}`)));
      select.append(group);
    });
    find('trail-section').hidden = !any;
    this.listTrails();
  }

  listTrails() {
    const rows = [];
    this.player.items.forEach(({ actor, colour }) => {
      actor?.trails.forEach((_, joint) => {
        const row = document.createElement('li');
        const remove = document.createElement('button');
        remove.type = 'button';
        remove.textContent = '×';
        const name = actor.motion.names[joint];
        remove.setAttribute('aria-label', `Remove the trail of ${name}`);
        remove.addEventListener('click', () => {
          actor.toggleTrail(joint);
          this.listTrails();
          this.stage.redraw();
        });
        const label = document.createElement('span');
        label.textContent = name;
        label.style.color = colour;
        row.append(remove, label);
        rows.push(row);
      });
    });
    find('trails').replaceChildren(...rows);
  }

  // Each visible motion's goals, with its colour and by how much it is missed now.
  listGoals() {
    const { player } = this;
    const actors = player.actors().filter(({ actor }) => actor.goals);
    find('goals-section').hidden = !player.shown.goals || actors.length === 0;
    this.goalRows = [];
    for (const { name, actor } of actors) {
      for (const goal of actor.goals.goals) {
        const row = document.createElement('li');
        const swatch = document.createElement('span');
        swatch.className = 'swatch';
        swatch.style.background = goal.colour;
        const label = document.createElement('span');
        label.textContent = `${goal.name} (${goal.kind})`;
        const facts = document.createElement('span');
        facts.className = 'facts';
        label.append(facts);
        row.append(swatch, label);
        this.goalRows.push({ row, facts, goal, of: actors.length > 1 ? `${name}: ` : '' });
      }
    }
    find('goals').replaceChildren(...this.goalRows.map(({ row }) => row));
    this.showMisses();
  }

  showMisses() {
    for (const { facts, goal, of } of this.goalRows ?? []) facts.textContent = of + missText(goal);
  }

  makeCameras() {
    const place = find('cameras');
    const add = (text, does) => {
      const button = document.createElement('button');
      button.type = 'button';
      button.textContent = text;
      button.addEventListener('click', does);
      place.append(button);
      return button;
    };
    add('Frame all (h)', () => this.frame());
    this.tracks = this.player.items.filter(({ camera }) => camera);
    this.tracks.forEach((made, i) => {
      made.button = add(`View ${made.name}${i === 0 ? ' (c)' : ''}`, () => this.fly(made));
      made.button.setAttribute('aria-pressed', 'false');
    });
  }

  fly(made) {
    const track = this.stage.flown === made.camera ? null : made.camera;
    this.stage.fly(track);
    for (const { camera, button, helper, visible } of this.tracks) {
      button.setAttribute('aria-pressed', String(camera === track));
      helper.visible = visible && camera !== track;
    }
  }

  frame() {
    const actors = this.player.actors();
    if (actors.length === 0) return;
    const whole = new Box3();
    const now = new Box3();
    for (const { box, actor } of actors) {
      whole.union(box.clone().translate(actor.group.position));
      now.union(actor.boxNow().translate(actor.group.position));
    }
    // For a long path, follow the character: framing the whole path would make it tiny.
    const reach = ({ x, y, z }) => Math.max(x, z) / Math.max(y, 1e-3);
    const all = whole.getSize(new Vector3());
    const here = now.getSize(new Vector3());
    if (Math.max(all.x, all.z) > 2.5 * Math.max(here.x, here.y, here.z) && reach(all) > 2) {
      this.stage.frame(now, this.viewFrom());
      if (!this.player.shown.follow) this.flip('follow', true);
      return;
    }
    this.stage.frame(whole, this.viewFrom());
  }

  // On a ground: from above, from the side of the way, and from its lower end, where steps are seen.
  viewFrom() {
    const [first] = this.player.actors();
    if (!this.stage.terrain || !first) return undefined;
    const { actor } = first;
    const rootAt = (time) => {
      actor.update(time);
      return actor.root().clone();
    };
    const way = rootAt(actor.duration).sub(rootAt(0));
    actor.update(this.player.time);
    const climbs = way.y;
    way.setY(0);
    if (way.length() < 0.5) return undefined;
    way.normalize();
    const from = new Vector3(way.z, 0.75, -way.x);
    return from.addScaledVector(way, climbs > 0.1 ? -0.6 : 0.6);
  }

  setLanes() {
    const lanes = [];
    const marks = [];
    for (const { actor, item } of this.player.actors()) {
      const joints = [...new Set(actor.contacts.map(({ joint }) => joint))];
      for (const joint of joints) {
        lanes.push({
          name: actor.motion.names[joint],
          colour: CONTACT_COLOUR,
          bars: actor.contacts.filter((c) => c.joint === joint).map(({ start, end }) => [start, end]),
        });
      }
      marks.push(...(item.keytimes ?? []));
    }
    this.lanes.set(lanes, marks, this.player.duration);
  }

  makeKeys() {
    const { player } = this;
    const keys = [
      [' ', 'Space', 'play, pause', () => this.togglePlay()],
      ['ArrowLeft', '← →', 'step one frame back, forward (Shift: ten)', (e) => player.step(e.shiftKey ? -10 : -1)],
      ['ArrowRight', null, null, (e) => player.step(e.shiftKey ? 10 : 1)],
      ['Home', 'Home End', 'go to start, end', () => player.setTime(0)],
      ['End', null, null, () => player.setTime(player.duration)],
      ['-', '− +', 'slower, faster', () => this.changeSpeed(-1)],
      ['+', null, null, () => this.changeSpeed(1)],
      ['=', null, null, () => this.changeSpeed(1)],
      ['h', 'h', 'frame all', () => this.frame()],
      ['s', 's b a d o p f g', 'toggle the options above', () => this.flip('skeleton')],
      ['b', null, null, () => this.flip('body')],
      ['a', null, null, () => this.flip('apart')],
      ['d', null, null, () => this.flip('difference')],
      ['o', null, null, () => this.flip('goals')],
      ['p', null, null, () => this.flip('prints')],
      ['f', null, null, () => this.flip('follow')],
      ['g', null, null, () => this.flip('grid')],
      ['c', 'c', 'view through the recorded camera', () => this.tracks[0] && this.fly(this.tracks[0])],
      ['PageDown', 'PgUp PgDn', 'previous, next file', () => this.turnPage(1)],
      ['PageUp', null, null, () => this.turnPage(-1)],
    ];
    for (const [, shown, does] of keys) {
      if (!shown) continue;
      const term = document.createElement('dt');
      term.textContent = shown;
      const detail = document.createElement('dd');
      detail.textContent = does;
      find('keys').append(term, detail);
    }
    document.addEventListener('keydown', (event) => {
      if (event.ctrlKey || event.metaKey || event.altKey) return;
      const { target } = event;
      // Lists, buttons and checkboxes handle these keys themselves.
      if (target instanceof HTMLSelectElement) return;
      const own = target instanceof HTMLButtonElement || target instanceof HTMLElement && target.tagName === 'SUMMARY'
        || (target instanceof HTMLInputElement && target.type === 'checkbox');
      if (own && event.key === ' ') return;
      const entry = keys.find(([key]) => key === event.key);
      if (!entry) return;
      event.preventDefault();
      entry[3](event);
    });
  }

  // Shows the name of the joint nearest to the pointer.
  watchPointer() {
    const tag = find('name-tag');
    const canvas = this.stage.canvas;
    canvas.addEventListener('pointerleave', () => { tag.hidden = true; });
    canvas.addEventListener('pointermove', (event) => {
      if (event.buttons !== 0) {
        tag.hidden = true;
        return;
      }
      const bounds = canvas.getBoundingClientRect();
      const near = this.nearestJoint(event.clientX - bounds.left, event.clientY - bounds.top);
      tag.hidden = !near;
      if (!near) return;
      tag.textContent = near.name;
      tag.style.left = `${near.x + 12}px`;
      tag.style.top = `${near.y - 12}px`;
    });
  }

  nearestJoint(x, y) {
    let best = null;
    let nearest = 14; // pixels
    const place = new Vector3();
    for (const { actor } of this.player.actors()) {
      const names = actor.motion?.names ?? actor.names;
      names.forEach((name, joint) => {
        place.copy(actor.jointPosition(joint)).add(actor.group.position);
        const seen = this.stage.project(place);
        if (!seen) return;
        const distance = Math.hypot(seen.x - x, seen.y - y);
        if (distance < nearest) {
          nearest = distance;
          best = { name, ...seen };
        }
      });
    }
    return best;
  }

  refresh() {
    const { player } = this;
    const button = find('play');
    const text = player.playing ? 'Pause' : 'Play';
    if (button.getAttribute('aria-label') !== text) {
      button.setAttribute('aria-label', text);
      button.setAttribute('aria-pressed', String(player.playing));
      find('play-icon').setAttribute('d', player.playing ? PAUSE_ICON : PLAY_ICON);
    }
    const slider = find('time');
    slider.value = String(player.time);
    const frame = Math.round(player.time * player.rate);
    const clock = `${player.time.toFixed(2)} / ${player.duration.toFixed(2)} s · frame ${frame}`;
    slider.setAttribute('aria-valuetext', `${player.time.toFixed(2)} seconds, frame ${frame}`);
    find('clock').textContent = clock;
    this.showMisses();
    if (player.shown.difference) {
      const d = player.difference;
      find('difference').textContent = d
        ? d.name ? `max ${lengthText(d.distance)} at ${d.name}; red is ${lengthText(d.scale)}` : 'none'
        : 'No joints with the same name in two visible characters.';
    }
  }
}

async function main() {
  const data = JSON.parse(find('krok-data').textContent);
  const stage = new Stage(find('view'));
  const items = [];
  for (const [index, item] of data.items.entries()) items.push(await makeItem(item, index, stage));
  if (data.ground) stage.setTerrain(data.ground, blobBytes(data.ground.blob));
  const prints = data.prints ? new Prints(data.prints) : null;
  if (prints) stage.scene.add(prints.group);
  const player = new Player(stage, items, prints);
  const controls = new Interface(player, stage, data);
  controls.rearrange();
  controls.frame();
  player.setTime(data.time ?? 0);
  // Plays at once, unless the system is set to reduced motion.
  if (player.duration > 0 && !matchMedia('(prefers-reduced-motion: reduce)').matches) controls.togglePlay();

  let last = null;
  let drawn = 0;
  const tick = (now) => {
    if (player.playing && last !== null) player.advance(Math.min((now - last) / 1000, 0.25));
    last = now;
    if (stage.draw()) ++drawn;
    requestAnimationFrame(tick);
  };
  requestAnimationFrame(tick);

  // For tests and scripts in the browser's console.
  globalThis.krokView = {
    ready: true,
    get time() { return player.time; },
    get duration() { return player.duration; },
    get playing() { return player.playing; },
    get drawn() { return drawn; },
    setTime: (time) => player.setTime(time),
    // A file's goals at this time.
    goals: (item = 0) => (items[item].actor.goals?.goals ?? []).map(
      ({ name, kind, chain, from, to, strength, distance, angle }) =>
        ({ name, kind, chain, from: from.toArray(), to: to.toArray(), strength, distance, angle }),
    ),
    // Heights of the ground's surfaces at (x, z), the highest first.
    groundAt: (x, z) => (stage.terrain
      ? new Raycaster(new Vector3(x, 1e4, z), new Vector3(0, -1, 0)).intersectObject(stage.terrain).map(({ point }) => point.y)
      : [0]),
    // Where a point is seen, in pixels of the canvas.
    project: (x, y, z) => stage.project(new Vector3(x, y, z)),
    prints: () => (prints?.list ?? []).map(
      ({ number, side, heel, forward, length, planted }) => ({ number, side, heel, forward, length, planted }),
    ),
    // World positions of a file's joints, without the side-by-side offset.
    joints: (item = 0) => {
      const { actor } = items[item];
      const names = actor.motion?.names ?? actor.names;
      return names.map((name, joint) => ({ name, position: actor.jointPosition(joint).toArray() }));
    },
  };
}

main().catch((error) => {
  const trouble = find('trouble');
  trouble.hidden = false;
  trouble.textContent = /webgl/i.test(error.message)
    ? 'WebGL is not available in this browser.'
    : `Cannot show the page: ${error.message}`;
  console.error(error);
});
