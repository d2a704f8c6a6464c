#pragma once

#include <string>
#include <vector>

#include "compare/measure.h"
#include "compare/scene_difference.h"
#include "tools/common/report.h"

// What a comparison found, whatever was compared, ready to be shown.

namespace krok::diff {

enum class Unit {
  length,
  angle,
  ratio,
  time,
  side,  // 1 where something is turned round, else 0
};

// One line of the result.
struct Row {
  std::string what;  // "positions"
  Unit unit = Unit::length;
  compare::Measure measure;
};

// Names for the indices in a Place; an index without one is shown as a number.
struct PlaceNames {
  std::vector<std::string> joints, meshes, animations;
  std::vector<std::string> second_meshes;         // of places in the second
  std::vector<std::vector<std::string>> targets;  // [meshes]
};

// One mesh or joint over all moments.
struct Item {
  compare::ValueLocation place;  // with the mesh or the joint
  std::vector<Row> rows;
};

struct Outcome {
  std::string kind;                    // "anim"
  std::vector<std::string> summary;    // lines on what was compared: "31 joints, 240 frames"
  std::vector<std::string> structure;  // differences that no tolerance allows
  std::vector<std::string> notes;
  std::vector<Row> rows;             // those without a single value are left out
  std::vector<Item> meshes, joints;  // each that was compared, in the order of the first
  PlaceNames names;
  bool same = false;

  void add_row(std::string what, Unit unit, const compare::Measure& measure);
  // Their directions and, where it differs, the handedness.
  void add_tangents(const compare::Measure& directions, const compare::Measure& sides);
  void add_parts(const std::vector<compare::PartDifference>& parts);
  void add_joints(const std::vector<compare::JointDifference>& found);
};

// A few lines for people, with units.
std::string to_text(const Outcome& outcome, const compare::Tolerance& tolerance);

// What differs most, in a line: "positions 0.32 mm at joint LeftHand, frame 37 (0.6167 s)".
std::string worst_of(const Outcome& outcome);

// All figures, in metres and radians.
Json to_json(const Outcome& outcome, const compare::Tolerance& tolerance);
Json to_json(const compare::Tolerance& tolerance);

}  // namespace krok::diff
