// If these fail, percentiles of differences are wrong, or depend on the number of threads.

#include "compare/measure.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

namespace krok::compare {
namespace {

// By the definition: sorted, the value at rank ceil(share * n).
double nearest_rank(std::vector<double> values, double share) {
  std::sort(values.begin(), values.end());
  const auto rank = static_cast<std::size_t>(std::ceil(share * static_cast<double>(values.size())));
  return values[std::max<std::size_t>(rank, 1) - 1];
}

std::vector<double> log_normal(std::size_t count, double zeros, unsigned seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> exponent(-8, 3);
  std::uniform_real_distribution<double> uniform(0, 1);
  std::vector<double> values;
  for (std::size_t i = 0; i < count; ++i) {
    values.push_back(uniform(random) < zeros ? 0.0 : std::exp(exponent(random)));
  }
  return values;
}

Spread spread_of(const std::vector<double>& values) {
  Spread spread;
  for (const double value : values) spread.add(value);
  return spread;
}

TEST(Spread, IsExactForAFew) {
  const auto values = log_normal(Spread::kExact, 0.2, 1);
  const Spread spread = spread_of(values);
  for (const double share : {0.001, 0.05, 0.2, 0.5, 0.95, 0.99, 1.0}) {
    EXPECT_EQ(spread.percentile(share), nearest_rank(values, share)) << share;
  }
}

TEST(Spread, IsNeverBelowAndAtMost16PerMilleAboveForMany) {
  for (const unsigned seed : {2u, 3u, 4u}) {
    const auto values = log_normal(50'000, 0.3, seed);
    const Spread spread = spread_of(values);
    for (const double share : {0.01, 0.29, 0.5, 0.9, 0.95, 0.999, 1.0}) {
      const double exact = nearest_rank(values, share);
      EXPECT_GE(spread.percentile(share), exact) << share;
      EXPECT_LE(spread.percentile(share), exact * 1.016) << share;
    }
  }
}

TEST(Spread, DoesNotDependOnHowValuesWereSharedOut) {
  for (const std::size_t count : {100u, 255u, 256u, 257u, 600u, 5000u}) {
    const auto values = log_normal(count, 0.1, 5);
    const Spread whole = spread_of(values);
    for (const std::size_t parts : {2u, 3u, 7u}) {
      std::vector<Spread> shares(parts);
      for (std::size_t i = 0; i < values.size(); ++i) shares[(i * i) % parts].add(values[i]);
      Spread merged;
      for (std::size_t i = parts; i-- > 0;) merged.merge(shares[i]);
      EXPECT_EQ(merged.count(), whole.count());
      for (const double share : {0.05, 0.5, 0.95, 1.0}) {
        EXPECT_EQ(merged.percentile(share), whole.percentile(share)) << count << " " << parts;
      }
    }
  }
}

TEST(Spread, HasAnAnswerAtTheEnds) {
  EXPECT_EQ(Spread().percentile(0.95), 0);
  EXPECT_EQ(spread_of({0, 0, 0}).percentile(1), 0);
  std::vector<double> values(1000, std::numeric_limits<double>::infinity());
  EXPECT_EQ(spread_of(values).percentile(0.5), std::numeric_limits<double>::infinity());
  values.assign(1000, 1e-300);
  EXPECT_GT(spread_of(values).percentile(0.5), 0);
  EXPECT_LT(spread_of(values).percentile(0.5), 1e-18);
  values.assign(1000, 1.0);
  values.push_back(std::numeric_limits<double>::denorm_min());
  values.push_back(std::numeric_limits<double>::max());
  EXPECT_NEAR(spread_of(values).percentile(0.5), 1.0, 0.016);
}

}  // namespace
}  // namespace krok::compare
