#include "formats/gltf/quantize.h"
#include "formats/gltf/quantize_internal.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "formats/gltf/filters_internal.h"

namespace krok::gltf {

namespace {

using Use = Document::Use;

constexpr double kShorts = 65535;

// Positions are signed and normalized: -kMiddle to kMiddle are -1 to 1, with zero in the box's
// middle. As whole numbers, a skin's inverse bind matrices would have scales of about 1e-5, which
// Blender 3.4 inverts with errors of up to 15 mm.
constexpr int kMiddle = 32767;

// Steps that the weights of a vertex sum to.
int weight_steps(const Quantization& quantization) {
  if (quantization.weight_bits == 8) return 255;
  return quantization.weight_bits == 16 ? 65535 : 1 << quantization.weight_bits;
}

// Weights in whole steps that sum to `all`: rounded down, the rest goes to those that lost most.
void quantize_weights(std::span<const float> weights, int all, std::span<std::uint16_t> steps) {
  std::array<double, Model::kMaxInfluences> lost{};
  std::array<std::size_t, Model::kMaxInfluences> order{};
  int left = all;
  double sum = 0;
  for (const float weight : weights) sum += static_cast<double>(weight);
  for (std::size_t k = 0; k < weights.size(); ++k) {
    const double exact = static_cast<double>(weights[k]) / sum * all;
    steps[k] = static_cast<std::uint16_t>(std::min(exact, static_cast<double>(all)));
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
        static_cast<std::uint16_t>(std::clamp(std::round(place), 0.0, 2.0 * kMiddle));
  }
  return steps;
}

// Displacements of a morph target.
struct TargetSteps {
  std::vector<std::array<std::int16_t, 3>> whole;
  std::vector<Vec3f> exact;  // in units of kMiddle steps, where they are too long for whole steps
};

TargetSteps target_steps(std::span<const Vec3f> base, std::span<const Vec3f> positions,
                         const PositionGrid& grid) {
  TargetSteps steps{std::vector<std::array<std::int16_t, 3>>(base.size()),
                    std::vector<Vec3f>(base.size())};
  bool fits = true;
  for (std::size_t v = 0; v < base.size(); ++v) {
    // Against the rounded base, so that a whole target is off by half a step.
    const auto from = steps_of(base[v], grid);
    for (int c = 0; c < 3; ++c) {
      const double place = (static_cast<double>(positions[v][c]) - grid.corner[c]) / grid.step -
                           from[static_cast<std::size_t>(c)];
      if (positions[v][c] == base[v][c]) {
        steps.exact[v][c] = 0;
        continue;
      }
      fits = fits && std::abs(place) < kMiddle;
      steps.exact[v][c] = static_cast<float>(place / kMiddle);
      steps.whole[v][static_cast<std::size_t>(c)] = static_cast<std::int16_t>(
          std::clamp(std::round(place), -double(kMiddle), double(kMiddle)));
    }
  }
  if (fits) steps.exact.clear();
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

// Steps of 1 / kMiddle, three to a vertex and padded to four; with bounds.
int add_steps(Document& document, std::span<const std::array<std::int16_t, 3>> values) {
  std::vector<std::int16_t> padded;
  std::vector<std::array<double, 3>> exact;
  for (const auto& value : values) {
    padded.insert(padded.end(), value.begin(), value.end());
    padded.push_back(0);
    exact.push_back({double(value[0]), double(value[1]), double(value[2])});
  }
  const int accessor = document.add_strided(
      std::as_bytes(std::span(padded)), 8, TINYGLTF_COMPONENT_TYPE_SHORT, TINYGLTF_TYPE_VEC3, true);
  set_bounds(document.gltf.accessors[static_cast<std::size_t>(accessor)], exact);
  return accessor;
}

void add_texture_coordinates(Document& document, std::span<const Vec2f> coordinates,
                             const Quantization& quantization, int& attribute) {
  const std::span<const float> values(coordinates.data()->data(), coordinates.size() * 2);
  const auto is_inside = [](float value) { return value >= 0.0f && value <= 1.0f; };
  if (quantization.filtered) {
    const auto steps = exponential(values, -quantization.coordinate_bits);
    if (steps) {
      attribute = document.add_filtered(std::as_bytes(std::span(*steps)), TINYGLTF_TYPE_VEC2,
                                        Filter::exponential, Use::vertices);
      return;
    }
  }
  if (quantization.filtered || !std::ranges::all_of(values, is_inside)) {
    attribute = document.add_floats(values, TINYGLTF_TYPE_VEC2, Use::vertices, false);
    return;
  }
  std::vector<std::uint16_t> steps;
  for (const float value : values) {
    steps.push_back(static_cast<std::uint16_t>(std::lround(value * static_cast<float>(kShorts))));
  }
  attribute =
      document.add_strided(std::as_bytes(std::span(steps)), 4,
                           TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT, TINYGLTF_TYPE_VEC2, true);
}

// As 16-bit steps, unless one is outside of 0 to 1.
int add_colours(Document& document, std::span<const Vec4f> colours) {
  const std::span<const float> values(colours.data()->data(), colours.size() * 4);
  if (!std::ranges::all_of(values, [](float v) { return v >= 0.0f && v <= 1.0f; })) {
    return document.add_floats(values, TINYGLTF_TYPE_VEC4, Use::vertices, false);
  }
  std::vector<std::uint16_t> steps;
  for (const float value : values) {
    steps.push_back(static_cast<std::uint16_t>(std::lround(value * static_cast<float>(kShorts))));
  }
  return document.add_strided(std::as_bytes(std::span(steps)), 8,
                              TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT, TINYGLTF_TYPE_VEC4, true);
}

// The steps of all weights, [vertices x influences_per_vertex].
std::vector<std::uint16_t> all_weight_steps(const Model& model, const Quantization& quantization) {
  const auto places = static_cast<std::size_t>(model.influences_per_vertex);
  std::vector<std::uint16_t> steps(model.influence_weights.size());
  for (std::size_t i = 0; i < steps.size(); i += places) {
    quantize_weights(std::span(model.influence_weights).subspan(i, places),
                     weight_steps(quantization), std::span(steps).subspan(i, places));
  }
  return steps;
}

// Four weights a vertex.
int add_weights(Document& document, std::span<const std::uint16_t> steps,
                const Quantization& quantization) {
  if (quantization.weight_bits == 8) {
    const std::vector<std::uint8_t> bytes(steps.begin(), steps.end());
    return document.add_strided(std::as_bytes(std::span(bytes)), 4,
                                TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE, TINYGLTF_TYPE_VEC4, true);
  }
  if (quantization.weight_bits == 16) {
    return document.add_strided(std::as_bytes(steps), 8, TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT,
                                TINYGLTF_TYPE_VEC4, true);
  }
  std::vector<float> weights;
  for (const std::uint16_t step : steps) {
    weights.push_back(std::ldexp(static_cast<float>(step), -quantization.weight_bits));
  }
  const auto numbers = exponential(weights, -quantization.weight_bits);
  return document.add_filtered(std::as_bytes(std::span(*numbers)), TINYGLTF_TYPE_VEC4,
                               Filter::exponential, Use::vertices);
}

void add_quantized_influences(Document& document, const Model& model,
                              const Quantization& quantization,
                              std::map<std::string, int>& attributes) {
  const auto places = static_cast<std::size_t>(model.influences_per_vertex);
  const auto count = static_cast<std::size_t>(model.vertex_count());
  const auto largest = static_cast<std::uint32_t>(model.skeleton.joint_count() - 1);
  const std::vector<std::uint16_t> steps = all_weight_steps(model, quantization);
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
    attributes[fmt::format("WEIGHTS_{}", set)] = add_weights(document, weights, quantization);
  }
}

// Normals, or tangents with the sign of the fourth, as they are stored.
std::vector<std::int8_t> stored_directions(std::span<const Vec4f> directions,
                                           const Quantization& quantization) {
  if (quantization.filtered) return octahedral(directions);
  std::vector<std::int8_t> bytes;
  for (const Vec4f& direction : directions) {
    for (int c = 0; c < 3; ++c) bytes.push_back(byte_of(direction[c]));
    bytes.push_back(byte_of(direction.w()));
  }
  return bytes;
}

std::vector<Vec4f> padded(std::span<const Vec3f> vectors) {
  std::vector<Vec4f> longer;
  for (const Vec3f& vector : vectors) longer.emplace_back(vector.x(), vector.y(), vector.z(), 0.0f);
  return longer;
}

std::vector<Vec4f> unit_tangents_of(std::span<const Vec4f> tangents) {
  std::vector<Vec4f> unit;
  for (const Vec4f& tangent : tangents) {
    const Vec3f direction = tangent.head<3>().stableNormalized();
    unit.emplace_back(direction.x(), direction.y(), direction.z(), tangent.w() < 0 ? -1.f : 1.f);
  }
  return unit;
}

int add_directions(Document& document, std::span<const Vec4f> directions, int type,
                   const Quantization& quantization) {
  const std::vector<std::int8_t> bytes = stored_directions(directions, quantization);
  if (!quantization.filtered) return add_bytes(document, bytes, type);
  return document.add_filtered(std::as_bytes(std::span(bytes)), type, Filter::octahedral,
                               Use::vertices);
}

// Appends values of each vertex to its row.
class Rows {
 public:
  explicit Rows(std::size_t count) : rows_(count) {}

