#include "tools/krok-diff/tolerance_options.h"

#include <fmt/format.h>

#include "core/numbers.h"
#include "core/quantity.h"
#include "tools/cli/option_kinds.h"

namespace krok::cli::diff {

namespace {

using compare::Matching;

// The value of an option, which must not be negative.
Result<double> not_negative(Result<double> value, const char* option, const std::string& text) {
  if (!value) {
    Error error = std::move(value).error();
    error.message = fmt::format("{}: {}", option, error.message);
    return error;
  }
  if (*value < 0) {
    return Error("quantity-range", fmt::format("{} {} is negative", option, text),
                 "a tolerance is at least 0");
  }
  return value;
}

Result<double> parse_ratio(const std::string& text) {
  const auto value = parse_finite(text);
  if (!value) return Error("quantity-number", fmt::format("'{}' is not a number", text));
  return *value;
}

Result<double> parse_seconds(const std::string& text) {
  const auto time = parse_clip_time(text);
  if (!time) return time.error();
  if (!time->in_frames) return time->value;
  return Error("quantity-unit", fmt::format("'{}' is not a time in seconds", text),
               "write 1ms or 0.001s");
}

// LENGTH, or LENGTH,ANGLE.
Status parse_joints(const std::string& text, compare::Tolerance& tolerance) {
  const std::size_t comma = text.find(',');
  const auto length = not_negative(parse_length_with_unit(text.substr(0, comma)), "--joints", text);
  if (!length) return length.error();
  tolerance.joint_positions = *length;
  if (comma == std::string::npos) return {};
  const auto angle = not_negative(parse_angle(text.substr(comma + 1)), "--joints", text);
  if (!angle) return angle.error();
  tolerance.joint_orientations = *angle;
  return {};
}

}  // namespace

const char* word_of(Matching matching) {
  switch (matching) {
    case Matching::order:
      return "order";
    case Matching::name:
      return "name";
    case Matching::nearest:
      return "nearest";
    case Matching::automatic:
      break;
  }
  return "auto";
}

void declare_tolerances(CommandOptions& command, ToleranceArguments& arguments) {
  std::vector<std::pair<std::string, Matching>> words;
  for (const Matching matching :
       {Matching::automatic, Matching::order, Matching::name, Matching::nearest}) {
    words.emplace_back(word_of(matching), matching);
  }
  add_choice(command, "--match", arguments.matching, std::move(words),
             "How to match meshes and joints: order, by their index in the file, and a renamed "
             "animation or material is then no difference; name, by name, "
             "reporting those that only one has; auto, by name if all names are unique and the "
             "same, else by index; nearest, each vertex with the nearest point of the other "
             "surface, for meshes with different vertices, triangles or parts; skin weights and "
             "morph targets are then compared by their effect only",
             "HOW", "auto");
  command
      .add_option("--tolerance LENGTH", arguments.length,
                  "Max distance that counts as the same: 0.1mm, 0.2cm, with a unit")
      .default_str(arguments.length);
  command
      .add_option("--angle ANGLE", arguments.angle,
                  "Max angle that counts as the same: 0.1deg, 0.002rad; a bare number is degrees")
      .default_str(arguments.angle);
  command
      .add_option(
          "--ratio NUMBER", arguments.ratio,
          "Max difference of unitless values that counts as the same: weights, texture coordinates")
      .default_str(arguments.ratio);
  command.add_option(
      "--normals ANGLE", arguments.normals,
      "The same for normals and tangents only (default: that of --angle). A flipped tangent "
      "handedness is always a difference. Tangents that only one of two glTF files has are a "
      "difference if both have a normal texture, else they are only reported");
  command.add_option(
      "--joints LENGTH[,ANGLE]", arguments.joints,
      "The same for joints only, 1mm or 1mm,0.5deg (default: those of --tolerance and --angle)");
  command
      .add_option("--times TIME", arguments.times,
                  "Max difference of times that count as equal: key times of glTF, and frames of "
                  "motions with different rates: 1ms, 0.02s")
      .default_str(arguments.times);
  command.add_flag("--materials", arguments.materials,
                   "Count different materials, colours, textures, vertex colours or unused texture "
                   "coordinates as a difference; by default they are only reported; for glTF");
}

Result<compare::Tolerance> parse_tolerances(const ToleranceArguments& arguments) {
  compare::Tolerance tolerance;
  const auto length =
      not_negative(parse_length_with_unit(arguments.length), "--tolerance", arguments.length);
  if (!length) return length.error();
  const auto angle = not_negative(parse_angle(arguments.angle), "--angle", arguments.angle);
  if (!angle) return angle.error();
  const auto ratio = not_negative(parse_ratio(arguments.ratio), "--ratio", arguments.ratio);
  if (!ratio) return ratio.error();
  const auto times = not_negative(parse_seconds(arguments.times), "--times", arguments.times);
  if (!times) return times.error();
  tolerance.time = *times;
  tolerance.length = *length;
  tolerance.angle = *angle;
  tolerance.ratio = *ratio;
  if (!arguments.normals.empty()) {
    const auto normals =
        not_negative(parse_angle(arguments.normals), "--normals", arguments.normals);
    if (!normals) return normals.error();
    tolerance.normals = *normals;
  }
  if (!arguments.joints.empty()) {
    if (Status status = parse_joints(arguments.joints, tolerance); !status) return status.error();
  }
  return tolerance;
}

}  // namespace krok::cli::diff
