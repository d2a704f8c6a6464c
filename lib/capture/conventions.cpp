#include "capture/conventions.h"

#include <fmt/format.h>

#include <array>
#include <string>
#include <utility>

#include "core/numbers.h"
#include "core/text.h"

namespace krok {

namespace {

constexpr std::array<std::string_view, 6> kDirectionNames = {"x", "-x", "y", "-y", "z", "-z"};

// Unit names and sizes in metres. The CMU collection's Acclaim files are in inches divided by 0.45
// (mocap.cs.cmu.edu, frequently asked questions).
constexpr std::array<std::pair<std::string_view, double>, 7> kUnits = {{{"m", 1.0},
                                                                        {"dm", 0.1},
                                                                        {"cm", 0.01},
                                                                        {"mm", 0.001},
                                                                        {"in", 0.0254},
                                                                        {"ft", 0.3048},
                                                                        {"cmu", 0.0254 / 0.45}}};

}  // namespace

std::string_view direction_name(Direction direction) {
  return kDirectionNames[static_cast<std::size_t>(direction)];
}

Result<Direction> parse_direction(std::string_view text) {
  const std::string small = ascii_lower(text);  // "Z", as other programs write it
  std::string_view plain = small;
  if (plain.starts_with('+')) plain.remove_prefix(1);
  for (std::size_t i = 0; i < kDirectionNames.size(); ++i) {
    if (plain == kDirectionNames[i] && !(text.starts_with('+') && plain.starts_with('-'))) {
      return static_cast<Direction>(i);
    }
  }
  return Error("direction-unknown", fmt::format("'{}' is not an axis", text),
               "use x, y, z, -x, -y or -z");
}

Vec3 direction_vector(Direction direction) {
  const auto index = static_cast<int>(direction);
  return (index % 2 == 0 ? 1.0 : -1.0) * Vec3::Unit(index / 2);
}

std::string_view confidence_name(Confidence confidence) {
  switch (confidence) {
    case Confidence::guess:
      return "guess";
    case Confidence::likely:
      return "likely";
    case Confidence::certain:
      return "certain";
  }
  return "guess";
}

Result<Unit> parse_unit(std::string_view text) {
  for (const auto& [name, metres] : kUnits) {
    if (text == name) return Unit{metres, std::string(name)};
  }
  // parse_length reads a bare number as metres; as a unit it is more likely a mistake.
  const auto length = parse_length(text);
  const bool has_unit = !text.empty() && text.find_first_of("mnt") != std::string_view::npos;
  if (length.ok() && has_unit && *length > 0) return Unit{*length, std::string(text)};
  return Error("unit-unknown", fmt::format("'{}' is not a unit of length", text),
               "use m, dm, cm, mm, in, ft, cmu, or a length such as 5.64cm");
}

Result<Quat> rotation_to_krok(Direction up, Direction forward) {
  const Vec3 y = direction_vector(up);
  const Vec3 z = direction_vector(forward);
  if (y.dot(z) != 0.0) {
    return Error("direction-parallel",
                 fmt::format("up ({}) and forward ({}) are parallel", direction_name(up),
                             direction_name(forward)),
                 "use two different axes");
  }
  Mat3 to_krok;
  to_krok.row(0) = y.cross(z).transpose();
  to_krok.row(1) = y.transpose();
  to_krok.row(2) = z.transpose();
  return Quat(to_krok).normalized();
}

}  // namespace krok
