#pragma once

#include <cstddef>
#include <vector>

#include "character/rig.h"
#include "character/space.h"
#include "nodes/evaluate.h"

// Private to this folder: transforms of mesh vertices to the reference pose.

namespace krok::character {

using Affine = Eigen::Matrix<double, 3, 4>;

// The inverse transpose of a linear part up to a positive factor, without division.
Mat3 normal_matrix(const Mat3& linear);

// mesh_to_reference in Krok's frame for the vertices of one primitive at a time.
class Placements {
 public:
  // All must outlive it.
  Placements(const nodes::Scene& scene, const nodes::Evaluator& evaluator, const Rig& rig,
             const Conversion& conversion);

  // Whether the primitive is skinned, rather than attached to a joint.
  bool is_skinned(const nodes::Instance& instance) const;

  // Computes the transforms for a primitive that is moved by joints of the rig.
  void find(const nodes::Instance& instance);
  const Affine& of(std::size_t vertex) const {
    return placements_.size() == 1 ? placements_[0] : placements_[vertex];
  }

 private:
  const nodes::Scene& scene_;
  const nodes::Evaluator& evaluator_;
  const Rig& rig_;
  Affine to_krok_;
  nodes::Evaluation rest_;
  std::vector<Affine> placements_;  // [vertices], or one for all
};

}  // namespace krok::character
