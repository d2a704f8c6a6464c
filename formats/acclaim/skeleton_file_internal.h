#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "core/result.h"
#include "formats/acclaim/acclaim_reader.h"
#include "formats/acclaim/source_text_internal.h"
#include "math/euler.h"
#include "math/types.h"

namespace krok::acclaim {

// One value of a joint in an AMC.
enum class Channel : std::uint8_t { tx, ty, tz, rx, ry, rz, length };

inline bool is_rotation(Channel c) {
  return c >= Channel::rx && c <= Channel::rz;
}
inline bool is_translation(Channel c) {
  return c <= Channel::tz;
}
// 0, 1, 2 for the channels of x, y, z.
inline int axis_index(Channel c) {
  return static_cast<int>(c) % 3;
}

// "rx".
std::string_view channel_name(Channel channel);

// An ASF, lengths in the file's unit, angles in radians. Joint 0 is the root; its descendants
// follow depth first, parents before children.
struct SkeletonFile {
  struct Limit {
    double lower = -std::numeric_limits<double>::infinity();
    double upper = std::numeric_limits<double>::infinity();
  };
  struct Joint {
    std::string name;  // unique, UTF-8
    int parent = -1;
    Vec3 direction = Vec3::Zero();  // unit, or zero for the root and if zero in the file
    double length = 0;
    Quat axes = Quat::Identity();
    std::vector<Channel> channels;
    std::vector<Limit> limits;  // empty or one per channel; rotations in radians
    bool has_children = false;
  };
  std::vector<Joint> joints;

  Vec3 root_position = Vec3::Zero();
  Quat root_orientation = Quat::Identity();

  std::string name, documentation;
  std::optional<double> length_unit;  // the length of :units
  bool degrees = true;

  // Finds a bone by its name in an AMC: an exact match, or else a case-insensitive one.
  static constexpr int kUnknown = -1;
  static constexpr int kLeftOut = -2;  // a bone that is not connected to the root
  int find(std::string_view name) const;

  std::unordered_map<std::string, int> by_name;        // as in the file, bytes
  std::unordered_map<std::string, int> by_lower_name;  // ambiguous names are kUnknown
};

// Parses an ASF. Sections may be in any order; hierarchy depth is limited only by the number of
// joints.
Result<SkeletonFile> parse_skeleton(SourceText& source, const ReadOptions& options);

}  // namespace krok::acclaim
