#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "compare/measure.h"
#include "compare/scene_difference.h"
#include "tools/cli/report.h"
#include "tools/krok-diff/difference_sheet.h"

// The result of a comparison of any file type, ready to be printed.

namespace krok::cli::diff {

enum class Unit {
  length,
  angle,
  ratio,
  time,
  side,  // 1 if the handedness is flipped, else 0
};

// One line of the result.
struct Row {
  std::string what;  // "positions"
  Unit unit = Unit::length;
  compare::Measure measure;
  bool at_least = false;  // the measured values are lower bounds
};

// Names for the indices in a ValueLocation; an index without a name is shown as a number.
struct PlaceNames {
  std::vector<std::string> joints, meshes, animations;
  std::vector<std::string> second_meshes;  // for locations in the second
  // Of the meshes, as the files name them: of the node, of the mesh.
  std::vector<std::pair<std::string, std::string>> first_files, second_files;
  std::vector<std::vector<std::string>> targets;  // [meshes]
};

// One mesh or joint over all times.
struct Item {
  compare::ValueLocation place;  // its mesh or joint
  std::vector<Row> rows;
};

struct Outcome {
  std::string kind;                    // "anim"
  std::vector<std::string> summary;    // lines about what was compared: "31 joints, 240 frames"
  std::vector<std::string> structure;  // differences that no tolerance can cover
  std::vector<std::string> notes;
  std::vector<Row> rows;             // rows without values are omitted
  std::vector<Item> meshes, joints;  // all that were compared, in the order of the first
  PlaceNames names;
  bool same = false;
  bool at_least = false;  // vertices may be farther apart than measured, see SceneDifference
  // For the page of a summary.
  std::optional<Pictures> pictures;
  std::string chart;  // SVG; empty for none

  void add_row(std::string what, Unit unit, const compare::Measure& measure);
  // Adds directions and, if it differs, the handedness.
  void add_tangents(const compare::Measure& directions, const compare::Measure& sides);
  void add_parts(const std::vector<compare::PartDifference>& parts);
  void add_joints(const std::vector<compare::JointDifference>& found);
};

// Text report, a few lines with units.
std::string to_text(const Outcome& outcome, const compare::Tolerance& tolerance);

// The largest difference in one line: "positions 0.32 mm at joint LeftHand, frame 37 (0.6167 s)".
std::string worst_of(const Outcome& outcome);

// How bad a difference is: the largest ratio of a difference to its tolerance, infinite for
// differences that no tolerance can cover, 0 for none.
double excess_of(const Outcome& outcome);

// All metrics, in metres and degrees.
Json to_json(const Outcome& outcome, const compare::Tolerance& tolerance);
Json to_json(const compare::Tolerance& tolerance);

}  // namespace krok::cli::diff
