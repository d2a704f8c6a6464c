#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "capture/unique_names.h"
#include "character/mesh.h"
#include "nodes/evaluate.h"

// Private to this folder: merges morph targets of several meshes.

namespace krok::character {

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
