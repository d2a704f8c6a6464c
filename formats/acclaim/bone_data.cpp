#include "formats/acclaim/bone_data_internal.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <optional>

#include "core/numbers.h"
#include "core/text.h"

namespace krok::acclaim {

namespace {

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

}  // namespace

Status parse_bones(SourceText& source, TokenCursor& cursor, const ReadOptions& options,
                   std::vector<PrintedBone>& bones) {
  return BoneParser(source, cursor, options, bones).parse();
}

}  // namespace krok::acclaim
