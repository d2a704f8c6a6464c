#include "compare/measure.h"

#include <algorithm>

namespace krok::compare {

void Totals::merge(const Totals& later) {
  take_largest(later.largest, later.where);
  sum += later.sum;
  square_sum += later.square_sum;
  count += later.count;
  over += later.over;
}

double Totals::rms() const {
  return count == 0 ? 0.0 : std::sqrt(square_sum / static_cast<double>(count));
}

void Measure::merge(const Measure& later) {
  Totals::merge(later);
  spread.merge(later.spread);
}

double Measure::percentile(double share) const {
  return std::min(largest, spread.percentile(share));
}

double angle_between_directions(const Vec3& a, const Vec3& b) {
  const double length_a = a.norm();
  const double length_b = b.norm();
  if (length_a == 0 || length_b == 0) return length_a == length_b ? 0.0 : kPi;
  // Kahan's formula, "How futile are mindless assessments of roundoff", section 12: accurate at
  // both ends.
  const Vec3 u = a / length_a;
  const Vec3 v = b / length_b;
  return 2.0 * std::atan2((u - v).norm(), (u + v).norm());
}

namespace {

constexpr std::uint64_t kOctave = 64;  // bins
constexpr double kLowest = 0x1p-64;    // counted as this
constexpr double kBeyond = 0x1p64;

double upper_edge(std::uint64_t bin) {
  return std::bit_cast<double>((bin + 1) << 46);
}

}  // namespace

void Spread::add_positive(double value) {
  ++positive_;
  if (positive_ <= static_cast<std::int64_t>(kExact)) {
    few_.push_back(value);
    return;
  }
  empty_few();
  count_in_bins(value);
}

void Spread::empty_few() {
  for (const double one : few_) count_in_bins(one);
  if (!few_.empty()) std::vector<double>().swap(few_);
}

void Spread::count_in_bins(double value) {
  if (value >= kBeyond) {
    ++beyond_;
    return;
  }
  const std::uint64_t bin = bin_of(std::max(value, kLowest));
  make_room(bin);
  ++bins_[bin - first_bin_];
}

void Spread::make_room(std::uint64_t bin) {
  const std::uint64_t octave = bin / kOctave * kOctave;
  if (bins_.empty()) first_bin_ = octave;
  if (octave < first_bin_) {
    bins_.insert(bins_.begin(), first_bin_ - octave, 0);
    first_bin_ = octave;
  } else if (octave >= first_bin_ + bins_.size()) {
    bins_.resize(octave + kOctave - first_bin_, 0);
  }
}

void Spread::merge(const Spread& other) {
  zeros_ += other.zeros_;
  if (other.positive_ <= static_cast<std::int64_t>(kExact)) {
    for (const double value : other.few_) add_positive(value);
    return;
  }
  empty_few();
  positive_ += other.positive_;
  beyond_ += other.beyond_;
  for (std::size_t i = 0; i < other.bins_.size(); ++i) {
    if (other.bins_[i] == 0) continue;
    make_room(other.first_bin_ + i);
    bins_[other.first_bin_ + i - first_bin_] += other.bins_[i];
  }
}

double Spread::percentile(double share) const {
  const auto rank = static_cast<std::int64_t>(std::ceil(share * static_cast<double>(count())));
  std::int64_t left = std::clamp<std::int64_t>(rank, 1, std::max<std::int64_t>(count(), 1));
  left -= zeros_;
  if (left <= 0 || count() == 0) return 0;
  if (!few_.empty()) {
    std::vector<double> sorted = few_;
    const auto nth = sorted.begin() + (left - 1);
    std::nth_element(sorted.begin(), nth, sorted.end());
    return *nth;
  }
  for (std::size_t i = 0; i < bins_.size(); ++i) {
    left -= bins_[i];
    if (left > 0) continue;
    return upper_edge(first_bin_ + i);
  }
  return std::numeric_limits<double>::infinity();
}

}  // namespace krok::compare
