#pragma once

#include <limits>

// Values that damaged files hold and careless sums end in.

namespace krok::test {

inline constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
inline constexpr double kInfinity = std::numeric_limits<double>::infinity();
inline constexpr float kNanF = std::numeric_limits<float>::quiet_NaN();
inline constexpr float kInfinityF = std::numeric_limits<float>::infinity();

}  // namespace krok::test
