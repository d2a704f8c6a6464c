#include "tools/krok-diff/tolerance_options.h"

#include <fmt/format.h>

#include "core/text.h"
#include "tools/cli/option_kinds.h"
#include "tools/krok-diff/options.h"

namespace krok::cli::diff {

namespace {

using compare::Matching;

ValueKind<double> tolerance(ValueKind<double> kind) {
  auto read = [read = kind.read](const std::string& text) -> Result<double> {
    auto value = read(text);
    if (!value || *value >= 0) return value;
    return Error("quantity-range", fmt::format("'{}' is negative", shown(text)),
                 "a tolerance is at least 0");
  };
  kind.read = std::move(read);
  return kind;
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

void declare_tolerances(CommandOptions& command, Options& o) {
  std::vector<std::pair<std::string, Matching>> words;
  for (const Matching matching :
       {Matching::automatic, Matching::order, Matching::name, Matching::nearest}) {
    words.emplace_back(word_of(matching), matching);
  }
  command.add("--match HOW", o.matching, choice<Matching>(std::move(words)),
              "How to match meshes and joints: order, by their index in the file, and a renamed "
              "animation or material is then no difference; name, by name, reporting those that "
              "only one has; auto, by name if all names are unique and the same, else by index; "
              "nearest, each vertex with the nearest point of the other surface, for meshes with "
              "different vertices, triangles or parts; skin weights and morph targets are then "
              "compared by their effect only",
              "auto");
  command.add("--tolerance", o.tolerance.length, tolerance(length_with_unit()),
              "Max distance that counts as the same: 0.1mm, 0.2cm, with a unit", "0.01mm");
  command.add("--angle", o.tolerance.angle, tolerance(angle()),
              "Max angle that counts as the same: 0.1deg, 0.002rad; a bare number is degrees",
              "0.01deg");
  command.add("--ratio NUMBER", o.tolerance.ratio, tolerance(number()),
              "Max difference of unitless values that counts as the same: weights, texture "
              "coordinates",
              "0.0001");
  command.add(
      "--normals", o.tolerance.normals, tolerance(angle()),
      "The same for normals and tangents only (default: that of --angle). A flipped tangent "
      "handedness is always a difference. Tangents that only one of two glTF files has are a "
      "difference if both have a normal texture, else they are only reported");
  command.add(
      "--joint-tolerance LENGTH[,ANGLE]", o.joints,
      numbers({tolerance(length_with_unit()), tolerance(angle())}, 1),
      "The same for joints only, 1mm or 1mm,0.5deg (default: those of --tolerance and --angle)");
  command.add("--times", o.tolerance.time, tolerance(seconds({})),
              "Max difference of times that count as equal: key times of glTF, and frames of "
              "motions with different rates: 1ms, 0.02s",
              "0.1ms");
  command.add_flag("--materials", o.materials,
                   "Count different materials, colours, textures, vertex colours or unused texture "
                   "coordinates as a difference; by default they are only reported; for glTF");
}

}  // namespace krok::cli::diff
