// The controls: panel, tools over the picture, playback, keyboard.

import { FilesList } from './files_list.js';
import { Framing } from './framing.js';
import { missText } from './goals.js';
import { iconButton, setIcon, setLabel } from './icons.js';
import { JointCard, copy, nearestJoint } from './joint_card.js';
import { Recorder, screenshot } from './capture.js';
import { drawLegend, DifferenceLegend } from './legend.js';
import { linkTo, linked, placeCamera } from './link.js';
import { makeKeys } from './keys.js';
import { CONTACT_COLOUR } from './actor.js';
import { sideLanes } from './contacts.js';
import { Timeline } from './timeline.js';

const SPEEDS = [0.1, 0.25, 0.5, 1, 1.5, 2, 4];
const CLICK = 4; // pixels that a click may move
const find = (id) => document.getElementById(id);

export class Interface {
  constructor(player, stage, data) {
    this.player = player;
    this.stage = stage;
    this.data = data;
    this.framing = new Framing(player, stage, (on) => this.flip('follow', on));
    this.timeline = new Timeline(find('time'), player);
    this.legend = new DifferenceLegend(player);
    this.recorder = new Recorder(stage, player, data.title, () => this.showRecording());
    // Names of files may break after what separates their words.
    for (const part of data.title.split(/(?<=[_.-])/)) find('title').append(part, document.createElement('wbr'));
    document.title = `${data.title} – Krok`;
    this.joint = new JointCard(player, stage, {
      changed: () => this.setTimeline(),
      frame: () => this.framing.selected(),
    });
    this.joint.said = (text) => this.say(text);
    this.files = new FilesList(document, player, {
      show: (items) => this.show(items),
      choose: (made, clip) => this.chooseClip(made, clip),
    });
    this.makeTransport();
    this.makeTools();
    this.makeSwitches();
    this.makeCameras();
    makeKeys(this);
    this.watchPointer();
    player.watchers.push(() => this.refresh());
    find('panel-toggle').addEventListener('click', () => this.togglePanel());
    if (globalThis.innerWidth < 700) this.togglePanel();
    globalThis.addEventListener('hashchange', () => this.follow(linked()));
    stage.themed = () => this.timeline.draw();
  }

  // Said by screen readers, and shown for a moment.
  say(text) {
    const place = find('said');
    place.textContent = text;
    place.classList.add('shown');
    clearTimeout(this.saying);
    this.saying = setTimeout(() => place.classList.remove('shown'), 2500);
  }

  togglePanel() {
    const closed = find('panel').classList.toggle('closed');
    find('panel-toggle').setAttribute('aria-expanded', String(!closed));
  }

  makeTransport() {
    const { player, timeline } = this;
    const range = (i) => () => player.setRange(i === 0 ? player.time : player.begin, i === 0 ? player.end : player.time);
    this.playButton = iconButton('play', 'Play', 'Space', () => this.togglePlay());
    this.playButton.id = 'play';
    this.setIn = range(0);
    this.setOut = range(1);
    this.eventButtons = [
      iconButton('eventBack', 'Previous event', ',', () => this.toEvent(-1)),
      iconButton('eventForward', 'Next event', '.', () => this.toEvent(1)),
    ];
    this.clearRange = iconButton('clear', 'Clear the range', '\\', () => player.setRange(0, player.duration));
    find('moves').append(
      iconButton('start', 'Go to start', 'Home', () => player.setTime(player.begin)),
      iconButton('back', 'Previous frame', '←', () => player.step(-1)),
      this.playButton,
      iconButton('forward', 'Next frame', '→', () => player.step(1)),
      ...this.eventButtons,
    );
    find('ranges').append(
      iconButton('rangeIn', 'Start the range here', '[', this.setIn),
      iconButton('rangeOut', 'End the range here', ']', this.setOut),
      this.clearRange,
      iconButton('zoomIn', 'Zoom in on the time line', 'z', () => timeline.zoom(0.5)),
      iconButton('zoomOut', 'Zoom out of the time line', 'Shift+Z', () => timeline.zoom(2)),
      iconButton('fit', 'Show the whole time line', null, () => timeline.fit()),
    );
    find('loop').addEventListener('change', (event) => { player.loop = event.target.checked; });
    const speed = find('speed');
    for (const value of SPEEDS) speed.add(new Option(`${value}×`, value, value === 1, value === 1));
    speed.addEventListener('change', () => { player.speed = Number(speed.value); });
  }

