#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/result.h"
#include "formats/acclaim/acclaim_reader.h"
#include "formats/acclaim/skeleton_file_internal.h"
#include "formats/acclaim/source_text_internal.h"

namespace krok::acclaim {

// An AMC: the values of all channels in all frames, in the file's units, in the order of the
// skeleton's joints and their channels.
struct MotionFile {
  std::size_t channel_count = 0;
  std::vector<double> values;            // [frames x channels]
  std::vector<long long> frame_numbers;  // [frames], as printed
  std::optional<double> rate;            // from the file
  std::optional<bool> degrees;           // from the file
  std::vector<std::string> repairs;

  std::size_t frame_count() const { return frame_numbers.size(); }
  std::span<const double> frame(std::size_t i) const {
    return std::span(values).subspan(i * channel_count, channel_count);
  }
};

// Max number of frames with `channels` and `joints` for which memory may be allocated, from the
// size of the text.
std::size_t most_frames(std::size_t text_size, std::size_t channels, std::size_t joints,
                        const ReadOptions& options);

// Parses an AMC in one pass. `joint_count` is that of the clip, for the memory limit.
Result<MotionFile> parse_motion(SourceText& source, const SkeletonFile& skeleton,
                                std::size_t joint_count, const ReadOptions& options);

}  // namespace krok::acclaim
