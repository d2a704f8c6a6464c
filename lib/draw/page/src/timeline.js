// The time line: a ruler, events as flags, contacts as bars on named lanes, curves of a joint; a range
// that is looped; zoom. Times are in seconds, places in CSS pixels.

const RULER = 22;
const FLAGS = 16;
const LANE = 15;
const CURVE = 46;
const NAMES = 118; // width of the names' column; less on narrow screens
const EDGE = 10; // right margin
const LEAST_NAME = 22; // pixels, for a flag's name
const GRAB = 6; // from an end of the range
const LEAST = 4; // frames that the whole width shows at least

export class Timeline {
  constructor(root, player) {
    this.root = root;
    this.player = player;
    this.ruler = root.querySelector('#ruler');
    this.canvas = root.querySelector('#lanes');
    this.head = root.querySelector('#playhead');
    this.tip = root.querySelector('#time-tip');
    this.lanes = [];
    this.marks = [];
    this.curves = [];
    this.view = [0, 1];
    this.width = 0; // kept, as asking for it makes the browser lay the page out
    this.listen();
    new ResizeObserver(() => this.draw()).observe(root);
  }

  // lanes: [{name, colour, bars: [[start, end]]}]; marks: [{time, name}]; curves: [{name, unit, colour,
  // values, rate}]; through: whether marks are drawn across all lanes.
  set({ lanes, marks, curves, through }) {
    const { duration } = this.player;
    if (duration !== this.duration) this.view = [0, duration];
    Object.assign(this, { lanes, marks: [...marks].sort((a, b) => a.time - b.time), curves, through, duration });
    this.root.classList.toggle('empty', !(duration > 0));
    this.root.classList.toggle('curves', curves.length > 0);
    this.canvas.style.height = `${this.rows()}px`;
    this.draw();
  }

  // The flags are above the curves, and these above the lanes: of many the last are scrolled to.
  get top() {
    return this.marks.length > 0 ? FLAGS : 0;
  }

  // Pixels below the top of the time line.
  get curvesEnd() {
    return RULER + this.top + this.curves.length * CURVE;
  }

  // What is at a height: the curve or lane.
  at(y) {
    const curve = this.curves[Math.floor((y - this.top) / CURVE)];
    return { curve, lane: curve ? undefined : this.lanes[Math.floor((y - this.top - this.curves.length * CURVE) / LANE)] };
  }

  rows() {
    return this.top + this.lanes.length * LANE + this.curves.length * CURVE;
  }

  get left() {
    const { width } = this;
    if (this.lanes.length + this.curves.length === 0) return EDGE;
    return width < 600 ? 64 : NAMES;
  }

  placeOf(time) {
    const [from, to] = this.view;
    return this.left + ((time - from) / Math.max(to - from, 1e-9)) * (this.width - this.left - EDGE);
  }

  timeAt(x) {
    const [from, to] = this.view;
    const share = (x - this.left) / Math.max(this.width - this.left - EDGE, 1);
    return Math.min(Math.max(from + share * (to - from), 0), this.duration);
  }

  // Shows `factor` times as much, with `time` where it is.
  zoom(factor, time = this.player.time) {
    const [from, to] = this.view;
    const least = Math.min(this.duration, LEAST / this.player.rate);
    const wide = Math.min(Math.max((to - from) * factor, least), this.duration);
    const share = (Math.min(Math.max(time, from), to) - from) / Math.max(to - from, 1e-9);
    this.show(time - share * wide, wide);
  }

  fit() {
    this.show(0, this.duration);
  }

  show(from, wide) {
    const start = Math.min(Math.max(from, 0), Math.max(this.duration - wide, 0));
    this.view = [start, start + wide];
    this.draw();
  }

  // The events before and after a time.
  eventBeside(time, step) {
    const times = this.marks.map((mark) => mark.time);
    return step > 0 ? times.find((each) => each > time + 1e-4) : times.findLast((each) => each < time - 1e-4);
  }

  // Moves the play head, with the view where that is left behind.
  refresh() {
    const { time, range, duration } = this.player;
    if (!(duration > 0)) return;
    const [from, to] = this.view;
    if ((time < from || time > to) && !this.dragging) this.show(time - (to - from) * 0.1, to - from);
    if (range?.join() !== this.drawnRange) this.draw();
    this.head.style.transform = `translateX(${this.placeOf(time)}px)`;
  }

