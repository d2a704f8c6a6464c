#include "formats/acclaim/skeleton_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/numbers.h"
#include "core/text_reading.h"
#include "formats/acclaim/bone_tree.h"
#include "math/quaternion.h"

namespace krok::acclaim {

namespace {

constexpr std::array<std::string_view, 7> kChannelNames = {"tx", "ty", "tz", "rx", "ry", "rz", "l"};

std::optional<Channel> parse_channel(std::string_view word) {
  for (std::size_t i = 0; i < kChannelNames.size(); ++i) {
    if (same_word(word, kChannelNames[i])) return static_cast<Channel>(i);
  }
  return std::nullopt;
}

// "XYZ": three different axes, the first turned about first.
std::optional<EulerOrder> parse_order(std::string_view word) {
  EulerOrder order{};
  if (word.size() != order.size()) return std::nullopt;
  std::array<bool, 3> seen{};
  for (std::size_t i = 0; i < order.size(); ++i) {
    const int axis = ascii_lower(word[i]) - 'x';
    if (axis < 0 || axis > 2 || seen[static_cast<std::size_t>(axis)]) return std::nullopt;
    seen[static_cast<std::size_t>(axis)] = true;
    order[i] = static_cast<Axis>(axis);
  }
  return order;
}

std::optional<double> parse_limit(std::string_view word) {
  std::string_view plain = word;
  const bool negative = plain.starts_with('-');
  if (negative || plain.starts_with('+')) plain.remove_prefix(1);
  if (same_word(plain, "inf") || same_word(plain, "infinity")) {
    const double infinity = std::numeric_limits<double>::infinity();
    return negative ? -infinity : infinity;
  }
  return parse_finite(word);
}

bool is_section(const Token& token) {
  return token.starts_line && token.text.starts_with(':');
}

constexpr EulerOrder kXyz = {Axis::x, Axis::y, Axis::z};

// An orientation as `axis` and `orientation` have it: angles about x, y and z, whatever the order
// in which they are turned about.
struct PrintedAxes {
  Vec3 angles = Vec3::Zero();
  EulerOrder order = kXyz;

  Quat rotation(double radians) const {
    Quat q = Quat::Identity();
    for (const Axis axis : order) {
      q = axis_rotation(axis, angles[static_cast<int>(axis)] * radians) * q;
    }
    return normalized_or_identity(q);
  }
};

class SkeletonParser {
 public:
  SkeletonParser(SourceText& source, const ReadOptions& options)
      : source_(source), options_(options), cursor_(source.text()) {}

  Result<SkeletonFile> parse() {
    SkeletonFile::Joint root;
    root.name = "root";
    result_.joints.push_back(std::move(root));
    for (Token token = cursor_.next(); !token.end(); token = cursor_.next()) {
      if (Status done = parse_section(token); !done) return done.error();
    }
    if (Status whole = check_whole(); !whole) return whole.error();
    const double radians = result_.degrees ? kRadiansPerDegree : 1.0;
    result_.root_orientation = root_axes_.rotation(radians);
    for (std::size_t i = 0; i < bones_.size(); ++i) {
      SkeletonFile::Joint& joint = bones_[i].joint;
      joint.axes = axes_[i].rotation(radians);
      for (std::size_t k = 0; k < joint.limits.size(); ++k) {
        if (!is_rotation(joint.channels[k])) continue;
        joint.limits[k].lower *= radians;
        joint.limits[k].upper *= radians;
      }
    }
    if (Status hung = hang_bones(bones_, links_, source_, result_); !hung) return hung.error();
    return std::move(result_);
  }

 private:
  Status check_whole() {
    const std::size_t end = source_.text().size();
    constexpr const char* kCut = "the file is cut short, or is no ASF; export or copy it again";
    if (bones_.empty()) return source_.error(end, "acclaim-syntax", "there are no bones", kCut);
    if (!has_hierarchy_) {
      return source_.error(end, "acclaim-syntax", "there is no :hierarchy", kCut);
    }
    std::vector<Channel>& order = result_.joints[0].channels;
    if (!order.empty()) return {};
    using enum Channel;
    order = {tx, ty, tz, rx, ry, rz};
    return source_.fault(has_root_ ? root_offset_ : end, "acclaim-root",
                         has_root_ ? ":root has no order, taken as TX TY TZ RX RY RZ"
                                   : "there is no :root; its order is taken as TX TY TZ RX RY RZ");
  }

