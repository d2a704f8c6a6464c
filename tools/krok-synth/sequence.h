#pragma once

#include <array>
#include <string>
#include <vector>

#include "parametric/synthesise.h"
#include "scene/clip.h"
#include "scene/motion_keys.h"
#include "tools/cli/tool.h"
#include "tools/shared/planting.h"

// Puts motions of a library behind a motion, or behind each other: a walk, then a reach.

namespace krok::cli::synth {

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
