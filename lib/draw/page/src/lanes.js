// The lanes of the timeline: contacts as bars, keytimes as marks.

const LANE = 9; // CSS pixels

export class Lanes {
  constructor(canvas) {
    this.canvas = canvas;
    this.lanes = [];
    this.marks = [];
  }

  // lanes: [{name, colour, bars: [[start, end]]}], marks: [{time, name}], seconds.
  set(lanes, marks, duration) {
    Object.assign(this, { lanes, marks, duration });
    const rows = lanes.length + (marks.length > 0 ? 1 : 0);
    this.canvas.style.height = `${rows * LANE}px`;
    this.draw();
  }

  draw() {
    const { canvas } = this;
    const width = canvas.clientWidth;
    const height = canvas.clientHeight;
    if (width === 0 || height === 0 || !(this.duration > 0)) return;
    const ratio = globalThis.devicePixelRatio ?? 1;
    canvas.width = width * ratio;
    canvas.height = height * ratio;
    const pen = canvas.getContext('2d');
    pen.scale(ratio, ratio);
    // The slider's thumb stays half its width away from both ends.
    const margin = 8;
    const at = (time) => margin + (time / this.duration) * (width - 2 * margin);
    pen.fillStyle = getComputedStyle(canvas).color;
    pen.strokeStyle = pen.fillStyle;
    this.marks.forEach(({ time }) => {
      pen.beginPath();
      pen.moveTo(at(time), 1);
      pen.lineTo(at(time) + 3, LANE - 1);
      pen.lineTo(at(time) - 3, LANE - 1);
      pen.fill();
    });
    const top = this.marks.length > 0 ? LANE : 0;
    this.lanes.forEach(({ colour, bars }, row) => {
      pen.fillStyle = colour;
      for (const [start, end] of bars) {
        pen.fillRect(at(start), top + row * LANE + 1, Math.max(at(end) - at(start), 1), LANE - 2);
      }
    });
  }
}