  Status parse_section(const Token& token) {
    if (!is_section(token)) {
      return source_.error(
          token.offset, "acclaim-syntax",
          fmt::format("'{}' where a section such as :root is expected", shown(token.text)));
    }
    const std::string keyword = ascii_lower(token.text);
    if (keyword == ":version") return parse_version();
    if (keyword == ":name") {
      result_.name = to_utf8(cursor_.rest_of_line());
      return {};
    }
    if (keyword == ":units") return parse_units();
    if (keyword == ":documentation") return parse_documentation();
    if (keyword == ":root") return parse_root(token.offset);
    if (keyword == ":bonedata") return parse_bones();
    if (keyword == ":hierarchy") return parse_hierarchy(token.offset);
    if (keyword != ":skin") {
      if (Status told = source_.fault(
              token.offset, "acclaim-keyword",
              fmt::format("the section {} is unknown and left out", shown(token.text)));
          !told) {
        return told;
      }
    }
    skip_section();
    return {};
  }

  void skip_section() {
    for (Token token = cursor_.peek(); !token.end() && !is_section(token); token = cursor_.peek()) {
      cursor_.next();
      cursor_.skip_line();
    }
  }

  // Lines that a section does not know may be a vendor's own.
  Status skip_unknown(const Token& token) {
    cursor_.skip_line();
    return source_.fault(token.offset, "acclaim-keyword",
                         fmt::format("'{}' is unknown, its line is left out", shown(token.text)));
  }

  Result<double> number(const std::string& what) {
    const Token token = cursor_.next();
    const auto value = parse_finite(token.text);
    if (value) return *value;
    return source_.error(
        token.offset, "acclaim-number",
        token.end() ? fmt::format("the file ends in the {}", what)
                    : fmt::format("'{}' in the {} is not a finite number", shown(token.text), what),
        token.end() ? "the file is cut short; export or copy it again" : "");
  }

  Status vector(const std::string& what, Vec3& vector) {
    for (int axis = 0; axis < 3; ++axis) {
      const auto value = number(what);
      if (!value) return value.error();
      vector[axis] = *value;
    }
    return {};
  }

  Status parse_version() {
    const Token token = cursor_.peek();
    const auto version = number("version");
    if (!version) return version.error();
    if (*version < 1.0 || *version >= 2.0) {
      return source_.fault(token.offset, "acclaim-keyword",
                           fmt::format("version {} is read as 1.10", shown(token.text)));
    }
    return {};
  }

  Status parse_units() {
    for (Token token = cursor_.peek(); !token.end() && !is_section(token); token = cursor_.peek()) {
      cursor_.next();
      const std::string unit = ascii_lower(token.text);
      const Token value = cursor_.peek();
      if (unit == "angle") {
        cursor_.next();
        const std::string angle = ascii_lower(value.text);
        result_.degrees = angle.starts_with("deg");
        if (!result_.degrees && !angle.starts_with("rad")) {
          return source_.error(value.offset, "acclaim-syntax",
                               fmt::format("'{}' is no unit of angles", shown(value.text)),
                               "write deg or rad");
        }
      } else if (unit == "length" || unit == "mass") {
        const auto factor = number("unit of " + unit);
        if (!factor) return factor.error();
        if (*factor <= 0) {
          return source_.error(
              value.offset, "acclaim-number",
              fmt::format("a unit of {} of {} is not positive", unit, shown(value.text)));
        }
        if (unit == "length") result_.length_unit = *factor;
      } else if (Status told = skip_unknown(token); !told) {
        return told;
      }
    }
    return {};
  }

  Status parse_documentation() {
    cursor_.skip_line();
    std::string& text = result_.documentation;
    // Free text: a word at the beginning of a line that begins with ':' ends it.
    for (Token token = cursor_.peek(); !token.end() && !is_section(token); token = cursor_.peek()) {
      cursor_.next();
      if (!text.empty()) text += '\n';
      text += to_utf8(token.text);
      const std::string_view rest = cursor_.rest_of_line();
      if (!rest.empty()) text += ' ' + to_utf8(rest);
    }
    return {};
  }

  Status parse_root(std::size_t offset) {
    has_root_ = true;
    root_offset_ = offset;
    for (Token token = cursor_.peek(); !token.end() && !is_section(token); token = cursor_.peek()) {
      cursor_.next();
      const std::string key = ascii_lower(token.text);
      Status done;
      if (key == "order") {
        result_.joints[0].channels.clear();
        done = parse_channels(result_.joints[0].channels, "the root");
      } else if (key == "axis") {
        done = parse_axis_order("root", root_axes_.order);
      } else if (key == "position") {
        done = vector("position of the root", result_.root_position);
      } else if (key == "orientation") {
        done = vector("orientation of the root", root_axes_.angles);
      } else {
        done = skip_unknown(token);
      }
      if (!done) return done;
    }
    const bool moved = !result_.root_position.isZero(0) || !root_axes_.angles.isZero(0);
    if (!moved) return {};
    return source_.fault(offset, "acclaim-root",
                         "the root has a position or orientation of its own, which is put before "
                         "the whole motion; programs differ in this");
  }

