#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "core/result.h"
#include "formats/steps/steps.h"
#include "parametric/synthesise.h"
#include "scene/clip.h"
#include "scene/motion_keys.h"
#include "tools/cli/tool.h"
#include "tools/shared/planting.h"

// A library's parameters by the names in its description, and requested values.

namespace krok::cli::synth {

struct NamedParameter {
  std::string name;                      // "length"
  std::string measures;                  // "step.length"
  std::string_view unit;                 // "m", "rad" or "s"
  double least = 0, most = 0, mean = 0;  // over the examples
};

std::vector<NamedParameter> parameters_of(const steps::StepsFile& file);

// Parses NAME=VALUE words; quantities with or without a unit. Parameters that are not among them
// have the examples' mean, which is printed. Code: usage, listing the library's parameters, if a
// name is unknown or repeated.
Result<std::vector<double>> parse_settings(const std::vector<std::string>& words,
                                           const std::vector<NamedParameter>& parameters,
                                           ToolContext& context);

// Reads a table with a column per parameter; headers may name a unit, as in "length [cm]". Codes:
// those of csv::Table, with line and column; synth-table for a missing value or an unsuitable unit.
Result<std::vector<std::vector<double>>> read_points(const std::string& path,
                                                     const std::vector<NamedParameter>& parameters,
                                                     ToolContext& context);

// Puts motions of a library behind a motion, or behind each other: a walk, then a reach.

struct Sequence {
  Clip clip;
  MotionKeys keys;
  std::vector<double> starts;  // [parts], seconds
};

// The parts one after the other. Each continues where and as the one before ends, on the level;
// what differs decays over `transition` seconds (inertialization). Warning synth-pop where joints,
// hips or feet go faster there than in the motions. Codes: those of timeline::mix().
struct SequencePart {
  std::string name;
  const Clip* clip = nullptr;
  const MotionKeys* keys = nullptr;
};
Result<Sequence> in_sequence(const std::vector<SequencePart>& parts, double transition,
                             const RoleMap& roles, ToolContext& context);

// The point that a library's parameters measure: the same joint at the same keytime, across, up and
// along. Code synth-place if they do not.
struct MeasuredPoint {
  int joint = -1, keytime = 0;
  std::array<std::size_t, 3> parameters = {};  // [Direction]
};
Result<MeasuredPoint> measured_point(const parametric::Library& library);

// Where that point is in a motion whose part begins at `start`, and what it takes to bring it to
// `place` (world): to be added to the parameters, [Direction].
struct PointMiss {
  Vec3 at = Vec3::Zero();
  std::array<double, 3> change = {};
};
PointMiss miss_of(const parametric::Library& library, const MeasuredPoint& point, const Clip& clip,
                  double time, const Vec3& place);

}  // namespace krok::cli::synth
