// What compared motions and glTF files have in common: the largest distance over time, which sets the
// scale. `one` is coloured by its distance from `other`, a ghost.

const MOST_VALUES = 4000; // of the curve
const STEPS = [1, 1.5, 2, 3, 4, 5, 6, 8, 10];

// One of these times a power of ten: the least that is not smaller, but for rounding errors.
function roundUp(value) {
  const power = 10 ** Math.floor(Math.log10(value));
  return STEPS.map((step) => step * power).find((step) => step >= value * (1 - 1e-4));
}

export class ComparedPair {
  constructor(one, other) {
    this.one = one;
    this.other = other;
    this.animations = [one.animation, other.animation]; // of glTF files
  }

  // Whether this is what is to be compared.
  compares(one, other) {
    return this.one === one && this.other === other && this.animations[0] === one.animation &&
      this.animations[1] === other.animation;
  }

  // `most()` returns the largest distance at the time that both were updated to; at up to `samples` times.
  measure(samples, most) {
    const { one, other } = this;
    const duration = Math.min(one.duration, other.duration);
    const count = Math.min(samples, Math.round(duration * Math.max(one.rate, other.rate)) + 1);
    this.values = new Float32Array(count);
    this.rate = count > 1 ? (count - 1) / duration : 1;
    for (let i = 0; i < count; ++i) {
      this.pose(i / this.rate);
      this.values[i] = Math.max(0, most());
    }
    this.worstDistance = Math.max(...this.values);
    this.worst = this.values.indexOf(this.worstDistance) / this.rate;
    this.scale = this.ownScale = roundUp(Math.max(this.worstDistance, 1e-6));
  }

  // What krok-diff measured: the largest distance at all times at which the two may differ most.
  take({ times, distances, time, distance }) {
    const { one, other } = this;
    const duration = Math.min(one.duration, other.duration);
    const count = Math.min(MOST_VALUES, Math.round(duration * Math.max(one.rate, other.rate)) + 1);
    this.values = new Float32Array(count);
    this.rate = count > 1 ? (count - 1) / duration : 1;
    for (let i = 0, next = 1; i < count; ++i) {
      while (next < times.length - 1 && times[next] < i / this.rate) ++next;
      const before = Math.min(next, times.length) - 1;
      const part = next < times.length ? (i / this.rate - times[before]) / (times[next] - times[before]) : 0;
      const share = Math.min(Math.max(part, 0), 1);
      this.values[i] = distances[before] * (1 - share) + (distances[next] ?? 0) * share;
    }
    times.forEach((at, i) => {
      const nearest = Math.min(Math.round(at * this.rate), count - 1);
      this.values[nearest] = Math.max(this.values[nearest], distances[i]);
    });
    this.worstDistance = distance;
    this.worst = time;
    this.scale = this.ownScale = roundUp(Math.max(distance, 1e-6));
  }

  // Between the times that were sampled a distance may be larger: the scale then grows. `largest` is
  // {distance, name}, at the time shown.
  note(largest, time) {
    this.largest = largest;
    if (largest.distance <= this.worstDistance * (1 + 1e-4)) return; // the page computes in floats
    const own = this.scale === this.ownScale;
    this.worstDistance = largest.distance;
    this.worst = time;
    this.ownScale = roundUp(largest.distance);
    if (own) this.scale = this.ownScale;
  }

  pose(time) {
    this.one.update(time);
    this.other.update(time);
  }

  // For the time line.
  curve() {
    return {
      name: 'Difference', unit: 'mm', floor: 0, colour: '#8f1237', rate: this.rate,
      values: this.values.map((metres) => metres * 1000),
    };
  }
}