  pen(canvas, height) {
    const ratio = globalThis.devicePixelRatio ?? 1;
    const width = this.width;
    canvas.width = Math.max(width * ratio, 1);
    canvas.height = Math.max(height * ratio, 1);
    const pen = canvas.getContext('2d');
    pen.scale(ratio, ratio);
    pen.font = '11px system-ui, sans-serif';
    pen.textBaseline = 'middle';
    return pen;
  }

  draw() {
    this.width = this.root.clientWidth;
    if (this.width === 0 || !(this.duration > 0)) return;
    const style = getComputedStyle(this.root);
    const colour = (name) => style.getPropertyValue(name).trim();
    this.colours = { ink: colour('--ink'), soft: colour('--soft'), line: colour('--line'), accent: colour('--accent'), mark: colour('--mark') };
    this.drawnRange = this.player.range?.join();
    this.drawRuler(this.pen(this.ruler, RULER));
    const height = this.rows();
    if (height > 0) this.drawRows(this.pen(this.canvas, height), height);
    this.head.style.transform = `translateX(${this.placeOf(this.player.time)}px)`;
  }

  // Ticks at 1, 2 or 5 times a power of ten of a second, or at frames where those are far apart.
  ticks() {
    const [from, to] = this.view;
    const perPixel = (to - from) / Math.max(this.width - this.left - EDGE, 1);
    const wanted = 70 * perPixel;
    const power = 10 ** Math.floor(Math.log10(wanted));
    const step = [1, 2, 5, 10].map((each) => each * power).find((each) => each >= wanted);
    const digits = Math.max(0, -Math.floor(Math.log10(step) + 1e-9));
    const times = [];
    for (let i = Math.ceil(from / step - 1e-9); i * step <= to + 1e-9; ++i) times.push(i * step);
    return { times, step, digits };
  }

  drawRuler(pen) {
    const { ink, soft, line, accent } = this.colours;
    const { width, left } = this;
    const { times, step, digits } = this.ticks();
    const { range, rate } = this.player;
    pen.strokeStyle = line;
    pen.fillStyle = soft;
    pen.beginPath();
    for (const time of times) {
      const x = this.placeOf(time);
      pen.moveTo(x, RULER - 8);
      pen.lineTo(x, RULER);
      for (let part = 1; part < 5; ++part) {
        const minor = this.placeOf(time + (step * part) / 5);
        pen.moveTo(minor, RULER - 4);
        pen.lineTo(minor, RULER);
      }
      const text = `${time.toFixed(digits)} s`;
      if (x + 4 + pen.measureText(text).width < width) pen.fillText(text, x + 3, 8);
    }
    pen.stroke();
    // Frames, where they are far enough apart to be seen.
    const [from, to] = this.view;
    if ((width - left) / Math.max((to - from) * rate, 1e-9) > 6) {
      pen.fillStyle = ink;
      for (let frame = Math.ceil(from * rate - 1e-6); frame / rate <= to + 1e-9; ++frame) {
        pen.fillRect(this.placeOf(frame / rate) - 0.5, RULER - 3, 1, 3);
      }
    }
    if (range) {
      const [a, b] = range.map((time) => this.placeOf(time));
      pen.fillStyle = accent;
      pen.globalAlpha = 0.25;
      pen.fillRect(a, 0, b - a, RULER);
      pen.globalAlpha = 1;
      pen.fillRect(a - 1, 0, 3, RULER);
      pen.fillRect(b - 2, 0, 3, RULER);
    }
    pen.clearRect(0, 0, Math.max(left - 1, 0), RULER);
    pen.clearRect(width - EDGE + 2, 0, EDGE, RULER);
  }

