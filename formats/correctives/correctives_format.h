#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/result.h"
#include "correctives/correctives.h"
#include "skin/skin.h"

// Krok's format for correctives, .correctives (JSON); see formats/correctives/SPEC.md.

namespace krok::correctives_file {

// Reads correctives; they pass check(Correctives). Safe for untrusted input. Codes: json-syntax,
// json-limit, correctives-structure, correctives-value, with line and column; those of
// check(Correctives).
Result<Correctives> read(std::string_view text);

// The text of a file. Offsets are rounded to a micrometre, those of normals to 1e-4; what was read
// from a file gives its text. An Error if check() fails, or if weights are of another kernel than
// cubic, smoothed or with inserted points (code correctives-shape).
Result<std::string> write(const Correctives& correctives);

// The JSON Schema of such files.
std::string schema();

}  // namespace krok::correctives_file

// Reader for descriptions of correctives (JSON, hand-written), the input of krok-fit: poses of
// joints and the shapes that a model should have in them. See formats/correctives/SPEC.md.

namespace krok::corrective_poses {

inline constexpr std::string_view kSchema = "krok.corrective-poses/1";

struct Pose {
  std::string motion;  // paths relative to the file, inside its folder
  int frame = 0;       // of the motion, from 0
  std::string shape;
  Location place;
};

struct Joint {
  std::string joint;
  std::vector<Pose> examples;  // at least one
  std::vector<Pose> held_out;
  Location place;
};

struct Description {
  std::string model;
  SkinMethod method = SkinMethod::linear;  // that the correctives correct
  std::vector<Joint> joints;               // each once, at least one
};

// Safe for untrusted input. Codes, each with line and column: json-syntax, json-limit,
// corrective-poses-structure, corrective-poses-value, corrective-poses-path.
Result<Description> read(std::string_view text);

// The JSON Schema of such files.
std::string schema();

}  // namespace krok::corrective_poses
