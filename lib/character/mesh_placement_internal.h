#pragma once

#include <cstddef>
#include <vector>

#include "character/rig.h"
#include "character/space.h"
#include "nodes/evaluate.h"

// Private to this folder: where vertices of a mesh at a node stand in the reference pose.

namespace krok::character {

using Affine = Eigen::Matrix<double, 3, 4>;

// The inverse transpose of a linear part up to a positive factor, without a division.
Mat3 normal_matrix(const Mat3& linear);

// mesh_to_reference in Krok's frame for the vertices of one primitive at a time.
class Placements {
 public:
  // All must outlive it.
  Placements(const nodes::Scene& scene, const nodes::Evaluator& evaluator, const Rig& rig,
             const Conversion& conversion);

  // Whether a skin moves the primitive, rather than the joint that it hangs on.
  bool is_skinned(const nodes::Instance& instance) const;

  // Works them out for a primitive that joints of the rig move.
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
