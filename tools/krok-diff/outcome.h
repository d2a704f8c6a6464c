#pragma once

#include <string>
#include <vector>

#include "compare/measure.h"
#include "tools/common/report.h"

// What a comparison found, whatever was compared, ready to be shown.

namespace krok::diff {

enum class Unit { length, angle, ratio };

// One line of the result.
struct Row {
  std::string what;  // "positions"
  Unit unit = Unit::length;
  compare::Measure measure;
};

// Names for the indices in a Place; an index without one is shown as a number.
struct PlaceNames {
  std::vector<std::string> joints, meshes, animations;
  std::vector<std::vector<std::string>> targets;  // [meshes]
};

struct Outcome {
  std::string kind;                    // "anim"
  std::vector<std::string> summary;    // lines on what was compared: "31 joints, 240 frames"
  std::vector<std::string> structure;  // differences that no tolerance allows
  std::vector<std::string> notes;
  std::vector<Row> rows;  // those without a single value are left out
  PlaceNames names;
  bool same = false;

  void add_row(std::string what, Unit unit, const compare::Measure& measure);
};

// A few lines for people, with units.
std::string to_text(const Outcome& outcome, const compare::Tolerance& tolerance);

// All figures, in metres and radians.
Json to_json(const Outcome& outcome, const compare::Tolerance& tolerance);

}  // namespace krok::diff
