#include "formats/acclaim/files_internal.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "core/numbers.h"
#include "core/result.h"
#include "core/text.h"
#include "formats/acclaim/source_text_internal.h"

namespace krok::acclaim {

namespace {

// A bone with axes and limits in the file's angle unit, which may be defined later in the file.
struct PrintedBone : LooseBone {
  PrintedAxes axes;
};

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

class BoneParser {
 public:
  BoneParser(SourceText& source, TokenCursor& cursor, const ReadOptions& options,
             std::vector<PrintedBone>& bones)
      : source_(source),
        cursor_(cursor),
        items_(source, cursor),
        options_(options),
        bones_(bones) {}

  Status parse() {
    for (Token token = cursor_.peek(); !token.end() && !is_section(token); token = cursor_.peek()) {
      cursor_.next();
      if (!same_word(token.text, "begin")) {
        return source_.error(
            token.offset, "acclaim-syntax",
            fmt::format("'{}' where 'begin' of a bone is expected", shown(token.text)));
      }
      if (static_cast<int>(bones_.size()) + 1 >= options_.max_joints) {
        return source_.error(token.offset, "acclaim-limit",
                             fmt::format("more than {} joints", options_.max_joints));
      }
      if (Status status = parse_bone(token.offset); !status) return status;
    }
    return {};
  }

 private:
  struct Seen {
    bool direction = false, length = false, axis = false;
  };

  Status parse_bone(std::size_t begin) {
    PrintedBone bone;
    bone.offset = begin;
    PrintedAxes axes;
    Seen seen;
    for (;;) {
      const Token token = cursor_.next();
      if (token.end() || is_section(token) || same_word(token.text, "begin")) {
        return source_.error(token.offset, "acclaim-syntax",
                             fmt::format("'end' of {} is missing", called(bone)),
                             token.end() ? "the file is truncated; export or copy it again" : "");
      }
      if (same_word(token.text, "end")) break;
      if (Status status = parse_bone_item(token, bone, axes, seen); !status) return status;
    }
    if (Status status = check_bone(bone, seen); !status) return status;
    bone.axes = axes;
    bones_.push_back(std::move(bone));
    return {};
  }

  static std::string called(const PrintedBone& bone) {
    return bone.name.empty() ? "a bone without a name" : "the bone " + shown(bone.name);
  }

  Status parse_bone_item(const Token& token, PrintedBone& bone, PrintedAxes& axes, Seen& seen) {
    const std::string key = ascii_lower(token.text);
    const std::string whose = called(bone);
    if (key == "id" || key == "bodymass" || key == "cofmass") {
      cursor_.skip_line();
      return {};
    }
    if (key == "name") {
      const Token name = cursor_.peek();
      if (name.end() || name.starts_line) return {};  // nameless: check_bone() reports it
      cursor_.next();
      bone.name = name.text;
      bone.offset = name.offset;
      return {};
    }
    if (key == "direction") {
      seen.direction = true;
      return items_.vector("direction of " + whose, bone.joint.direction);
    }
    if (key == "length") {
      seen.length = true;
      const auto length = items_.number("length of " + whose);
      if (!length) return length.error();
      bone.joint.length = *length;
      return {};
    }
    if (key == "axis") {
      seen.axis = true;
      if (Status status = items_.vector("axis of " + whose, axes.angles); !status) return status;
      return items_.axis_order(whose, axes.order);
    }
    if (key == "dof") {
      bone.joint.channels.clear();
      return items_.channels(bone.joint.channels, whose);
    }
    if (key == "limits") return parse_limits(token.offset, bone);
    return items_.skip_unknown(token);
  }

  Status parse_limits(std::size_t offset, PrintedBone& bone) {
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
                                       "ignored",
                                       values.size(), called(bone), expected),
                           {}, to_utf8(bone.name));
    }
    bone.joint.limits.clear();
    for (std::size_t i = 0; i < expected; i += 2) {
      bone.joint.limits.push_back({values[i], values[i + 1]});
    }
    return {};
  }

  Status check_bone(PrintedBone& bone, const Seen& seen) {
    const auto refuse = [&](const std::string& what) {
      return source_.error(bone.offset, "acclaim-bone",
                           fmt::format("{} has no {}", called(bone), what));
    };
    if (bone.name.empty()) {
      return source_.error(bone.offset, "acclaim-bone", "a bone has no name",
                           ":hierarchy and the motion refer to bones by name");
    }
    if (!seen.direction) return refuse("direction");
    if (!seen.length) return refuse("length");
    if (!seen.axis && !bone.joint.channels.empty()) return refuse("axis, but has a dof");
    if (bone.joint.limits.size() != bone.joint.channels.size()) bone.joint.limits.clear();
    const std::string joint = to_utf8(bone.name);
    // Usually printed with six digits.
    constexpr double kRounding = 1e-3;
    Vec3& direction = bone.joint.direction;
    const double norm = direction.stableNorm();
    if (std::abs(norm - 1.0) > kRounding && bone.joint.length != 0) {
      const char* taken = norm > 0 ? "it is normalised" : "the bone gets no length";
      if (Status status =
              source_.fault(bone.offset, "acclaim-bone",
                            fmt::format("the direction of {} has length {}, expected 1; {}",
                                        shown(bone.name), readable(norm, 4), taken),
                            {}, joint);
          !status) {
        return status;
      }
    }
    direction = norm > 0 && std::isfinite(norm) ? Vec3(direction / norm) : Vec3::Zero();
    if (bone.joint.length >= 0) return {};
    return source_.fault(bone.offset, "acclaim-bone",
                         fmt::format("the length of {} is negative: the bone direction is reversed",
                                     shown(bone.name)),
                         {}, joint);
  }

  SourceText& source_;
  TokenCursor& cursor_;
  ItemParser items_;
  const ReadOptions& options_;
  std::vector<PrintedBone>& bones_;
};