  template <typename Value>
  void add(std::span<const Value> values) {
    if (values.empty()) return;
    const std::size_t each = values.size() / rows_.size();
    for (std::size_t v = 0; v < rows_.size(); ++v) {
      const auto bytes = std::as_bytes(values.subspan(v * each, each));
      rows_[v].insert(rows_[v].end(), bytes.begin(), bytes.end());
    }
  }
  template <typename Value>
  void add(const std::vector<Value>& values) {
    add(std::span<const Value>(values));
  }

  VertexRows take() const {
    VertexRows all{rows_.empty() ? 0 : rows_.front().size(), {}};
    for (const auto& row : rows_) all.bytes.insert(all.bytes.end(), row.begin(), row.end());
    return all;
  }

 private:
  std::vector<std::vector<std::byte>> rows_;
};

}  // namespace

PositionGrid PositionGrid::of(std::span<const Vec3f> positions, const Quantization& quantization) {
  Eigen::AlignedBox3d box;
  for (const Vec3f& position : positions) box.extend(position.cast<double>());
  const double longest = box.isEmpty() ? 0.0 : box.sizes().maxCoeff();
  return {box.isEmpty() ? Vec3(Vec3::Zero()) : box.min(),
          longest > 0 ? std::max(longest / (2.0 * kMiddle), quantization.position_step) : 1.0};
}

Mat4 PositionGrid::to_model() const {
  Mat4 result = Mat4::Identity();
  result.topLeftCorner<3, 3>() *= kMiddle * step;
  result.topRightCorner<3, 1>() = corner + Vec3::Constant(kMiddle * step);
  return result;
}

std::map<std::string, int> add_quantized_shape(Document& document, const Model& model,
                                               const PositionGrid& grid,
                                               const Quantization& quantization) {
  std::map<std::string, int> attributes;
  std::vector<std::array<std::int16_t, 3>> steps;
  for (const Vec3f& position : model.positions) {
    auto& signed_steps = steps.emplace_back();
    std::ranges::transform(steps_of(position, grid), signed_steps.begin(), [](int from_corner) {
      return static_cast<std::int16_t>(from_corner - kMiddle);
    });
  }
  attributes["POSITION"] = add_steps(document, steps);
  if (!model.normals.empty()) {
    attributes["NORMAL"] = add_directions(document, padded(unit_vectors(model.normals)),
                                          TINYGLTF_TYPE_VEC3, quantization);
  }
  if (!model.tangents.empty()) {
    attributes["TANGENT"] = add_directions(document, unit_tangents_of(model.tangents),
                                           TINYGLTF_TYPE_VEC4, quantization);
  }
  for_each_coordinate_set(model, [&](const std::string& name, std::span<const Vec2f> set) {
    add_texture_coordinates(document, set, quantization, attributes[name]);
  });
  if (!model.colours.empty()) attributes["COLOR_0"] = add_colours(document, model.colours);
  add_quantized_influences(document, model, quantization, attributes);
  return attributes;
}

std::map<std::string, int> add_quantized_target(Document& document, const Model& model,
                                                const MorphSet& morphs, int target,
                                                const PositionGrid& grid, bool with_normals) {
  std::map<std::string, int> attributes;
  const TargetSteps steps = target_steps(model.positions, morphs.target_positions(target), grid);
  int& position = attributes["POSITION"];
  if (!steps.exact.empty()) {
    position = document.add_displacements(steps.exact, true);
  } else {
    std::vector<Vec3f> whole;
    for (const auto& step : steps.whole) whole.emplace_back(step[0], step[1], step[2]);
    position = document.add_sparse(std::move(whole), true, TINYGLTF_COMPONENT_TYPE_SHORT);
    if (position < 0) position = add_steps(document, steps.whole);
  }
  if (!with_normals) return attributes;
  const auto normals = morphs.target_normals(target);
  std::vector<Vec3f> turns(normals.size());
  for (std::size_t v = 0; v < normals.size(); ++v) turns[v] = normals[v] - model.normals[v];
  const bool small = std::ranges::all_of(
      turns, [](const Vec3f& turn) { return turn.cwiseAbs().maxCoeff() <= 1.0f; });
  int& attribute = attributes["NORMAL"];
  attribute = -1;
  if (small) {
    const auto bytes = bytes_of_vectors(turns);
    for (std::size_t v = 0; v < turns.size(); ++v) {
      for (int c = 0; c < 3; ++c) turns[v][c] = bytes[4 * v + static_cast<std::size_t>(c)];
    }
    attribute = document.add_sparse(std::move(turns), false, TINYGLTF_COMPONENT_TYPE_BYTE);
    if (attribute < 0) attribute = add_bytes(document, bytes, TINYGLTF_TYPE_VEC3);
  } else {
    attribute = document.add_displacements(std::move(turns), false);
  }
  return attributes;
}

VertexRows vertex_rows(const Model& model, const MorphSet& morphs,
                       const std::optional<Quantization>& quantization) {
  const auto count = static_cast<std::size_t>(model.vertex_count());
  Rows rows(count);
  std::vector<std::uint16_t> joints = model.influence_joints;
  if (quantization) {
    const PositionGrid grid = PositionGrid::of(model.positions, *quantization);
    const auto add_steps_of = [&](std::span<const Vec3f> positions) {
      std::vector<std::int32_t> steps;
      for (const Vec3f& position : positions) {
        for (int c = 0; c < 3; ++c) {
          const double place = (static_cast<double>(position[c]) - grid.corner[c]) / grid.step;
          steps.push_back(static_cast<std::int32_t>(std::round(std::clamp(place, -1e9, 1e9))));
        }
      }
      rows.add(steps);
    };
    add_steps_of(model.positions);
    rows.add(stored_directions(padded(unit_vectors(model.normals)), *quantization));
    rows.add(stored_directions(unit_tangents_of(model.tangents), *quantization));
    for_each_coordinate_set(model, [&](const std::string&, std::span<const Vec2f> set) {
      std::vector<float> coordinates;
      for (const Vec2f& pair : set) {
        for (const float value : pair) {
          coordinates.push_back(
              quantization->filtered ? in_steps(value, -quantization->coordinate_bits) : value);
        }
      }
      rows.add(coordinates);
    });
    const std::vector<std::uint16_t> weights = all_weight_steps(model, *quantization);
    rows.add(weights);
    for (std::size_t i = 0; i < joints.size(); ++i) {
      if (weights[i] == 0) joints[i] = 0;
    }
    for (int t = 0; t < morphs.target_count(); ++t) add_steps_of(morphs.target_positions(t));
  } else {
    rows.add(model.positions);
    rows.add(model.normals);
    rows.add(model.tangents);
    for_each_coordinate_set(model,
                            [&](const std::string&, std::span<const Vec2f> set) { rows.add(set); });
    rows.add(model.influence_weights);
    for (int t = 0; t < morphs.target_count(); ++t) rows.add(morphs.target_positions(t));
  }
  rows.add(model.colours);
  rows.add(joints);
  if (!morphs.normals.empty()) {
    for (int t = 0; t < morphs.target_count(); ++t) rows.add(morphs.target_normals(t));
  }
  return rows.take();
}

Model quantized(const Model& model, const Quantization& quantization) {
  Model result = model;
  const PositionGrid grid = PositionGrid::of(model.positions, quantization);
  for (Vec3f& position : result.positions) {
    const auto steps = steps_of(position, grid);
    position = (grid.corner + grid.step * Vec3(steps[0], steps[1], steps[2])).cast<float>();
  }
  const std::vector<std::uint16_t> steps = all_weight_steps(model, quantization);
  const double all = weight_steps(quantization);
  for (std::size_t i = 0; i < steps.size(); ++i) {
    result.influence_weights[i] = static_cast<float>(steps[i] / all);
    if (steps[i] == 0) result.influence_joints[i] = 0;
  }
  return result;
}

MorphSet quantized(const MorphSet& morphs, const Model& model, const Model& shown,
                   const Quantization& quantization) {
  MorphSet result = morphs;
  const PositionGrid grid = PositionGrid::of(model.positions, quantization);
  const std::size_t count = model.positions.size();
  for (int t = 0; t < morphs.target_count(); ++t) {
    const TargetSteps steps = target_steps(model.positions, morphs.target_positions(t), grid);
    for (std::size_t v = 0; v < count; ++v) {
      const auto& whole = steps.whole[v];
      const Vec3 moved = steps.exact.empty() ? Vec3(Vec3(whole[0], whole[1], whole[2]))
                                             : Vec3(kMiddle * steps.exact[v].cast<double>());
      result.positions[static_cast<std::size_t>(t) * count + v] =
          shown.positions[v] + (grid.step * moved).cast<float>();
    }
  }
  return result;
}

double quantization_bound(const Model& model, const Quantization& quantization) {
  return 0.5 * std::sqrt(3.0) * PositionGrid::of(model.positions, quantization).step;
}

double normal_error(const Model& model, const Quantization& quantization) {
  const std::vector<Vec4f> normals = padded(unit_vectors(model.normals));
  std::vector<std::int8_t> stored = stored_directions(normals, quantization);
  if (quantization.filtered) decode_octahedral(stored);
  double largest = 0;
  for (std::size_t v = 0; v < normals.size(); ++v) {
    const Vec3 shown(stored[4 * v], stored[4 * v + 1], stored[4 * v + 2]);
    const Vec3 normal = normals[v].head<3>().cast<double>();
    largest = std::max(largest, std::atan2(shown.cross(normal).norm(), shown.dot(normal)));
  }
  return largest;
}

}  // namespace krok::gltf