  Status parse_channels(std::vector<Channel>& channels, const std::string& whose) {
    for (Token token = cursor_.peek(); !token.end() && !token.starts_line; token = cursor_.peek()) {
      cursor_.next();
      const auto channel = parse_channel(token.text);
      if (!channel) {
        return source_.error(
            token.offset, "acclaim-dof",
            fmt::format("'{}' is no degree of freedom (of {})", shown(token.text), whose),
            "they are tx ty tz rx ry rz l");
      }
      if (std::find(channels.begin(), channels.end(), *channel) != channels.end()) {
        return source_.error(token.offset, "acclaim-dof",
                             fmt::format("{} has {} twice", whose, channel_name(*channel)));
      }
      channels.push_back(*channel);
    }
    return {};
  }

  // The word after the three angles, which some exporters leave out.
  Status parse_axis_order(const std::string& whose, EulerOrder& order) {
    const Token token = cursor_.peek();
    if (token.end() || token.starts_line) {
      return source_.fault(token.offset, "acclaim-syntax",
                           fmt::format("the axis of {} has no order, taken as XYZ", whose));
    }
    cursor_.next();
    const auto parsed = parse_order(token.text);
    if (!parsed) {
      return source_.error(
          token.offset, "acclaim-syntax",
          fmt::format("'{}' is no order of axes (of {})", shown(token.text), whose),
          "write XYZ or another order of the three letters");
    }
    order = *parsed;
    return {};
  }

  Status parse_bones() {
    for (Token token = cursor_.peek(); !token.end() && !is_section(token); token = cursor_.peek()) {
      cursor_.next();
      if (!same_word(token.text, "begin")) {
        return source_.error(
            token.offset, "acclaim-syntax",
            fmt::format("'{}' where the begin of a bone is expected", shown(token.text)));
      }
      if (static_cast<int>(bones_.size()) + 1 >= options_.max_joints) {
        return source_.error(token.offset, "acclaim-limit",
                             fmt::format("more than {} joints", options_.max_joints));
      }
      if (Status done = parse_bone(token.offset); !done) return done;
    }
    return {};
  }

  struct Seen {
    bool direction = false, length = false, axis = false;
  };

  Status parse_bone(std::size_t begin) {
    LooseBone bone;
    bone.offset = begin;
    PrintedAxes axes;
    Seen seen;
    for (;;) {
      const Token token = cursor_.next();
      if (token.end() || is_section(token) || same_word(token.text, "begin")) {
        return source_.error(token.offset, "acclaim-syntax",
                             fmt::format("the end of {} is missing", called(bone)),
                             token.end() ? "the file is cut short; export or copy it again" : "");
      }
      if (same_word(token.text, "end")) break;
      if (Status done = parse_bone_item(token, bone, axes, seen); !done) return done;
    }
    if (Status whole = check_bone(bone, seen); !whole) return whole;
    bones_.push_back(std::move(bone));
    axes_.push_back(axes);
    return {};
  }

  static std::string called(const LooseBone& bone) {
    return bone.name.empty() ? "a bone without a name" : "the bone " + shown(bone.name);
  }

  Status parse_bone_item(const Token& token, LooseBone& bone, PrintedAxes& axes, Seen& seen) {
    const std::string key = ascii_lower(token.text);
    const std::string whose = called(bone);
    if (key == "id" || key == "bodymass" || key == "cofmass") {
      cursor_.skip_line();
      return {};
    }
    if (key == "name") {
      const Token name = cursor_.peek();
      if (name.end() || name.starts_line) return {};  // nameless: check_bone() tells
      cursor_.next();
      bone.name = name.text;
      bone.offset = name.offset;
      return {};
    }
    if (key == "direction") {
      seen.direction = true;
      return vector("direction of " + whose, bone.joint.direction);
    }
    if (key == "length") {
      seen.length = true;
      const auto length = number("length of " + whose);
      if (!length) return length.error();
      bone.joint.length = *length;
      return {};
    }
    if (key == "axis") {
      seen.axis = true;
      if (Status angles = vector("axis of " + whose, axes.angles); !angles) return angles;
      return parse_axis_order(whose, axes.order);
    }
    if (key == "dof") {
      bone.joint.channels.clear();
      return parse_channels(bone.joint.channels, whose);
    }
    if (key == "limits") return parse_limits(token.offset, bone);
    return skip_unknown(token);
  }

