// Icons of 16 x 16, drawn with lines; and buttons of them, with a label for screen readers and a tip.

const CUBE = 'M3 5.5 8 3l5 2.5v5L8 13l-5-2.5zM3 5.5 8 8l5-2.5M8 8v5';
const PATHS = {
  start: 'M3.5 3v10M13 3 6 8l7 5z',
  back: 'M12 3 5.5 8l6.5 5z',
  play: 'M4.5 3 13 8l-8.5 5z',
  pause: 'M5 3v10M11 3v10',
  forward: 'M4 3l6.5 5L4 13z',
  eventBack: 'M12 3v10M9.5 3 3 6l6.5 3',
  eventForward: 'M4 3v10M6.5 3 13 6 6.5 9',
  rangeIn: 'M9 3H5v10h4M8 8h5',
  rangeOut: 'M7 3h4v10H7M3 8h5',
  clear: 'M4 4l8 8M12 4l-8 8',
  zoomIn: 'M7 3a4 4 0 1 0 .01 0M10 10l3.5 3.5M5 7h4M7 5v4',
  zoomOut: 'M7 3a4 4 0 1 0 .01 0M10 10l3.5 3.5M5 7h4',
  fit: 'M2.5 3v10M13.5 3v10M4.5 8h7M6.5 6l-2 2 2 2M9.5 6l2 2-2 2',
  frameAll: 'M2.5 6V2.5H6M10 2.5h3.5V6M13.5 10v3.5H10M6 13.5H2.5V10M6 6h4v4H6z',
  frameSelected: 'M2.5 6V2.5H6M10 2.5h3.5V6M13.5 10v3.5H10M6 13.5H2.5V10M8 7.5a.5.5 0 1 0 .01 0',
  front: CUBE,
  side: CUBE,
  top: CUBE,
  screenshot: 'M2.5 5h3l1-1.5h3l1 1.5h3v8h-11zM8 6.5a2.3 2.3 0 1 0 .01 0',
  video: 'M2.5 4.5h7v7h-7zM9.5 7.5l4-2.5v6l-4-2.5',
  stop: 'M4 4h8v8H4z',
  link: 'M6.5 9.5l3-3M7 5l1.5-1.5a2.5 2.5 0 0 1 4 4L11 9M9 11l-1.5 1.5a2.5 2.5 0 0 1-4-4L5 7',
  panel: 'M2.5 3h11v10h-11zM9.5 3v10',
  copy: 'M5.5 5.5v-3h8v8h-3M2.5 5.5h8v8h-8z',
  trail: 'M2.5 12c3 0 2-6 5-6s2 4 6-2',
};
const FILLED = {
  start: PATHS.start,
  back: PATHS.back,
  play: PATHS.play,
  forward: PATHS.forward,
  stop: PATHS.stop,
  front: 'M3 5.5 8 8v5l-5-2.5z',
  side: 'M13 5.5 8 8v5l5-2.5z',
  top: 'M3 5.5 8 3l5 2.5L8 8z',
};

export function setIcon(button, name) {
  const space = 'http://www.w3.org/2000/svg';
  const svg = document.createElementNS(space, 'svg');
  svg.setAttribute('viewBox', '0 0 16 16');
  svg.setAttribute('aria-hidden', 'true');
  for (const [shape, kind] of [[PATHS[name], ''], [FILLED[name], 'filled']]) {
    if (!shape) continue;
    const path = document.createElementNS(space, 'path');
    path.setAttribute('d', shape);
    path.setAttribute('class', kind);
    svg.append(path);
  }
  button.replaceChildren(svg);
}

// `label` is what the button does; `key` the key that does the same.
export function iconButton(name, label, key, does) {
  const button = document.createElement('button');
  button.type = 'button';
  button.className = 'icon';
  setIcon(button, name);
  setLabel(button, label, key);
  button.addEventListener('click', does);
  return button;
}

export function setLabel(button, label, key) {
  button.setAttribute('aria-label', label);
  button.title = key ? `${label} (${key})` : label;
}
