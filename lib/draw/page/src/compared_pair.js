// What compared motions and glTF files have in common: the largest distance over time, which sets the
// scale. `one` is coloured by its distance from `other`, a ghost.

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

  // Between the times that were sampled a distance may be larger: the scale then grows. `largest` is
  // {distance, name}, at the time shown.
  note(largest, time) {
    this.largest = largest;
    if (largest.distance <= this.worstDistance) return;
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
