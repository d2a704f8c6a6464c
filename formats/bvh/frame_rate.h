#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace krok::bvh {

// The rate that a printed frame time stands for.
struct PrintedRate {
  double rate = 0;          // frames a second
  bool snapped = false;     // not 1 / frame time as printed
  bool few_digits = false;  // the digits leave room for rates half a percent or more apart
  bool unusual = false;  // below 4 or above 1000, where no capture was made; the reason says more
  std::string reason;
};

// The nearest common rate whose frame time agrees with the number to the digits that are printed
// (zeros at the end do not count): a whole one (24, 25, 30, 48, 50, 60, 90, 100, 120, 240), or else
// NTSC's (24, 30, 48, 60, 120 and 240 / 1.001); or else the only rate up to 1000 without decimals,
// or with two or three, that does, or else 1 / frame time. A whole rate that the number gives
// exactly stands against a common one more than half a percent away. `text` is the number as
// printed, `frame_time` its value, > 0.
PrintedRate rate_of_frame_time(std::string_view text, double frame_time);

}  // namespace krok::bvh