  toEvent(step) {
    const time = this.timeline.eventBeside(this.player.time, step);
    if (time === undefined) return;
    this.player.playing = false;
    this.player.setTime(time);
  }

  togglePlay() {
    const { player } = this;
    if (!player.playing && player.time >= player.end) player.setTime(player.begin);
    player.playing = !player.playing && player.duration > 0;
    this.refresh();
  }

  changeSpeed(steps) {
    const at = SPEEDS.indexOf(this.player.speed);
    this.player.speed = SPEEDS[Math.min(Math.max(at + steps, 0), SPEEDS.length - 1)];
    find('speed').value = String(this.player.speed);
  }

  // The buttons over the picture.
  makeTools() {
    const { framing, stage, player } = this;
    this.videoButton = iconButton('video', 'Record a video', null, () => this.recorder.toggle());
    this.videoButton.hidden = !this.recorder.supported;
    find('tools').append(
      iconButton('frameAll', 'Frame all', 'h', () => framing.all()),
      iconButton('frameSelected', 'Frame selected', 'v', () => framing.selected()),
      iconButton('front', 'Front view', '1', () => framing.view('front')),
      iconButton('side', 'Side view', '3', () => framing.view('side')),
      iconButton('top', 'Top view', '7', () => framing.view('top')),
      iconButton('screenshot', 'Save a screenshot', null,
        () => screenshot(stage, player, this.data.title, player.difference && drawLegend(player.difference))),
      this.videoButton,
      iconButton('link', 'Copy a link to this view', null, async () => {
        const link = linkTo(player, stage);
        history.replaceState(null, '', link);
        await copy(link);
        this.say('Link copied');
      }),
    );
  }

  showRecording() {
    const { recording } = this.recorder;
    setIcon(this.videoButton, recording ? 'stop' : 'video');
    setLabel(this.videoButton, recording ? 'Stop recording' : 'Record a video');
    if (recording) this.say('Recording');
    this.videoButton.classList.toggle('recording', recording);
  }

  // Shows exactly these files, which are opened if they were not.
  async show(items) {
    await Promise.all(items.map((made) => made.open()));
    const before = this.player.actors();
    for (const made of this.player.items) made.visible = items.includes(made);
    this.rearrange();
    const after = this.player.actors();
    if (after.length > 0 && !after.some((made) => before.includes(made))) {
      this.player.setTime(0);
      this.framing.all();
    }
  }

  chooseClip(made, clip) {
    made.actor.choose(clip);
    made.measure();
    this.player.setRange(0, 0);
    this.rearrange();
    this.player.setTime(0);
    this.framing.all();
  }

  rearrange() {
    this.player.arrange();
    this.files.refresh();
    this.joint.fill();
    this.setTimeline();
    this.listGoals();
    this.legend.refresh();
  }

  makeSwitches() {
    const { player, stage } = this;
    const items = player.items.map(({ item }) => item).filter(({ kind }) => kind !== 'camera');
    const hasBody = items.some(({ kind, body }) => body || kind === 'gltf');
    player.shown.skeleton = !hasBody;
    player.shown.apart = Boolean(this.data.apart);
    player.shown.difference = Boolean(this.data.difference);
    player.shown.grid = true;
    const switches = [
      ['skeleton', 'Skeleton (s)', true],
      ['body', 'Body (b)', hasBody],
      ['wireframe', 'Wireframe (w)', hasBody],
      // Not beside a ground, on which they would stand elsewhere than they do.
      ['apart', 'Side by side (a)', items.length > 1 && !stage.terrain && !player.prints],
      ['difference', 'Difference (d)', ['motion', 'gltf'].some((wanted) => items.filter(({ kind }) => kind === wanted).length > 1)],
      ['goals', 'Goals (o)', items.some(({ goals }) => goals)],
      ['prints', 'Footprints (p)', Boolean(player.prints)],
      ['follow', 'Follow (f)', items.length > 0],
      ['grid', 'Ground (g)', true],
    ];
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
    if (items.some(({ contacts }) => contacts?.length > 0)) {
      const swatch = document.createElement('span');
      swatch.className = 'swatch';
      swatch.style.background = CONTACT_COLOUR;
      const meaning = document.createElement('span');
      meaning.className = 'check';
      meaning.append(swatch, ' Red: in contact');
      find('switches').append(meaning);
    }
  }

