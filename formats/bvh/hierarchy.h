#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "core/result.h"
#include "formats/bvh/bvh_reader.h"
#include "math/euler.h"

namespace krok::bvh {

enum class ChannelKind : std::uint8_t { position, rotation, ignored };

// One number of a row: which part of which joint it moves.
struct Channel {
  ChannelKind kind = ChannelKind::ignored;
  Axis axis = Axis::x;
  int joint = 0;
};

// What stands between HIERARCHY and MOTION, in the file's unit and axes. Joints in the file's
// order, End Sites among them, parents first; exactly one root (several get a common parent).
struct Hierarchy {
  struct Joint {
    std::string name;  // unique, UTF-8
    int parent = -1;
    bool end_site = false;
    Vec3 offset = Vec3::Zero();
    std::size_t first_channel = 0;
    std::size_t channel_count = 0;
  };
  std::vector<Joint> joints;
  std::vector<Channel> channels;   // in the order of a row's values
  std::size_t end = 0;             // the byte after the word MOTION
  double degrees_per_angle = 1.0;  // the unit of the rotation channels' values

  // "LeftToe.Yrotation".
  std::string channel_name(std::size_t channel) const;
};

// Parses the beginning of `text`; what is odd goes to `diagnostics`. Nesting may be as deep as the
// limit on joints allows.
Result<Hierarchy> parse_hierarchy(std::string_view text, const std::string& file_name,
                                  const ReadOptions& options, Diagnostics& diagnostics);

}  // namespace krok::bvh
