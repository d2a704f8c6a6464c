// The keyboard: what each key does, and the list of them.

const find = (id) => document.getElementById(id);

export function makeKeys(controls) {
  const { player, framing, timeline, joint, files } = controls;
  const flip = (key) => () => controls.flip(key);
  const keys = [
    [' ', 'Space', 'play, pause', () => controls.togglePlay()],
    ['ArrowLeft', '← →', 'step one frame back, forward (Shift: ten)', (e) => player.step(e.shiftKey ? -10 : -1)],
    ['ArrowRight', null, null, (e) => player.step(e.shiftKey ? 10 : 1)],
    ['Home', 'Home End', 'go to start, end', () => player.setTime(player.begin)],
    ['End', null, null, () => player.setTime(player.end)],
    ['-', '− +', 'slower, faster', () => controls.changeSpeed(-1)],
    ['+', null, null, () => controls.changeSpeed(1)],
    ['=', null, null, () => controls.changeSpeed(1)],
    ['[', '[ ] \\', 'start, end, clear the range (also Shift and drag)', () => controls.setIn()],
    [']', null, null, () => controls.setOut()],
    ['\\', null, null, () => player.setRange(0, player.duration)],
    [',', ', .', 'previous, next event', () => controls.toEvent(-1)],
    ['.', null, null, () => controls.toEvent(1)],
    ['z', 'z Z', 'zoom the time line in, out (also the wheel)', () => timeline.zoom(0.5)],
    ['Z', null, null, () => timeline.zoom(2)],
    ['h', 'h v', 'frame all, frame selected', () => framing.all()],
    ['v', null, null, () => framing.selected()],
    ['1', '1 3 7', 'view from front, side, top', () => framing.view('front')],
    ['3', null, null, () => framing.view('side')],
    ['7', null, null, () => framing.view('top')],
    ['s', 's b w a d o p f g', 'toggle the options above', flip('skeleton')],
    ['b', null, null, flip('body')],
    ['w', null, null, flip('wireframe')],
    ['a', null, null, flip('apart')],
    ['d', null, null, flip('difference')],
    ['o', null, null, flip('goals')],
    ['p', null, null, flip('prints')],
    ['f', null, null, flip('follow')],
    ['g', null, null, flip('grid')],
    ['t', 't Esc', 'trail of the joint, deselect it', () => joint.toggleTrail()],
    ['Escape', null, null, () => joint.choose(null)],
    ['c', 'c', 'view through the recorded camera', () => controls.tracks[0] && controls.fly(controls.tracks[0])],
    ['PageDown', 'PgUp PgDn', 'previous, next file', () => files.turnPage(1)],
    ['PageUp', null, null, () => files.turnPage(-1)],
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
    if (event.ctrlKey || event.metaKey || event.altKey || typesInto(event.target, event.key)) return;
    const entry = keys.find(([key]) => key === event.key);
    if (!entry) return;
    event.preventDefault();
    entry[3](event);
  });
}

// Lists, fields, buttons and checkboxes handle these keys themselves.
function typesInto(target, key) {
  if (target instanceof HTMLSelectElement) return true;
  if (target instanceof HTMLInputElement && target.type !== 'checkbox') return key !== 'Escape' || target.value !== '';
  const pressed = target instanceof HTMLButtonElement || target instanceof HTMLInputElement || target.tagName === 'SUMMARY';
  return pressed && key === ' ';
}