  Status parse_limits(std::size_t offset, LooseBone& bone) {
    std::vector<double> values;
    for (Token token = cursor_.peek(); !token.end(); token = cursor_.peek()) {
      const auto value = parse_limit(token.text);
      if (!value) break;
      cursor_.next();
      values.push_back(*value);
    }
    const std::size_t expected = 2 * bone.joint.channels.size();
    if (values.size() != expected) {
      return source_.fault(offset, "acclaim-limits",
                           fmt::format("{} numbers for the limits of {}, expected {}; they are "
                                       "left out",
                                       values.size(), called(bone), expected),
                           {}, to_utf8(bone.name));
    }
    bone.joint.limits.clear();
    for (std::size_t i = 0; i < expected; i += 2) {
      bone.joint.limits.push_back({values[i], values[i + 1]});
    }
    return {};
  }

  Status check_bone(LooseBone& bone, const Seen& seen) {
    const auto refuse = [&](const std::string& what) {
      return source_.error(bone.offset, "acclaim-bone",
                           fmt::format("{} has no {}", called(bone), what));
    };
    if (bone.name.empty()) {
      return source_.error(bone.offset, "acclaim-bone", "a bone has no name",
                           ":hierarchy and the motion know bones by their names");
    }
    if (!seen.direction) return refuse("direction");
    if (!seen.length) return refuse("length");
    if (!seen.axis && !bone.joint.channels.empty()) return refuse("axis, but degrees of freedom");
    if (bone.joint.limits.size() != bone.joint.channels.size()) bone.joint.limits.clear();
    const std::string joint = to_utf8(bone.name);
    // Printed with six digits as a rule.
    constexpr double kRounding = 1e-3;
    Vec3& direction = bone.joint.direction;
    const double norm = direction.stableNorm();
    if (std::abs(norm - 1.0) > kRounding && bone.joint.length != 0) {
      const char* taken = norm > 0 ? "only its direction counts" : "the bone has no length then";
      if (Status told =
              source_.fault(bone.offset, "acclaim-bone",
                            fmt::format("the direction of {} has length {}, expected 1; {}",
                                        shown(bone.name), readable(norm, 4), taken),
                            {}, joint);
          !told) {
        return told;
      }
    }
    direction = norm > 0 && std::isfinite(norm) ? Vec3(direction / norm) : Vec3::Zero();
    if (bone.joint.length >= 0) return {};
    return source_.fault(bone.offset, "acclaim-bone",
                         fmt::format("the length of {} is negative: the bone points the other way",
                                     shown(bone.name)),
                         {}, joint);
  }

  Status parse_hierarchy(std::size_t offset) {
    if (has_hierarchy_) return source_.error(offset, "acclaim-syntax", "a second :hierarchy");
    has_hierarchy_ = true;
    Token token = cursor_.next();
    if (!same_word(token.text, "begin")) {
      return source_.error(token.offset, "acclaim-syntax", "a begin is expected after :hierarchy");
    }
    Token parent;
    for (token = cursor_.next(); !token.end() && !is_section(token); token = cursor_.next()) {
      if (token.starts_line && same_word(token.text, "end")) return {};
      if (token.starts_line || parent.end()) {
        parent = token;
      } else {
        links_.push_back({parent.text, token.text, parent.offset, token.offset});
      }
    }
    return source_.error(token.offset, "acclaim-syntax", "the end of :hierarchy is missing",
                         token.end() ? "the file is cut short; export or copy it again" : "");
  }

  SourceText& source_;
  const ReadOptions& options_;
  TokenCursor cursor_;
  SkeletonFile result_;
  std::vector<LooseBone> bones_;
  std::vector<PrintedAxes> axes_;  // of bones_
  std::vector<HierarchyLink> links_;
  PrintedAxes root_axes_;
  std::size_t root_offset_ = 0;
  bool has_root_ = false, has_hierarchy_ = false;
};

}  // namespace

std::string_view channel_name(Channel channel) {
  return kChannelNames[static_cast<std::size_t>(channel)];
}

Result<SkeletonFile> parse_skeleton(SourceText& source, const ReadOptions& options) {
  return SkeletonParser(source, options).parse();
}

}  // namespace krok::acclaim