  drawRows(pen, height) {
    const { line } = this.colours;
    const { width, left } = this;
    pen.save();
    pen.beginPath();
    pen.rect(left - 1, 0, width - left - EDGE + 3, height);
    pen.clip();
    pen.fillStyle = line;
    pen.globalAlpha = 0.6;
    for (const time of this.ticks().times) pen.fillRect(this.placeOf(time) - 0.5, 0, 1, height);
    pen.globalAlpha = 1;
    let { top } = this;
    for (const curve of this.curves) {
      this.drawCurve(pen, curve, top);
      top += CURVE;
    }
    for (const { colour, bars } of this.lanes) {
      pen.fillStyle = colour;
      for (const [start, end] of bars) {
        const x = this.placeOf(start);
        pen.fillRect(x, top + 2, Math.max(this.placeOf(end) - x, 1), LANE - 4);
      }
      top += LANE;
    }
    this.drawFlags(pen, height);
    this.shadeOutside(pen, height);
    pen.restore();
    this.drawNames(pen);
  }

  drawCurve(pen, { values, rate, colour, floor }, top) {
    const { line } = this.colours;
    pen.fillStyle = line;
    pen.fillRect(0, top, this.width, 1);
    const [low, high] = rangeOf(values, floor);
    const y = (value) => top + CURVE - 5 - ((value - low) / Math.max(high - low, 1e-9)) * (CURVE - 11);
    const first = Math.max(0, Math.floor(this.view[0] * rate) - 1);
    const last = Math.min(values.length - 1, Math.ceil(this.view[1] * rate) + 1);
    // Not more points than there are places.
    const stride = Math.max(1, Math.floor((last - first) / (2 * this.width)));
    pen.strokeStyle = colour;
    pen.lineWidth = 1.5;
    pen.beginPath();
    for (let i = first; i <= last; i += stride) pen.lineTo(this.placeOf(i / rate), y(values[i]));
    pen.stroke();
    pen.lineWidth = 1;
  }

  drawFlags(pen, height) {
    const { mark } = this.colours;
    this.marks.forEach(({ time, name }, i) => {
      const x = this.placeOf(time);
      const next = i + 1 < this.marks.length ? this.placeOf(this.marks[i + 1].time) : Infinity;
      pen.fillStyle = mark;
      pen.globalAlpha = 0.45;
      pen.fillRect(x - 0.5, 0, 1, this.through ? height : FLAGS - 2);
      pen.globalAlpha = 1;
      pen.beginPath();
      pen.moveTo(x, 2);
      pen.lineTo(x + 8, 5.5);
      pen.lineTo(x, 9);
      pen.fill();
      // As much of the name as fits before the next flag: left_strike, L strike, L.
      const wide = Math.min(next, this.width) - x - 12;
      const short = name.replace(/^left_/, 'L ').replace(/^right_/, 'R ');
      const names = short === name ? [name] : [name, short, short[0]];
      const fitting = names.find((one) => pen.measureText(one).width <= wide);
      if (fitting) pen.fillText(fitting, x + 10, 7);
      else if (wide > LEAST_NAME) pen.fillText(shortened(pen, name, wide), x + 10, 7);
    });
  }

  shadeOutside(pen, height) {
    const { range } = this.player;
    if (!range) return;
    pen.fillStyle = this.colours.soft;
    pen.globalAlpha = 0.25;
    pen.fillRect(0, 0, this.placeOf(range[0]), height);
    pen.fillRect(this.placeOf(range[1]), 0, this.width, height);
    pen.globalAlpha = 1;
  }

  drawNames(pen) {
    const { ink, soft } = this.colours;
    const wide = this.left - 8;
    const put = (text, y, colour) => {
      pen.fillStyle = colour;
      pen.fillText(shortened(pen, text, wide), 2, y);
    };
    let { top } = this;
    if (top > 0 && this.left > EDGE) put('Events', top / 2, soft);
    for (const { name, unit, values, floor } of this.curves) {
      const [low, high] = rangeOf(values, floor);
      put(name, top + 11, ink);
      put(`${text(low)} to ${text(high)} ${unit}`, top + 27, soft);
      top += CURVE;
    }
    for (const { name } of this.lanes) {
      put(name, top + LANE / 2 + 0.5, ink);
      top += LANE;
    }
  }

