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

// Rates are positive and finite. Two rates are the same if they agree within 1e-6, or if none of
// the frames that both have is parted by more than `same_time` (seconds).
FrameMatch match_frames(int first_frames, double first_rate, int second_frames, double second_rate,
                        double same_time = 0);

}  // namespace krok::compare
