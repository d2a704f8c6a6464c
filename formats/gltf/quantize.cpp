#include "formats/gltf/quantize.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "formats/gltf/mesh_shape_internal.h"
#include "formats/gltf/quantize_internal.h"
#include "scene/influences.h"

namespace krok::gltf {

namespace {

using Use = Document::Use;

constexpr double kShorts = 65535;

// Weights in whole steps that sum to kShorts: rounded down, the rest goes to those that lost most.
void quantize_weights(std::span<const float> weights, std::span<std::uint16_t> steps) {
  std::array<double, Model::kMaxInfluences> lost{};
  std::array<std::size_t, Model::kMaxInfluences> order{};
  int left = static_cast<int>(kShorts);
  double sum = 0;
  for (const float weight : weights) sum += static_cast<double>(weight);
  for (std::size_t k = 0; k < weights.size(); ++k) {
    const double exact = static_cast<double>(weights[k]) / sum * kShorts;
    steps[k] = static_cast<std::uint16_t>(std::min(exact, kShorts));
    lost[k] = exact - steps[k];
    order[k] = k;
    left -= steps[k];
  }
  const auto end = order.begin() + static_cast<std::ptrdiff_t>(weights.size());
  std::stable_sort(order.begin(), end,
                   [&](std::size_t a, std::size_t b) { return lost[a] > lost[b]; });
  for (std::size_t k = 0; left > 0; k = (k + 1) % weights.size(), --left) ++steps[order[k]];
}

std::array<std::uint16_t, 3> steps_of(const Vec3f& position, const PositionGrid& grid) {
  std::array<std::uint16_t, 3> steps{};
  for (int c = 0; c < 3; ++c) {
    const double place = (static_cast<double>(position[c]) - grid.corner[c]) / grid.step;
    steps[static_cast<std::size_t>(c)] =
        static_cast<std::uint16_t>(std::clamp(std::round(place), 0.0, kShorts));
  }
  return steps;
}

std::int8_t byte_of(float value) {
  return static_cast<std::int8_t>(std::lround(std::clamp(value, -1.0f, 1.0f) * 127.0f));
}

// Vectors of up to unit length as bytes, four to a vertex.
std::vector<std::int8_t> bytes_of_vectors(std::span<const Vec3f> vectors) {
  std::vector<std::int8_t> bytes;
  for (const Vec3f& vector : vectors) {
    for (int c = 0; c < 3; ++c) bytes.push_back(byte_of(vector[c]));
    bytes.push_back(0);
  }
  return bytes;
}

int add_bytes(Document& document, std::span<const std::int8_t> bytes, int type) {
  return document.add_strided(std::as_bytes(bytes), 4, TINYGLTF_COMPONENT_TYPE_BYTE, type, true);
}

void set_bounds(tinygltf::Accessor& accessor, std::span<const std::array<double, 3>> values) {
  accessor.minValues.assign(values[0].begin(), values[0].end());
  accessor.maxValues = accessor.minValues;
  for (const auto& value : values) {
    for (std::size_t c = 0; c < 3; ++c) {
      accessor.minValues[c] = std::min(accessor.minValues[c], value[c]);
      accessor.maxValues[c] = std::max(accessor.maxValues[c], value[c]);
    }
  }
}

// Whole numbers, three to a vertex and padded to four; with bounds.
template <typename Number>
int add_steps(Document& document, std::span<const std::array<Number, 3>> values, int component) {
  std::vector<Number> padded;
  std::vector<std::array<double, 3>> exact;
  for (const auto& value : values) {
    padded.insert(padded.end(), value.begin(), value.end());
    padded.push_back(0);
    exact.push_back({double(value[0]), double(value[1]), double(value[2])});
  }
  const int accessor = document.add_strided(std::as_bytes(std::span(padded)), 4 * sizeof(Number),
                                            component, TINYGLTF_TYPE_VEC3, false);
  set_bounds(document.gltf.accessors[static_cast<std::size_t>(accessor)], exact);
  return accessor;
}

void add_texture_coordinates(Document& document, const Model& model,
                             std::map<std::string, int>& attributes) {
  const auto& coordinates = model.texture_coordinates;
  if (coordinates.empty()) return;
  const bool inside = std::ranges::all_of(
      coordinates, [](const Vec2f& c) { return c.minCoeff() >= 0.0f && c.maxCoeff() <= 1.0f; });
  if (!inside) {
    attributes["TEXCOORD_0"] =
        document.add_floats({coordinates.data()->data(), coordinates.size() * 2},
                            TINYGLTF_TYPE_VEC2, Use::vertices, false);
    return;
  }
  std::vector<std::uint16_t> steps;
  for (const Vec2f& c : coordinates) {
    for (int k = 0; k < 2; ++k) {
      steps.push_back(static_cast<std::uint16_t>(std::lround(c[k] * static_cast<float>(kShorts))));
    }
  }
  attributes["TEXCOORD_0"] =
      document.add_strided(std::as_bytes(std::span(steps)), 4,
                           TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT, TINYGLTF_TYPE_VEC2, true);
}

void add_quantized_influences(Document& document, const Model& model,
                              std::map<std::string, int>& attributes) {
  const auto places = static_cast<std::size_t>(model.influences_per_vertex);
  const auto count = static_cast<std::size_t>(model.vertex_count());
  const auto largest = static_cast<std::uint32_t>(model.skeleton.joint_count() - 1);
  std::vector<std::uint16_t> steps(count * places);
  for (std::size_t v = 0; v < count; ++v) {
    quantize_weights(std::span(model.influence_weights).subspan(v * places, places),
                     std::span(steps).subspan(v * places, places));
  }
  for (std::size_t set = 0; set * 4 < places; ++set) {
    std::vector<std::uint32_t> joints(count * 4, 0);
    std::vector<std::uint16_t> weights(count * 4, 0);
    for (std::size_t v = 0; v < count; ++v) {
      for (std::size_t k = set * 4; k < std::min(places, set * 4 + 4); ++k) {
        weights[v * 4 + k % 4] = steps[v * places + k];
        if (steps[v * places + k] > 0)
          joints[v * 4 + k % 4] = model.influence_joints[v * places + k];
      }
    }
    attributes[fmt::format("JOINTS_{}", set)] =
        document.add_integers(joints, TINYGLTF_TYPE_VEC4, largest, Use::vertices);
    attributes[fmt::format("WEIGHTS_{}", set)] =
        document.add_strided(std::as_bytes(std::span(weights)), 8,
                             TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT, TINYGLTF_TYPE_VEC4, true);
  }
}

}  // namespace

PositionGrid PositionGrid::of(std::span<const Vec3f> positions) {
  Eigen::AlignedBox3d box;
  for (const Vec3f& position : positions) box.extend(position.cast<double>());
  const double longest = box.isEmpty() ? 0.0 : box.sizes().maxCoeff();
  return {box.isEmpty() ? Vec3(Vec3::Zero()) : box.min(), longest > 0 ? longest / kShorts : 1.0};
}

Mat4 PositionGrid::to_model() const {
  Mat4 result = Mat4::Identity();
  result.topLeftCorner<3, 3>() *= step;
  result.topRightCorner<3, 1>() = corner;
  return result;
}

std::map<std::string, int> add_quantized_shape(Document& document, const Model& model,
                                               const PositionGrid& grid) {
  std::map<std::string, int> attributes;
  std::vector<std::array<std::uint16_t, 3>> steps;
  for (const Vec3f& position : model.positions) steps.push_back(steps_of(position, grid));
  attributes["POSITION"] =
      add_steps<std::uint16_t>(document, steps, TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT);
  if (!model.normals.empty()) {
    attributes["NORMAL"] =
        add_bytes(document, bytes_of_vectors(unit_vectors(model.normals)), TINYGLTF_TYPE_VEC3);
  }
  if (!model.tangents.empty()) {
    std::vector<std::int8_t> bytes;
    for (const Vec4f& tangent : model.tangents) {
      const Vec3f direction = tangent.head<3>().stableNormalized();
      for (int c = 0; c < 3; ++c) bytes.push_back(byte_of(direction[c]));
      bytes.push_back(tangent.w() < 0 ? std::int8_t{-127} : std::int8_t{127});
    }
    attributes["TANGENT"] = add_bytes(document, bytes, TINYGLTF_TYPE_VEC4);
  }
  add_texture_coordinates(document, model, attributes);
  add_quantized_influences(document, model, attributes);
  return attributes;
}

std::map<std::string, int> add_quantized_target(Document& document, const Model& model,
                                                const MorphSet& morphs, int target,
                                                const PositionGrid& grid) {
  std::map<std::string, int> attributes;
  const auto positions = morphs.target_positions(target);
  std::vector<std::array<std::int16_t, 3>> steps(positions.size());
  bool fits = true;
  std::vector<Vec3f> exact(positions.size());
  for (std::size_t v = 0; v < positions.size(); ++v) {
    // Against the rounded base, so that a whole target is off by half a step.
    const auto base = steps_of(model.positions[v], grid);
    for (int c = 0; c < 3; ++c) {
      const double place = (static_cast<double>(positions[v][c]) - grid.corner[c]) / grid.step -
                           base[static_cast<std::size_t>(c)];
      const bool still = positions[v][c] == model.positions[v][c];
      fits = fits && std::abs(place) < 32767;
      exact[v][c] = still ? 0.0f : static_cast<float>(place);
      steps[v][static_cast<std::size_t>(c)] =
          still ? std::int16_t{0}
                : static_cast<std::int16_t>(std::clamp(std::round(place), -32767.0, 32767.0));
    }
  }
  attributes["POSITION"] =
      fits ? add_steps<std::int16_t>(document, steps, TINYGLTF_COMPONENT_TYPE_SHORT)
           : document.add_positions(exact);
  if (morphs.normals.empty() || model.normals.empty()) return attributes;
  const auto normals = morphs.target_normals(target);
  std::vector<Vec3f> turns(normals.size());
  for (std::size_t v = 0; v < normals.size(); ++v) turns[v] = normals[v] - model.normals[v];
  const bool small = std::ranges::all_of(
      turns, [](const Vec3f& turn) { return turn.cwiseAbs().maxCoeff() <= 1.0f; });
  attributes["NORMAL"] = small ? add_bytes(document, bytes_of_vectors(turns), TINYGLTF_TYPE_VEC3)
                               : document.add_vectors(turns);
  return attributes;
}

Model quantized(const Model& model) {
  Model result = model;
  const PositionGrid grid = PositionGrid::of(model.positions);
  for (Vec3f& position : result.positions) {
    const auto steps = steps_of(position, grid);
    position = (grid.corner + grid.step * Vec3(steps[0], steps[1], steps[2])).cast<float>();
  }
  const auto places = static_cast<std::size_t>(model.influences_per_vertex);
  std::vector<std::uint16_t> steps(places);
  for (std::size_t v = 0; v < result.positions.size(); ++v) {
    const std::span weights = std::span(result.influence_weights).subspan(v * places, places);
    quantize_weights(weights, steps);
    for (std::size_t k = 0; k < places; ++k) {
      weights[k] = static_cast<float>(steps[k] / kShorts);
      if (steps[k] == 0) result.influence_joints[v * places + k] = 0;
    }
  }
  return result;
}

double quantization_bound(const Model& model) {
  return 0.5 * std::sqrt(3.0) * PositionGrid::of(model.positions).step;
}

}  // namespace krok::gltf
