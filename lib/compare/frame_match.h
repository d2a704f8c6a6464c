#pragma once

#include <string>
#include <utility>
#include <vector>

namespace krok::compare {

// Which evenly spaced frames of two recordings correspond; see ClipDifference.
struct FrameMatch {
  std::vector<std::pair<int, int>> frames;  // of the first, of the second
  std::vector<std::string> differences;     // readable sentences
};

// Rates are positive and finite. Rates are equal if they agree within 1e-6, or if no common frame
// differs in time by more than `same_time` (seconds).
FrameMatch match_frames(int first_frames, double first_rate, int second_frames, double second_rate,
                        double same_time = 0);

}  // namespace krok::compare
