#include "scene/morph_set.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <unordered_set>

#include "core/index.h"
#include "core/text.h"

namespace krok {

namespace {

std::span<const Vec3f> part(const std::vector<Vec3f>& values, int target, int vertices) {
  if (values.empty()) return {};
  return row_of(values, vertices, target);
}

}  // namespace

int MorphSet::find(const std::string& name) const {
  const auto found = std::find(names.begin(), names.end(), name);
  return found == names.end() ? -1 : static_cast<int>(found - names.begin());
}

std::span<const Vec3f> MorphSet::target_positions(int target) const {
  return part(positions, target, vertex_count);
}

std::span<const Vec3f> MorphSet::target_normals(int target) const {
  return part(normals, target, vertex_count);
}

Status check(const MorphSet& morphs) {
  const std::size_t expected =
      morphs.names.size() * static_cast<std::size_t>(std::max(0, morphs.vertex_count));
  if (morphs.vertex_count < 0 || morphs.positions.size() != expected ||
      (!morphs.normals.empty() && morphs.normals.size() != expected)) {
    return Error("morph-shape",
                 fmt::format("{} targets of {} vertices have {} positions and {} normals",
                             morphs.names.size(), morphs.vertex_count, morphs.positions.size(),
                             morphs.normals.size()));
  }
  std::unordered_set<std::string> seen;
  for (const std::string& name : morphs.names) {
    if (name.empty() || !is_utf8(name)) {
      return Error("morph-name", "a target's name is empty or not UTF-8");
    }
    if (!seen.insert(name).second) {
      return Error("morph-name", fmt::format("two targets are named {}", shown(name)));
    }
  }
  const auto finite = [](const Vec3f& value) { return value.allFinite(); };
  if (!std::all_of(morphs.positions.begin(), morphs.positions.end(), finite) ||
      !std::all_of(morphs.normals.begin(), morphs.normals.end(), finite)) {
    return Error("morph-value", "a target has a value that is not finite");
  }
  return {};
}

void weights_at(const MorphWeights& weights, double seconds, std::vector<float>& at) {
  const std::size_t targets = weights.names.size();
  at.assign(targets, 0.0f);
  const int frames = weights.frame_count();
  if (frames == 0) return;
  const double last = frames - 1;
  const double place = seconds > 0 ? std::min(seconds * weights.rate, last) : 0.0;
  const auto before = static_cast<std::size_t>(std::floor(place));
  const auto after = std::min(before + 1, static_cast<std::size_t>(frames) - 1);
  const double part = place - std::floor(place);
  for (std::size_t t = 0; t < targets; ++t) {
    const double first = static_cast<double>(weights.values[before * targets + t]);
    const double second = static_cast<double>(weights.values[after * targets + t]);
    at[t] = static_cast<float>(first + (second - first) * part);
  }
}

MorphWeights cut(const MorphWeights& weights, int first, int last, int step) {
  MorphWeights part{weights.rate / step, weights.names, {}};
  if (weights.frame_count() == 0) return part;
  const std::size_t targets = weights.names.size();
  for (int frame = first; frame <= last; frame += step) {
    const auto row = std::span(weights.values).subspan(at(frame) * targets, targets);
    part.values.insert(part.values.end(), row.begin(), row.end());
  }
  return part;
}

MorphWeights weights_of_targets(const MorphWeights& weights, std::span<const std::string> names,
                                std::span<const float> rest) {
  std::vector<std::size_t> columns;  // of the targets, past the last one for those without
  for (const std::string& name : names) {
    const auto found = std::ranges::find(weights.names, name);
    columns.push_back(static_cast<std::size_t>(found - weights.names.begin()));
  }
  const std::size_t stride = weights.names.size();
  const auto is_given = [stride](std::size_t column) { return column < stride; };
  if (std::ranges::none_of(columns, is_given)) return {};
  MorphWeights own{weights.rate, {names.begin(), names.end()}, {}};
  for (std::size_t row = 0; row < weights.values.size(); row += stride) {
    for (std::size_t t = 0; t < columns.size(); ++t) {
      const float at_rest = t < rest.size() ? rest[t] : 0.0f;
      own.values.push_back(is_given(columns[t]) ? weights.values[row + columns[t]] : at_rest);
    }
  }
  return own;
}

}  // namespace krok