// Parses the section :bonedata after its keyword and appends its bones to `bones`.
Status parse_bones(SourceText& source, TokenCursor& cursor, const ReadOptions& options,
                   std::vector<PrintedBone>& bones) {
  return BoneParser(source, cursor, options, bones).parse();
}

class SkeletonParser {
 public:
  SkeletonParser(SourceText& source, const ReadOptions& options)
      : source_(source), options_(options), cursor_(source.text()), items_(source, cursor_) {}

  Result<SkeletonFile> parse() {
    SkeletonFile::Joint root;
    root.name = "root";
    result_.joints.push_back(std::move(root));
    for (Token token = cursor_.next(); !token.end(); token = cursor_.next()) {
      if (Status status = parse_section(token); !status) return status.error();
    }
    if (Status status = check_whole(); !status) return status.error();
    const double radians = result_.degrees ? kRadiansPerDegree : 1.0;
    result_.root_orientation = root_axes_.rotation(radians);
    std::vector<LooseBone> bones;
    for (PrintedBone& bone : printed_) {
      SkeletonFile::Joint& joint = bone.joint;
      joint.axes = bone.axes.rotation(radians);
      for (std::size_t k = 0; k < joint.limits.size(); ++k) {
        if (!is_rotation(joint.channels[k])) continue;
        joint.limits[k].lower *= radians;
        joint.limits[k].upper *= radians;
      }
      bones.push_back(std::move(bone));
    }
    if (Status status = hang_bones(bones, links_, source_, result_); !status) return status.error();
    return std::move(result_);
  }

 private:
  Status check_whole() {
    const std::size_t end = source_.text().size();
    constexpr const char* kCut = "the file is truncated or not an ASF; export or copy it again";
    if (printed_.empty()) return source_.error(end, "acclaim-syntax", "there are no bones", kCut);
    if (!has_hierarchy_) {
      return source_.error(end, "acclaim-syntax", "there is no :hierarchy", kCut);
    }
    std::vector<Channel>& order = result_.joints[0].channels;
    if (!order.empty()) return {};
    using enum Channel;
    order = {tx, ty, tz, rx, ry, rz};
    return source_.fault(has_root_ ? root_offset_ : end, "acclaim-root",
                         has_root_
                             ? ":root has no order, assumed to be TX TY TZ RX RY RZ"
                             : "there is no :root; its order is assumed to be TX TY TZ RX RY RZ");
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
    if (keyword == ":bonedata") return parse_bones(source_, cursor_, options_, printed_);
    if (keyword == ":hierarchy") return parse_hierarchy(token.offset);
    if (keyword != ":skin") {
      if (Status status = source_.fault(
              token.offset, "acclaim-keyword",
              fmt::format("the section {} is unknown and ignored", shown(token.text)));
          !status) {
        return status;
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

  Status parse_version() {
    const Token token = cursor_.peek();
    const auto version = items_.number("version");
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
                               fmt::format("'{}' is not an angle unit", shown(value.text)),
                               "write deg or rad");
        }
      } else if (unit == "length" || unit == "mass") {
        const auto factor = items_.number("unit of " + unit);
        if (!factor) return factor.error();
        if (*factor <= 0) {
          return source_.error(
              value.offset, "acclaim-number",
              fmt::format("a unit of {} of {} is not positive", unit, shown(value.text)));
        }
        if (unit == "length") result_.length_unit = *factor;
      } else if (Status status = items_.skip_unknown(token); !status) {
        return status;
      }
    }
    return {};
  }

  Status parse_documentation() {
    cursor_.skip_line();
    std::string& text = result_.documentation;
    // Free text, ended by a line that begins with ':'.
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
      Status status;
      if (key == "order") {
        result_.joints[0].channels.clear();
        status = items_.channels(result_.joints[0].channels, "the root");
      } else if (key == "axis") {
        status = items_.axis_order("root", root_axes_.order);
      } else if (key == "position") {
        status = items_.vector("position of the root", result_.root_position);
      } else if (key == "orientation") {
        status = items_.vector("orientation of the root", root_axes_.angles);
      } else {
        status = items_.skip_unknown(token);
      }
      if (!status) return status;
    }
    const bool moved = !result_.root_position.isZero(0) || !root_axes_.angles.isZero(0);
    if (!moved) return {};
    return source_.fault(offset, "acclaim-root",
                         "the root has a position or orientation, which is applied before the "
                         "motion; programs differ in this");
  }

  Status parse_hierarchy(std::size_t offset) {
    if (has_hierarchy_) return source_.error(offset, "acclaim-syntax", "a second :hierarchy");
    has_hierarchy_ = true;
    Token token = cursor_.next();
    if (!same_word(token.text, "begin")) {
      return source_.error(token.offset, "acclaim-syntax", "'begin' is expected after :hierarchy");
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
    return source_.error(token.offset, "acclaim-syntax", "'end' of :hierarchy is missing",
                         token.end() ? "the file is truncated; export or copy it again" : "");
  }

  SourceText& source_;
  const ReadOptions& options_;
  TokenCursor cursor_;
  ItemParser items_;
  SkeletonFile result_;
  std::vector<PrintedBone> printed_;
  std::vector<HierarchyLink> links_;
  PrintedAxes root_axes_;
  std::size_t root_offset_ = 0;
  bool has_root_ = false, has_hierarchy_ = false;
};

}  // namespace

Result<SkeletonFile> parse_skeleton(SourceText& source, const ReadOptions& options) {
  return SkeletonParser(source, options).parse();
}

}  // namespace krok::acclaim
