#include "scene/influences.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace krok {

namespace {

struct Influence {
  std::uint16_t joint = 0;
  double weight = 0;
};

using Influences = std::array<Influence, Model::kMaxInfluences>;

// Appends to the first `count` influences, or adds the weight to the one with the same joint.
int merge(Influences& influences, int count, std::uint16_t joint, double weight) {
  if (!(weight > 0) || !std::isfinite(weight)) return count;
  for (int k = 0; k < count; ++k) {
    if (influences[k].joint == joint) {
      influences[k].weight += weight;
      return count;
    }
  }
  influences[count] = {joint, weight};
  return count + 1;
}

// Insertion sort: there are at most eight.
void sort_falling(Influences& influences, int count) {
  const auto before = [](const Influence& a, const Influence& b) {
    return a.weight != b.weight ? a.weight > b.weight : a.joint < b.joint;
  };
  for (int i = 1; i < count; ++i) {
    for (int k = i; k > 0 && before(influences[k], influences[k - 1]); --k) {
      std::swap(influences[k], influences[k - 1]);
    }
  }
}

}  // namespace

void normalize_influences(Model& model) {
  const int places = model.influences_per_vertex;
  for (std::size_t v = 0; v < model.positions.size(); ++v) {
    std::uint16_t* joints = &model.influence_joints[v * places];
    float* weights = &model.influence_weights[v * places];
    Influences influences;
    int count = 0;
    for (int k = 0; k < places; ++k)
      count = merge(influences, count, joints[k], double{weights[k]});
    if (count == 0) influences[count++] = {0, 1.0};
    sort_falling(influences, count);
    double sum = 0;
    for (int k = 0; k < count; ++k) sum += influences[k].weight;
    for (int k = 0; k < places; ++k) {
      const bool used = k<count&& static_cast<float>(influences[k].weight / sum)> 0;
      joints[k] = used ? influences[k].joint : std::uint16_t{0};
      weights[k] = used ? static_cast<float>(influences[k].weight / sum) : 0.0f;
    }
  }
}

int used_influences(const Model& model) {
  const auto places = static_cast<std::size_t>(model.influences_per_vertex);
  std::size_t most = 1;
  for (std::size_t i = 0; i < model.influence_weights.size(); ++i) {
    if (model.influence_weights[i] > 0) most = std::max(most, i % places + 1);
  }
  return static_cast<int>(most);
}

int limit_influences(Model& model, int count) {
  const auto before = static_cast<std::size_t>(model.influences_per_vertex);
  const auto kept = static_cast<std::size_t>(count);
  if (kept >= before) return 0;
  const std::size_t vertices = model.positions.size();
  int changed = 0;
  for (std::size_t v = 0; v < vertices; ++v) {
    if (model.influence_weights[v * before + kept] > 0) ++changed;
    for (std::size_t k = 0; k < kept; ++k) {
      model.influence_joints[v * kept + k] = model.influence_joints[v * before + k];
      model.influence_weights[v * kept + k] = model.influence_weights[v * before + k];
    }
  }
  model.influences_per_vertex = count;
  model.influence_joints.resize(vertices * kept);
  model.influence_weights.resize(vertices * kept);
  if (changed > 0) normalize_influences(model);
  return changed;
}

}  // namespace krok
