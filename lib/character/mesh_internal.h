#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "capture/unique_names.h"
#include "character/mesh.h"
#include "character/rig.h"
#include "character/space.h"
#include "nodes/evaluate.h"
#include "nodes/scene.h"
#include "scene/model.h"

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

// Computes area-weighted normals for the vertices whose normal is zero; +Y if the triangles give
// none. The model must have normals.
void make_missing_normals(Model& model);

// Whether two primitives have identical vertices, as is common for a mesh with several materials.
bool same_vertices(const nodes::Primitive& a, const nodes::Primitive& b);

class TargetNames {
 public:
  TargetNames(const nodes::Scene& scene, const nodes::Evaluator& evaluator);

  void add(const nodes::Instance& instance);

  // The merged target of target number `target` of an added instance's mesh.
  int index_of(const nodes::Instance& instance, int target) const {
    return indices_.at({instance.node, target});
  }
  const std::vector<std::string>& names() const { return names_; }
  const std::vector<SceneActor::WeightSource>& sources() const { return sources_; }

 private:
  // A node's weights channel in each animation, null if there is none.
  std::vector<const nodes::Channel*> channels_of(int node) const;
  bool same_weights(const SceneActor::WeightSource& a, const SceneActor::WeightSource& b) const;
  // Equal for all sources that same_weights() finds equal.
  std::uint64_t fingerprint(const SceneActor::WeightSource& source) const;

  const nodes::Scene& scene_;
  const nodes::Evaluator& evaluator_;
  std::map<std::pair<int, int>, int> indices_;  // by node and the mesh's target
  // Maps, since there may be many channels and many targets with the same name.
  std::vector<std::map<int, const nodes::Channel*>> channels_;  // for each animation, by node
  std::map<std::pair<std::string, std::uint64_t>, std::vector<int>> by_name_;  // and fingerprint
  UniqueNames unique_;
  std::vector<std::string> names_;
  std::vector<SceneActor::WeightSource> sources_;
};

}  // namespace krok::character
