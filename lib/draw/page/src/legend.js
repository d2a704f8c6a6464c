// The legend of a difference: its colours in millimetres, the largest distance now and at all times.

import { lengthText } from './difference.js';
import { gradient, ramp } from './ramp.js';

const find = (id) => document.getElementById(id);

function marksOf(scale) {
  const digits = scale * 1000 < 1 ? 2 : scale * 1000 < 10 ? 1 : 0;
  return [0, 0.5, 1].map((share) => `${(share * scale * 1000).toFixed(digits)}`);
}

export class DifferenceLegend {
  constructor(player) {
    this.player = player;
    find('ramp').style.background = gradient();
    this.field = find('difference-scale');
    this.field.addEventListener('change', () => {
      const value = Number(this.field.value) / 1000;
      const { difference } = player;
      if (!difference) return;
      difference.scale = value > 0 ? value : difference.ownScale;
      this.refresh();
      player.update();
    });
    this.field.addEventListener('keydown', ({ key }) => { if (key === 'Enter') this.field.blur(); });
    find('difference-worst').addEventListener('click', () => {
      player.playing = false;
      player.setTime(player.difference.worst);
    });
  }

  refresh() {
    const { difference, shown } = this.player;
    find('difference-section').hidden = !shown.difference;
    find('difference-legend').hidden = !difference;
    this.worstDistance = difference?.worstDistance;
    if (difference) {
      this.field.value = String(Number((difference.scale * 1000).toPrecision(6)));
      const marks = find('ramp-marks').children;
      marksOf(difference.scale).forEach((text, i) => { marks[i].textContent = i === 2 ? `${text} mm` : text; });
      find('difference-worst').textContent = `Go to the largest: ${lengthText(difference.worstDistance)}, ${difference.worst.toFixed(2)} s`;
    }
    this.update();
  }

  update() {
    const { difference, shown } = this.player;
    if (!shown.difference) return;
    if (difference && difference.worstDistance !== this.worstDistance) return this.refresh(); // it grew
    find('difference').textContent = difference
      ? difference.largest?.name ? `now max ${lengthText(difference.largest.distance)} at ${difference.largest.name}` : 'now none'
      : 'Nothing to compare: two visible motions with joints of the same name, or two glTF files with as many vertices.';
  }
}

// Draws the same on a screenshot.
export const drawLegend = ({ scale }) => (pen, width, height) => {
  const wide = Math.min(width * 0.4, 480);
  const left = (width - wide) / 2;
  const high = Math.max(height * 0.02, 10);
  const top = height - high * 3.4;
  for (let i = 0; i < wide; ++i) {
    pen.fillStyle = ramp(i / wide).getStyle();
    pen.fillRect(left + i, top, 1.5, high);
  }
  pen.font = `${high * 1.2}px system-ui, sans-serif`;
  pen.textAlign = 'center';
  pen.textBaseline = 'top';
  pen.lineWidth = high / 4;
  pen.strokeStyle = '#ffffff';
  pen.fillStyle = '#1b1f24';
  marksOf(scale).forEach((text, i) => {
    const words = i === 2 ? `${text} mm` : text;
    pen.strokeText(words, left + (wide * i) / 2, top + high * 1.3);
    pen.fillText(words, left + (wide * i) / 2, top + high * 1.3);
  });
};
