#include "body/surface_binding.h"

#include <algorithm>
#include <cmath>

#include "core/parallel.h"
#include "scene/influences.h"

namespace krok::body {

namespace {

using Weights = std::vector<std::pair<int, double>>;  // joint and weight, by joint

// Merges the weights per joint, drops negligible ones and normalises.
void tidy(Weights& weights) {
  std::stable_sort(weights.begin(), weights.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  Weights merged;
  double sum = 0;
  for (const auto& [joint, weight] : weights) {
    sum += weight;
    if (!merged.empty() && merged.back().first == joint) {
      merged.back().second += weight;
    } else {
      merged.emplace_back(joint, weight);
    }
  }
  double kept = 0;
  std::erase_if(merged, [&](const auto& entry) { return entry.second < 1e-4 * sum; });
  for (const auto& entry : merged) kept += entry.second;
  for (auto& entry : merged) entry.second /= kept;
  weights = std::move(merged);
}

Weights raw_weights(const BlockedField& field, const Vec3& point) {
  Weights weights;
  const auto places = field.places(point);
  if (places.empty()) return {{0, 1.0}};
  const TubePoint& nearest = places.front();
  field.field().bind(nearest, 1.0, weights);
  for (std::size_t i = 1; i < places.size(); ++i) {
    const double radius = 1.2 * field.field().blend_radius(nearest.tube, places[i].tube);
    if (radius <= 0) continue;
    const double closeness = 1 - (places[i].value - nearest.value) / radius;
    if (closeness > 0) field.field().bind(places[i], closeness * closeness, weights);
  }
  tidy(weights);
  return weights;
}

}  // namespace

void bind_surface(const Mesh& mesh, const BlockedField& field, int passes, int jobs, Model& model) {
  const std::size_t count = mesh.positions.size();
  std::vector<Weights> weights(count), smoothed(count);
  parallel_for(count, 256, jobs, [&](std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v) weights[v] = raw_weights(field, mesh.positions[v]);
  });
  const auto neighbours = vertex_neighbours(mesh);
  for (int pass = 0; pass < passes; ++pass) {
    parallel_for(count, 256, jobs, [&](std::size_t begin, std::size_t end) {
      for (std::size_t v = begin; v < end; ++v) {
        Weights sum = weights[v];
        const double share = 1.0 / static_cast<double>(neighbours[v].size());
        for (const std::uint32_t u : neighbours[v]) {
          for (const auto& [joint, weight] : weights[u]) sum.emplace_back(joint, share * weight);
        }
        tidy(sum);
        smoothed[v] = std::move(sum);
      }
    });
    std::swap(weights, smoothed);
  }
  constexpr std::size_t kInfluences = 4;
  model.influences_per_vertex = static_cast<int>(kInfluences);
  model.influence_joints.assign(count * kInfluences, 0);
  model.influence_weights.assign(count * kInfluences, 0.0f);
  for (std::size_t v = 0; v < count; ++v) {
    Weights& all = weights[v];
    std::stable_sort(all.begin(), all.end(),
                     [](const auto& a, const auto& b) { return a.second > b.second; });
    for (std::size_t k = 0; k < std::min(all.size(), kInfluences); ++k) {
      model.influence_joints[v * kInfluences + k] = static_cast<std::uint16_t>(all[k].first);
      model.influence_weights[v * kInfluences + k] = static_cast<float>(all[k].second);
    }
  }
  normalize_influences(model);
}

void map_surface(const Mesh& mesh, const BlockedField& field, int jobs, Model& model) {
  const std::size_t count = mesh.positions.size();
  model.texture_coordinates.assign(count, Vec2f::Zero());
  std::vector<double> along(count, 0);
  parallel_for(count, 256, jobs, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const auto places = field.places(mesh.positions[i]);
      if (places.empty()) continue;
      const Station station = field.field().station_at(places.front());
      const Vec3 offset = mesh.positions[i] - station.center;
      const double x = std::abs(offset.dot(station.side)), y = offset.dot(station.front);
      // Angle from the front without trigonometry: 0 front, 1/2 side, 1 back.
      const double whole = x + std::abs(y);
      const double quarter = whole > 0 ? 0.5 * x / whole : 0.5;
      model.texture_coordinates[i].x() = static_cast<float>(y >= 0 ? quarter : 1 - quarter);
      along[i] = std::max(0.0, station.along);
    }
  });
  const double longest = std::max(*std::max_element(along.begin(), along.end()), 1e-12);
  for (std::size_t i = 0; i < count; ++i) {
    model.texture_coordinates[i].y() = static_cast<float>(along[i] / longest);
  }
}

}  // namespace krok::body
