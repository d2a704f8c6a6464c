#include "scene/model.h"

#include <fmt/format.h>
#include <algorithm>

#include <cmath>
#include <limits>
#include <utility>

namespace krok {

namespace {

Status check_influences(const Model& model) {
  const auto per_vertex = static_cast<std::size_t>(model.influences_per_vertex);
  for (std::size_t v = 0; v < model.positions.size(); ++v) {
    double sum = 0;
    float previous = std::numeric_limits<float>::infinity();
    for (std::size_t k = v * per_vertex; k < (v + 1) * per_vertex; ++k) {
      const float weight = model.influence_weights[k];
      if (!(weight >= 0) || !std::isfinite(weight)) {
        return Error("model-weight", fmt::format("vertex {} has a weight of {}", v, weight));
      }
      if (model.influence_joints[k] >= model.skeleton.names.size()) {
        return Error("model-index",
                     fmt::format("vertex {} refers to joint {} of {}", v, model.influence_joints[k],
                                 model.skeleton.joint_count()));
      }
      if (weight > previous || (weight == 0 && model.influence_joints[k] != 0)) {
        return Error(
            "model-weight",
            fmt::format("the influences of vertex {} are not in decreasing order, or an unused "
                        "one has a joint",
                        v));
      }
      previous = weight;
      sum += static_cast<double>(weight);
    }
    if (std::abs(sum - 1.0) > 1e-4) {
      return Error("model-weight",
                   fmt::format("the weights of vertex {} sum to {}, expected 1", v, sum));
    }
  }
  return {};
}

Status check_triangles(const Model& model) {
  for (std::size_t t = 0; t < model.triangles.size(); ++t) {
    for (const std::uint32_t index : model.triangles[t]) {
      if (index >= model.positions.size()) {
        return Error("model-index", fmt::format("triangle {} refers to vertex {} of {}", t, index,
                                                model.positions.size()));
      }
    }
  }
  std::uint64_t next = 0;
  for (const Model::Part& part : model.parts) {
    if (part.first_triangle != next) {
      return Error("model-shape", fmt::format("part {} starts at triangle {}, expected {}",
                                              part.name, part.first_triangle, next));
    }
    next += part.triangle_count;
  }
  if (next != model.triangles.size()) {
    return Error("model-shape",
                 fmt::format("the parts cover {} triangles of {}", next, model.triangles.size()));
  }
  return {};
}

template <typename Vector>
bool all_near(const std::vector<Vector>& values) {
  return std::ranges::all_of(values, [](const Vector& value) { return is_near(value); });
}

bool is_unit(const Vec3f& direction) {
  return std::abs(direction.norm() - 1.0f) <= 1e-3f;
}

Status check_directions(const Model& model) {
  for (std::size_t v = 0; v < model.normals.size(); ++v) {
    if (is_unit(model.normals[v])) continue;
    return Error("model-value", fmt::format("the normal of vertex {} has length {}, expected 1", v,
                                            model.normals[v].norm()));
  }
  for (std::size_t v = 0; v < model.tangents.size(); ++v) {
    const Vec4f& tangent = model.tangents[v];
    if (is_unit(tangent.head<3>()) && std::abs(tangent.w()) == 1.0f) continue;
    return Error("model-value",
                 fmt::format("the tangent of vertex {} is not a unit vector with w of 1 or -1", v));
  }
  return {};
}

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

Status check(const Model& model) {
  if (Status status = check(model.skeleton); !status) return status;
  const std::size_t count = model.positions.size();
  const auto fits = [count](std::size_t size) { return size == 0 || size == count; };
  if (!fits(model.normals.size()) || !fits(model.texture_coordinates.size()) ||
      !fits(model.tangents.size()) || !fits(model.colours.size()) ||
      !std::ranges::all_of(model.more_texture_coordinates,
                           [count](const auto& set) { return set.size() == count; })) {
    return Error("model-shape",
                 "normals, texture coordinates, tangents or colours do not match the vertices");
  }
  const std::size_t more = model.more_texture_coordinates.size();
  if (more >= Model::kMaxCoordinateSets || (more > 0 && model.texture_coordinates.empty())) {
    return Error("model-shape",
                 fmt::format("{} sets of texture coordinates after the first, expected up to {} if "
                             "there is a first, else none",
                             more, Model::kMaxCoordinateSets - 1));
  }
  if (model.influences_per_vertex < 1 || model.influences_per_vertex > Model::kMaxInfluences) {
    return Error("model-shape", fmt::format("{} influences per vertex, expected 1 to {}",
                                            model.influences_per_vertex, Model::kMaxInfluences));
  }
  const std::size_t influences = count * static_cast<std::size_t>(model.influences_per_vertex);
  if (model.influence_joints.size() != influences || model.influence_weights.size() != influences) {
    return Error("model-shape", "joint indices or weights do not match the vertices");
  }
  if (!all_near(model.positions) || !all_near(model.normals) ||
      !all_near(model.texture_coordinates) || !all_near(model.tangents) ||
      !all_near(model.colours) ||
      !std::ranges::all_of(model.more_texture_coordinates, all_near<Vec2f>)) {
    return Error("model-value", "a vertex is not finite or over 1e9 m away");
  }
  if (Status status = check_directions(model); !status) return status;
  if (Status status = check_influences(model); !status) return status;
  return check_triangles(model);
}

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
