#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/result.h"
#include "formats/bvh/bvh_reader.h"
#include "math/quaternion.h"

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

// What follows once all joints of a hierarchy are parsed.

// An error if no channel is known: the character would not move, with no message. The error has no
// location. A note if there are no positions.
Status check_channels(const Hierarchy& hierarchy, const std::string& file_name,
                      Diagnostics& diagnostics);

// A skeleton has one root: several roots get a static parent at the origin.
void join_roots(Hierarchy& hierarchy, std::vector<std::size_t>& name_places,
                const std::string& file_name, Diagnostics& diagnostics);

// Makes all joint names unique, non-empty and UTF-8. Duplicates get a suffix "_2", "_3", ...; End
// Sites become <parent>_end; a nameless joint becomes "joint". Names that are not UTF-8 are read as
// Latin-1. Each changed name is a warning, except for End Sites. `name_places` has the offset of
// each joint's name in the text, shape [joints].
void name_joints(Hierarchy& hierarchy, std::span<const std::size_t> name_places,
                 std::string_view text, const std::string& file_name, Diagnostics& diagnostics);

void report_zero_bones(const Hierarchy& hierarchy, const std::string& file_name,
                       Diagnostics& diagnostics);

// Warns (bvh-end-site) of end sites further from their joint than half of the size of a body of 15
// joints or more: bodies and pictures then have a hand that long, or none.
void report_long_ends(const Hierarchy& hierarchy, const std::string& file_name,
                      Diagnostics& diagnostics);

// A diagnostic about the whole file.
void report_in_file(Severity severity, std::string code, std::string message,
                    const std::string& file_name, Diagnostics& diagnostics);

// For messages: shown(name), or a description if the name is empty.
std::string readable_name(std::string_view name);

}  // namespace krok::bvh
