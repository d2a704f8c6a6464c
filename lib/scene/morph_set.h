#pragma once

#include <span>
#include <string>
#include <vector>

#include "core/result.h"
#include "math/transform.h"
#include "scene/provenance.h"

namespace krok {

// Morph targets (blend shapes) of a model: other shapes of the same mesh, with the same number and
// order of vertices. With weights w_i, the positions p_i of target i move a vertex v to v + sum_i
// w_i (p_i - v), and its normal likewise (then normalised); skinning is applied afterwards.
// Positions and normals are in the model's reference pose, target by target.
struct MorphSet {
  std::vector<std::string> names;  // [targets] unique, not empty, UTF-8
  int vertex_count = 0;            // of the model
  std::vector<Vec3f> positions;    // [targets x vertices] metres
  std::vector<Vec3f> normals;      // [targets x vertices], or empty; length about 1
  Provenance provenance;

  int target_count() const { return static_cast<int>(names.size()); }
  int find(const std::string& name) const;  // the index of a target, or -1

  // The vertices of one target, [vertices].
  std::span<const Vec3f> target_positions(int target) const;
  std::span<const Vec3f> target_normals(int target) const;  // empty if there are none
};

// Checks everything documented above. Codes: morph-shape, morph-name, morph-value.
Status check(const MorphSet& morphs);

// The weight of each target over time. Frame i is at time i / rate.
struct MorphWeights {
  double rate = 30.0;
  std::vector<std::string> names;  // [targets], a MorphSet's
  std::vector<float> values;       // [frames x targets]

  int frame_count() const {
    return names.empty() ? 0 : static_cast<int>(values.size() / names.size());
  }
};

// The weights at `seconds`, one per target: linear between frames, clamped to the first and last
// frame; all 0 if there are no frames. NaN gives the first frame.
void weights_at(const MorphWeights& weights, double seconds, std::vector<float>& at);

// Every `step`-th frame of [first, last], as cut() of motions; none of no frames.
MorphWeights cut(const MorphWeights& weights, int first, int last, int step = 1);

// The same for the targets of another mesh, by name: those without weights have those of `rest`, or
// 0. Empty if no name is the same.
MorphWeights weights_of_targets(const MorphWeights& weights, std::span<const std::string> names,
                                std::span<const float> rest);

}  // namespace krok