  listen() {
    const { root, player } = this;
    const placeIn = (event) => event.clientX - root.getBoundingClientRect().left;
    root.addEventListener('pointerdown', (event) => {
      if (event.button !== 0 || !(this.duration > 0)) return;
      root.setPointerCapture(event.pointerId);
      const x = placeIn(event);
      const onRuler = event.target === this.ruler;
      const end = player.range && onRuler
        ? [0, 1].find((i) => Math.abs(this.placeOf(player.range[i]) - x) < GRAB) : undefined;
      const time = this.timeAt(x);
      if (end !== undefined) this.dragging = { fixed: player.range[1 - end] };
      else if (event.shiftKey) this.dragging = { fixed: time };
      else this.dragging = { scrub: true };
      this.drag(time);
      event.preventDefault();
      root.focus({ preventScroll: true });
    });
    root.addEventListener('pointermove', (event) => {
      if (this.dragging) this.drag(this.timeAt(placeIn(event)));
      else this.hover(placeIn(event), event);
    });
    const release = () => { this.dragging = null; };
    root.addEventListener('pointerup', release);
    root.addEventListener('pointercancel', release);
    root.addEventListener('pointerleave', () => { this.tip.hidden = true; });
    root.addEventListener('wheel', (event) => {
      if (!(this.duration > 0)) return;
      const sideways = event.shiftKey ? event.deltaY : event.deltaX;
      const [from, to] = this.view;
      if (sideways !== 0) {
        this.show(from + ((to - from) * sideways) / 1000, to - from);
      } else if (this.scrolls() && event.target !== this.ruler && !event.ctrlKey) {
        return; // the lanes scroll
      } else {
        this.zoom(1.002 ** event.deltaY, this.timeAt(placeIn(event)));
      }
      event.preventDefault();
    }, { passive: false });
  }

  scrolls() {
    return this.root.scrollHeight > this.root.clientHeight + 1;
  }

  drag(time) {
    const { player } = this;
    this.tip.hidden = true;
    if (this.dragging.scrub) {
      player.playing = false;
      player.setTime(time);
    } else {
      const snapped = Math.round(time * player.rate) / player.rate;
      player.setRange(this.dragging.fixed, snapped);
    }
  }

  // Names what is under the pointer: an event, or a lane's bar.
  hover(x, event) {
    const y = event.clientY - this.canvas.getBoundingClientRect().top;
    const { tip } = this;
    let words = '';
    const near = this.marks.find(({ time }) => Math.abs(this.placeOf(time) - x) < 6);
    const { curve, lane } = this.at(y);
    if (event.target === this.canvas && x >= this.left) {
      const time = this.timeAt(x);
      if (near && y < this.top) words = `${near.name}, ${near.time.toFixed(3)} s`;
      const bar = lane?.bars.find(([start, end]) => time >= start && time <= end);
      if (bar) words = `${lane.name}: ${bar[0].toFixed(3)} to ${bar[1].toFixed(3)} s`;
      if (curve && y >= this.top) {
        const value = curve.values[Math.min(Math.round(time * curve.rate), curve.values.length - 1)];
        words = `${curve.name}: ${text(value)} ${curve.unit} at ${time.toFixed(3)} s`;
      }
    }
    if (event.target === this.canvas && x < this.left) {
      words = y < this.top ? '' : (lane ?? curve)?.name ?? '';
    }
    tip.hidden = words === '';
    tip.textContent = words;
    tip.style.left = `${Math.min(x + 8, this.width - 160)}px`;
    tip.style.top = `${Math.max(y, 0)}px`;
  }
}

// With a floor, such as 0 of a distance, from there on.
function rangeOf(values, floor = Infinity) {
  let low = floor;
  let high = -Infinity;
  for (const value of values) {
    low = Math.min(low, value);
    high = Math.max(high, value);
  }
  return [low, high];
}

const text = (value) => (Math.abs(value) >= 100 ? value.toFixed(0) : Math.abs(value) >= 10 ? value.toFixed(1) : value.toFixed(2));

// Names of a batch often differ at their ends: what does not fit is left out in the middle.
function shortened(pen, words, wide) {
  if (pen.measureText(words).width <= wide) return words;
  for (let kept = words.length - 1; kept > 1; --kept) {
    const front = Math.ceil(kept / 2);
    const short = `${words.slice(0, front)}…${words.slice(words.length - (kept - front))}`;
    if (pen.measureText(short).width <= wide) return short;
  }
  return '…';
}
