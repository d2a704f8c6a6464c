#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace krok::bvh {

// The frame rate inferred from a printed frame time.
struct PrintedRate {
  double rate = 0;          // frames per second
  bool snapped = false;     // not 1 / frame time as printed
  bool few_digits = false;  // the digits also fit rates half a percent or more away
  bool also_ntsc = false;   // the digits also fit the NTSC rate beside it
  bool unusual = false;     // below 4 or above 1000 fps; see the reason
  std::string reason;
};

// The nearest common rate whose frame time agrees with the number in all printed digits (trailing
// zeros do not count): a whole rate (24, 25, 30, 48, 50, 60, 90, 100, 120, 240), else an NTSC rate
// (24, 30, 48, 60, 120 and 240 / 1.001); else the only rate up to 1000 with no decimals, or with
// two or three, that agrees; else 1 / frame time. A whole rate that the number gives exactly wins
// over a common one more than half a percent away. `text` is the number as printed, `frame_time`
// its value, > 0.
PrintedRate rate_of_frame_time(std::string_view text, double frame_time);

}  // namespace krok::bvh
