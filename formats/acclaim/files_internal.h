#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "core/result.h"
#include "formats/acclaim/acclaim_reader.h"
#include "formats/acclaim/source_text_internal.h"
#include "math/quaternion.h"
#include "math/transform.h"

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

// A bone of :bonedata, before its parent is known.
struct LooseBone {
  std::string_view name;  // as in the file
  std::size_t offset = 0;
  SkeletonFile::Joint joint;
};

// A child named on a line of :hierarchy.
struct HierarchyLink {
  std::string_view parent, child;
  std::size_t parent_offset = 0, child_offset = 0;
};

// Attaches the bones to the root, which is already in `skeleton`: fills its joints (depth first,
// with unique UTF-8 names) and its name maps. Bones not connected to the root are dropped with a
// warning.
Status hang_bones(std::vector<LooseBone>& bones, const std::vector<HierarchyLink>& links,
                  SourceText& source, SkeletonFile& skeleton);

// Whether a token is a section keyword, which ends the previous section.
inline bool is_section(const Token& token) {
  return token.starts_line && token.text.starts_with(':');
}

// The orientation of `axis` and `orientation`: angles about x, y and z, always stored in that
// order, and the order in which they are applied.
struct PrintedAxes {
  Vec3 angles = Vec3::Zero();
  EulerOrder order = {Axis::x, Axis::y, Axis::z};

  Quat rotation(double radians) const;
};

// Parses the elements of ASF sections at `cursor`. `what` and `whose` are for messages. Both
// constructor arguments must outlive this.
class ItemParser {
 public:
  ItemParser(SourceText& source, TokenCursor& cursor) : source_(source), cursor_(cursor) {}

  Result<double> number(const std::string& what);
  Status vector(const std::string& what, Vec3& vector);

  // The channels of `dof` or `order`, to the end of the line.
  Status channels(std::vector<Channel>& channels, const std::string& whose);

  // The word after the three angles of an axis, which some exporters omit.
  Status axis_order(const std::string& whose, EulerOrder& order);

  // Skips an unknown line with a warning; it may be a vendor extension.
  Status skip_unknown(const Token& token);

 private:
  SourceText& source_;
  TokenCursor& cursor_;
};

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
