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

// The meaning of one number of a row.
struct Channel {
  ChannelKind kind = ChannelKind::ignored;
  Axis axis = Axis::x;
  int joint = 0;
};

// The HIERARCHY section in the file's unit and axes. Joints are in file order, including End Sites,
// parents first; exactly one root (several roots get a common parent).
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
  std::vector<Channel> channels;   // in the order of the values of a row
  std::size_t end = 0;             // the byte after the word MOTION
  bool no_motion = false;          // a skeleton: the file ends after the hierarchy
  double degrees_per_angle = 1.0;  // unit of the rotation channels

  // "LeftToe.Yrotation".
  std::string channel_name(std::size_t channel) const;
};

// Parses the beginning of `text`; warnings are added to `diagnostics`. Nesting depth is limited
// only by the number of joints.
Result<Hierarchy> parse_hierarchy(std::string_view text, const std::string& file_name,
                                  const ReadOptions& options, Diagnostics& diagnostics);

}  // namespace krok::bvh
