#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "core/result.h"
#include "math/types.h"
#include "scene/provenance.h"

namespace krok {

// Morph targets of a model: other shapes of the same mesh, with the same number and order of
// vertices. A target i moves a vertex from v to v + sum_i w_i (p_i - v), and its normal likewise
// (brought to length 1 after); the skeleton moves the result. Positions and normals stand in the
// model's reference pose, target by target.
struct MorphSet {
  std::vector<std::string> names;  // [targets] unique, not empty, UTF-8
  int vertex_count = 0;            // of the model
  std::vector<Vec3f> positions;    // [targets x vertices] metres
  std::vector<Vec3f> normals;      // [targets x vertices], or none; of about length 1
  Provenance provenance;

  int target_count() const { return static_cast<int>(names.size()); }
  int find(const std::string& name) const;  // the index of a target, or -1

  // One target's vertices, [vertices].
  std::span<const Vec3f> target_positions(int target) const;
  std::span<const Vec3f> target_normals(int target) const;  // empty where there are none
};

// Whether what the comments above promise holds. Codes: morph-shape, morph-name, morph-value.
Status check(const MorphSet& morphs);

// How much of each target shows over time. Frame i is at time i / rate.
struct MorphWeights {
  double rate = 30.0;
  std::vector<std::string> names;  // [targets], a MorphSet's
  std::vector<float> values;       // [frames x targets]

  int frame_count() const {
    return names.empty() ? 0 : static_cast<int>(values.size() / names.size());
  }
};

// The weights at `seconds`, one a target: linear between two frames, the first frame's before it
// and the last one's after; all 0 without frames. A time that is not a number is the beginning.
void weights_at(const MorphWeights& weights, double seconds, std::vector<float>& at);

}  // namespace krok
