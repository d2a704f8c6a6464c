#pragma once

#include <bit>
#include <cstdint>
#include <vector>

// How values spread, without keeping them: enough to tell percentiles in bounded memory.

namespace krok::compare {

// Values that are not 0 are kept as they are up to kExact of them; more are counted in bins, 64 to
// a doubling. What comes out depends on the values alone, never on the order in which they came or
// on how they were shared out before merging.
class Spread {
 public:
  static constexpr std::size_t kExact = 256;

  // `value` >= 0, infinity included.
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

  // The least value that a share of all, in (0, 1], does not exceed (the nearest-rank definition);
  // 0 without values. Exact up to kExact values beside 0; of more at most 1.6 % above the true one,
  // never below. Values under 1e-19 count as that, values over 1e19 as infinite.
  double percentile(double share) const;

 private:
  // The exponent and the first bits of the mantissa: a number for each bin, rising with the value.
  // Taken from the bits, so that the same value falls into the same bin on every machine.
  static std::uint64_t bin_of(double value) { return std::bit_cast<std::uint64_t>(value) >> 46; }

  void add_positive(double value);
  void empty_few();
  void count_in_bins(double value);
  void make_room(std::uint64_t bin);

  std::int64_t zeros_ = 0;
  std::int64_t positive_ = 0;
  std::int64_t beyond_ = 0;         // too large for the bins
  std::vector<double> few_;         // those there are, while they are few
  std::uint64_t first_bin_ = 0;     // where bins_ begin
  std::vector<std::int64_t> bins_;  // only octaves between those that occur
};

}  // namespace krok::compare
