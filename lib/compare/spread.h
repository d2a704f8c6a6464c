#pragma once

#include <bit>
#include <cstdint>
#include <vector>

// Streaming percentiles of a distribution in bounded memory.

namespace krok::compare {

// Up to kExact nonzero values are kept exactly; beyond that they are counted in bins, 64 per
// octave. Results depend only on the values, not on their order or on how they were split before
// merging.
class Spread {
 public:
  static constexpr std::size_t kExact = 256;

  // `value` >= 0; infinity is allowed.
  void add(double value) {
    const std::uint64_t bin = bin_of(value) - first_bin_;
    if (value == 0) {
      ++zeros_;
    } else if (bin < bins_.size()) {
      ++bins_[bin];
      ++positive_;
    } else {
      add_positive(value);
    }
  }
  void merge(const Spread& other);

  std::int64_t count() const { return zeros_ + positive_; }

  // The smallest value that a fraction `share`, in (0, 1], of all do not exceed (nearest rank); 0
  // without values. Exact for up to kExact nonzero values, otherwise at most 1.6 % too high, never
  // too low. Values under 1e-19 count as 1e-19, values over 1e19 as infinity.
  double percentile(double share) const;

 private:
  // Bin index: exponent and first mantissa bits, rising with the value. Taken from the bits, so
  // that it is the same on every machine.
  static std::uint64_t bin_of(double value) { return std::bit_cast<std::uint64_t>(value) >> 46; }

  void add_positive(double value);
  void empty_few();
  void count_in_bins(double value);
  void make_room(std::uint64_t bin);

  std::int64_t zeros_ = 0;
  std::int64_t positive_ = 0;
  std::int64_t beyond_ = 0;         // above the bins
  std::vector<double> few_;         // exact values, while there are few
  std::uint64_t first_bin_ = 0;     // index of bins_[0]
  std::vector<std::int64_t> bins_;  // only the octaves between those that occur
};

}  // namespace krok::compare