  flip(key, value = !this.player.shown[key]) {
    if (!this.switches.has(key)) return;
    const { player, stage } = this;
    player.shown[key] = value;
    this.switches.get(key).checked = value;
    if (key === 'follow') {
      player.before = null;
      return;
    }
    if (key === 'grid') stage.ground.visible = value;
    if (key === 'prints') player.prints.group.visible = value;
    // Bodies far apart have no difference to see.
    if (key === 'difference' && value && player.shown.apart) this.flip('apart', false);
    this.rearrange();
    if (key === 'apart') this.framing.all();
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
    this.tracks = this.player.items.filter(({ camera }) => camera);
    find('camera-section').hidden = this.tracks.length === 0;
    this.tracks.forEach((made, i) => {
      const button = document.createElement('button');
      button.type = 'button';
      button.textContent = `View ${made.name}${i === 0 ? ' (c)' : ''}`;
      button.setAttribute('aria-pressed', 'false');
      button.addEventListener('click', () => this.fly(made));
      find('cameras').append(button);
      made.button = button;
    });
  }

  fly(made) {
    const track = this.stage.flown === made.camera ? null : made.camera;
    this.stage.fly(track);
    this.player.before = null;
    for (const { camera, button, helper, visible } of this.tracks) {
      button.setAttribute('aria-pressed', String(camera === track));
      helper.visible = visible && camera !== track;
    }
  }

  setTimeline() {
    const { player } = this;
    const lanes = [];
    const marks = [];
    const actors = player.actors();
    for (const { actor, item, name } of actors) {
      lanes.push(...sideLanes(actor, actors.length > 1 ? name : ''));
      marks.push(...(item.keytimes ?? []));
    }
    const curves = this.joint.curves();
    if (player.difference) curves.unshift(player.difference.curve());
    this.timeline.set({ lanes, marks, curves, through: actors.length === 1 });
    for (const button of this.eventButtons) button.hidden = marks.length === 0;
  }

  // Names the joint under the pointer; a click selects it.
  watchPointer() {
    const tag = find('name-tag');
    const { canvas } = this.stage;
    const near = (event) => {
      const bounds = canvas.getBoundingClientRect();
      return nearestJoint(this.player, this.stage, event.clientX - bounds.left, event.clientY - bounds.top);
    };
    let pressed = null;
    canvas.addEventListener('pointerleave', () => { tag.hidden = true; });
    canvas.addEventListener('pointerdown', (event) => {
      pressed = event.button === 0 ? { x: event.clientX, y: event.clientY } : null;
    });
    canvas.addEventListener('pointerup', (event) => {
      if (!pressed || Math.hypot(event.clientX - pressed.x, event.clientY - pressed.y) > CLICK) return;
      this.joint.choose(near(event));
    });
    canvas.addEventListener('pointermove', (event) => {
      const found = event.buttons === 0 ? near(event) : null;
      tag.hidden = !found;
      if (!found) return;
      tag.textContent = found.name;
      tag.style.left = `${found.x + 12}px`;
      tag.style.top = `${found.y - 12}px`;
    });
  }

  // Shows what a link says.
  async follow(link) {
    if (!link) return;
    const { player, stage } = this;
    player.playing = false;
    const files = link.files?.map((index) => player.items[index]).filter(Boolean);
    if (files?.length > 0) await this.show(files);
    if (link.range) player.setRange(...link.range);
    player.setTime(link.time);
    if (link.camera) {
      placeCamera(stage, link.camera);
      player.before = null;
    }
    const made = link.joint && player.items[link.joint[0]];
    if (made?.visible && made.actor?.names[link.joint[1]] !== undefined) this.joint.choose({ made, joint: link.joint[1] });
    this.refresh();
  }

  refresh() {
    const { player } = this;
    const text = player.playing ? 'Pause' : 'Play';
    if (this.playButton.getAttribute('aria-label') !== text) {
      setLabel(this.playButton, text, 'Space');
      setIcon(this.playButton, player.playing ? 'pause' : 'play');
    }
    this.clearRange.disabled = !player.range;
    const frame = Math.round(player.time * player.rate);
    const slider = find('time');
    slider.setAttribute('aria-valuemax', player.duration.toFixed(3));
    slider.setAttribute('aria-valuenow', player.time.toFixed(3));
    slider.setAttribute('aria-valuetext', `${player.time.toFixed(2)} seconds, frame ${frame}`);
    find('clock').textContent = `${player.time.toFixed(2)} / ${player.duration.toFixed(2)} s · frame ${frame}`;
    this.timeline.refresh();
    this.joint.refresh();
    this.showMisses();
    this.legend.update();
  }
}
