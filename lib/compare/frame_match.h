#pragma once

#include <string>
#include <utility>
#include <vector>

namespace krok::compare {

// Which evenly spaced frames of two recordings belong together; see ClipDifference.
struct FrameMatch {
  std::vector<std::pair<int, int>> frames;  // of the first, of the second
  std::vector<std::string> differences;     // sentences for people
};

// Rates are positive and finite.
FrameMatch match_frames(int first_frames, double first_rate, int second_frames, double second_rate);

}  // namespace krok::compare
