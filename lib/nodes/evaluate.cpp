#include "nodes/evaluate.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "math/dense_solve.h"
#include "math/quaternion.h"

namespace krok::nodes {

namespace {

using Affine = Eigen::Matrix<double, 3, 4>;

constexpr std::size_t kMaxVertices = 20'000'000;

Mat4 matrix_of(const Vec3& translation, const Quat& rotation, const Vec3& scale) {
  Mat4 matrix = Mat4::Identity();
  matrix.topLeftCorner<3, 3>() = rotation.toRotationMatrix() * scale.asDiagonal();
  matrix.topRightCorner<3, 1>() = translation;
  return matrix;
}

Mat3 rotation_part(const Mat3& linear) {
  // A flattened matrix does not mirror, whatever rounding makes of its determinant.
  const double volume = linear.col(0).norm() * linear.col(1).norm() * linear.col(2).norm();
  const double sign = linear.determinant() < -1e-12 * volume ? -1.0 : 1.0;
  Mat3 unit = sign * linear;
  bool vanishes = false;
  for (int c = 0; c < 3; ++c) {
    const double length = unit.col(c).norm();
    vanishes = vanishes || !(length > 1e-150);
    if (!vanishes) unit.col(c) /= length;
  }
  const double skew = vanishes ? 1.0 : (unit.transpose() * unit - Mat3::Identity()).norm();
  if (skew < 1e-9) return unit;
  if (!linear.allFinite()) return Mat3::Identity();
  return nearest_rotation(sign * linear);
}

// Adds weighted displacements to positions, normals or the xyz of tangents.
template <typename Vector>
void add_targets(const Primitive& primitive, std::span<const double> weights,
                 Shared<Vec3f> MorphTarget::*which, std::vector<Vector>& values) {
  if (values.empty()) return;
  for (std::size_t t = 0; t < primitive.targets.size(); ++t) {
    const Shared<Vec3f>& displacements = primitive.targets[t].*which;
    const double weight = weights[t];
    if (weight == 0 || !displacements) continue;
    for (std::size_t v = 0; v < values.size(); ++v) {
      values[v].template head<3>() += weight * (*displacements)[v].cast<double>();
    }
  }
}

template <typename From, typename To>
void load_vectors(const Shared<From>& source, std::vector<To>& values) {
  values.resize(source ? source->size() : 0);
  for (std::size_t v = 0; v < values.size(); ++v) {
    values[v] = (*source)[v].template cast<double>();
  }
}

// The vertex data of an instance; normals and tangents may be empty.
struct Vertices {
  std::vector<Vec3>& positions;
  std::vector<Vec3>& normals;
  std::vector<Vec4>& tangents;
};

void turn(const Mat3& linear, bool mirrors, Vec4& tangent) {
  tangent.head<3>() = linear * tangent.head<3>();
  if (mirrors) tangent.w() = -tangent.w();
}

void skin(const Primitive& primitive, const std::vector<Affine>& palette, const Vertices& out) {
  auto& [positions, normals, tangents] = out;
  const auto per_vertex = static_cast<std::size_t>(primitive.influences_per_vertex);
  for (std::size_t v = 0; v < positions.size(); ++v) {
    Affine blended = Affine::Zero();
    for (std::size_t k = v * per_vertex; k < (v + 1) * per_vertex; ++k) {
      const auto weight = static_cast<double>(primitive.influence_weights[k]);
      if (weight != 0) blended += weight * palette[primitive.influence_joints[k]];
    }
    positions[v] = blended.leftCols<3>() * positions[v] + blended.col(3);
    if (!normals.empty()) normals[v] = blended.leftCols<3>() * normals[v];
    if (tangents.empty()) continue;
    const Mat3 linear = blended.leftCols<3>();
    turn(linear, linear.determinant() < 0, tangents[v]);
  }
}

void fill_palette(const Skin& skin, const std::vector<Mat4>& node_to_world,
                  std::vector<Affine>& palette) {
  palette.resize(skin.joints.size());
  for (std::size_t j = 0; j < skin.joints.size(); ++j) {
    palette[j] = (node_to_world[static_cast<std::size_t>(skin.joints[j])] * skin.inverse_binds[j])
                     .topRows<3>();
  }
}

// The inverse transpose of a linear map up to a positive factor, without division.
Mat3 cofactors_of(const Mat3& linear) {
  Mat3 cofactors;
  for (int c = 0; c < 3; ++c) {
    cofactors.col(c) = linear.col((c + 1) % 3).cross(linear.col((c + 2) % 3));
  }
  return linear.determinant() < 0 ? Mat3(-cofactors) : cofactors;
}

void place(const Mat4& node_to_world, const Vertices& out) {
  if (node_to_world == Mat4::Identity()) return;
  const Mat3 linear = node_to_world.topLeftCorner<3, 3>();
  const Vec3 offset = node_to_world.topRightCorner<3, 1>();
  const Mat3 cofactors = cofactors_of(linear);
  const bool mirrors = linear.determinant() < 0;
  for (Vec3& position : out.positions) position = linear * position + offset;
  for (Vec3& normal : out.normals) normal = cofactors * normal;
  for (Vec4& tangent : out.tangents) turn(linear, mirrors, tangent);
}

// Normalises normals or the xyz of tangents unless they are zero.
template <typename Vector>
void normalize(std::vector<Vector>& vectors) {
  constexpr double kNearUnit = 1e-5;
  for (Vector& vector : vectors) {
    auto normal = vector.template head<3>();
    const double square = normal.squaredNorm();
    const double excess = square - 1;
    if (std::abs(excess) < kNearUnit) {
      // Nearly unit, as in files: 1 / sqrt(1 + excess) as a series with an error below 1e-15.
      normal *= 1 - excess * (0.5 - 0.375 * excess);
    } else if (square > 1e-200 && square < 1e200) {
      normal /= std::sqrt(square);
    } else if (const double length = normal.stableNorm(); length > 0) {
      normal /= length;
    }
  }
}

// Directions of vertices, to be placed as vertices are.
struct Directions {
  std::vector<Vec3> positions, normals;
  std::vector<Vec4> tangents;

  template <typename Tangents>
  Directions(std::size_t vertices, const Shared<Vec3f>& from_positions,
             const Shared<Vec3f>& from_normals, const Tangents& from_tangents) {
    load_vectors(from_positions, positions);
    positions.resize(vertices, Vec3::Zero());
    load_vectors(from_normals, normals);
    for (std::size_t v = 0; from_tangents && v < vertices; ++v) {
      tangents.emplace_back(Vec4::Zero());
      tangents[v].template head<3>() =
          (*from_tangents)[v].template head<3>().template cast<double>();
    }
  }
};

// Displacements in lengths of what they displace.
template <typename Vector>
void in_lengths(const std::vector<Vector>& displacements, const std::vector<Vector>& displaced,
                std::vector<Vec3f>& out) {
  out.resize(displacements.size());
  for (std::size_t v = 0; v < out.size(); ++v) {
    const double length = displaced.empty() ? 0 : displaced[v].template head<3>().norm();
    const Vec3 change = displacements[v].template head<3>();
    out[v] = (length > 0 ? Vec3(change / length) : change).template cast<float>();
  }
}

}  // namespace

Transform rigid_part(const Mat4& matrix) {
  const Mat3 rotation = rotation_part(matrix.topLeftCorner<3, 3>());
  return {matrix.topRightCorner<3, 1>(), normalized_or_identity(Quat(rotation))};
}

Result<Evaluator> Evaluator::create(const Scene& scene) {
  Evaluator evaluator(scene);
  evaluator.order_nodes();
  if (auto found = evaluator.find_instances(); !found) return found.error();
  evaluator.find_joints();
  return evaluator;
}

const Primitive& Evaluator::primitive(const Instance& instance) const {
  return scene_->meshes[static_cast<std::size_t>(instance.mesh)]
      .primitives[static_cast<std::size_t>(instance.primitive)];
}

// Depth first through the scene, so that instances have the order of an outliner; then the nodes
// outside of it.
void Evaluator::order_nodes() {
  const auto& nodes = scene_->nodes;
  std::vector<int> pending(scene_->roots.rbegin(), scene_->roots.rend());
  const auto visit = [&] {
    while (!pending.empty()) {
      const int node = pending.back();
      pending.pop_back();
      order_.push_back(node);
      const auto& children = nodes[static_cast<std::size_t>(node)].children;
      pending.insert(pending.end(), children.rbegin(), children.rend());
    }
  };
  visit();
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    if (nodes[i].parent == -1 && !nodes[i].in_scene) pending.push_back(static_cast<int>(i));
  }
  visit();
}

Status Evaluator::find_instances() {
  std::size_t vertices = 0;
  for (const int index : order_) {
    const Node& node = scene_->nodes[static_cast<std::size_t>(index)];
    if (!node.in_scene || node.mesh < 0) continue;
    const Mesh& mesh = scene_->meshes[static_cast<std::size_t>(node.mesh)];
    for (std::size_t p = 0; p < mesh.primitives.size(); ++p) {
      instances_.push_back({index, node.mesh, static_cast<int>(p)});
      vertices += mesh.primitives[p].vertex_count();
    }
    if (vertices > kMaxVertices) {
      return Error("scene-too-large",
                   fmt::format("the scene has more than {} vertices", kMaxVertices));
    }
  }
  return {};
}

void Evaluator::find_joints() {
  const auto& nodes = scene_->nodes;
  std::vector<char> is_joint(nodes.size(), 0);
  for (const Skin& one : scene_->skins) {
    for (const int joint : one.joints) is_joint[static_cast<std::size_t>(joint)] = 1;
  }
  if (scene_->skins.empty() && instances_.empty()) {
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      const Node& node = nodes[i];
      is_joint[i] = node.in_scene && node.camera < 0 && !node.fixture ? 1 : 0;
    }
  }
  // For each node the index in joints_ of itself or its nearest ancestor that is a joint.
  std::vector<int> nearest(nodes.size(), -1);
  for (const int index : order_) {
    const auto i = static_cast<std::size_t>(index);
    const int parent = nodes[i].parent;
    const int above = parent < 0 ? -1 : nearest[static_cast<std::size_t>(parent)];
    nearest[i] = above;
    if (!is_joint[i]) continue;
    nearest[i] = static_cast<int>(joints_.size());
    joints_.push_back(index);
    joint_parents_.push_back(above);
  }
}

std::vector<double> Evaluator::key_times(int animation) const {
  std::vector<double> times;
  std::vector<const std::vector<float>*> seen;  // channels often share their times
  for (const Channel& channel : scene_->animations[static_cast<std::size_t>(animation)].channels) {
    if (std::find(seen.begin(), seen.end(), channel.times.get()) != seen.end()) continue;
    seen.push_back(channel.times.get());
    const std::size_t middle = times.size();
    times.insert(times.end(), channel.times->begin(), channel.times->end());
    std::inplace_merge(times.begin(), times.begin() + static_cast<std::ptrdiff_t>(middle),
                       times.end());
    times.erase(std::unique(times.begin(), times.end()), times.end());
  }
  return times;
}

namespace {

// What is nearer to 1, or to a uniform scale, is rounding.
constexpr double kSameScale = 1e-6;

// A node that takes over its parent's scale along its own axes. `turn` is the parent's rotation to
// the world, `above` all of its linear part.
Mat3 along_own_axes(const Mat3& turn, const Mat3& above, const Quat& rotation, const Vec3& scale,
                    const Mat3& to_parent) {
  const Mat3 parent_scale = turn.transpose() * above;
  const Mat3 uniform = parent_scale.trace() / 3 * Mat3::Identity();
  if ((parent_scale - uniform).norm() <= kSameScale * parent_scale.norm()) return above * to_parent;
  return turn * rotation.toRotationMatrix() * parent_scale * scale.asDiagonal();
}

// A node that its parent's scale places but does not reach.
Mat3 compensated(const Mat3& above, const Vec3& parent_scale, const Mat3& to_parent) {
  if ((parent_scale - Vec3::Ones()).cwiseAbs().maxCoeff() <= kSameScale) return above * to_parent;
  constexpr double kMin = 1e-9;
  const Vec3 compensation =
      parent_scale.unaryExpr([](double value) { return std::abs(value) < kMin ? 1 : 1 / value; });
  return above * compensation.asDiagonal() * to_parent;
}

}  // namespace

void Evaluator::place_nodes(int animation, double time, Evaluation& out) const {
  const auto& nodes = scene_->nodes;
  out.node_translations.resize(nodes.size());
  out.node_rotations.resize(nodes.size());
  out.node_scales.resize(nodes.size());
  out.node_weights.resize(nodes.size());
  out.node_to_world.resize(nodes.size());
  std::vector<char> moved(nodes.size(), 0);
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    const Node& node = nodes[i];
    out.node_translations[i] = node.translation;
    out.node_rotations[i] = node.rotation;
    out.node_scales[i] = node.scale;
    if (node.mesh >= 0) {
      out.node_weights[i] = node.weights.empty()
                                ? scene_->meshes[static_cast<std::size_t>(node.mesh)].weights
                                : node.weights;
    }
    if (node.has_matrix) {
      const Transform rigid = rigid_part(node.matrix);
      const Mat3 linear = node.matrix.topLeftCorner<3, 3>();
      out.node_translations[i] = rigid.position;
      out.node_rotations[i] = rigid.orientation;
      out.node_scales[i] = (rigid.orientation.toRotationMatrix().transpose() * linear).diagonal();
    }
  }
  if (animation >= 0) {
    for (const Channel& channel :
         scene_->animations[static_cast<std::size_t>(animation)].channels) {
      const auto i = static_cast<std::size_t>(channel.node);
      out.values.resize(static_cast<std::size_t>(channel.width));
      sample(channel, time, out.values);
      const auto& value = out.values;
      if (channel.path == Path::weights) {
        out.node_weights[i] = value;
        continue;
      }
      moved[i] = 1;
      if (channel.path == Path::translation) {
        out.node_translations[i] = Vec3(value[0], value[1], value[2]);
      } else if (channel.path == Path::rotation) {
        out.node_rotations[i] = Quat(value[3], value[0], value[1], value[2]);
      } else {
        out.node_scales[i] = Vec3(value[0], value[1], value[2]);
      }
    }
  }
  const bool own_scales = std::ranges::any_of(
      nodes, [](const Node& node) { return node.parent_scale != Node::ParentScale::inherited; });
  std::vector<Mat3> turned(own_scales ? nodes.size() : 0);  // to the world, without scale
  for (const int index : order_) {
    const auto i = static_cast<std::size_t>(index);
    const Node& node = nodes[i];
    if (own_scales) {
      const Mat3 turn = out.node_rotations[i].toRotationMatrix();
      turned[i] =
          node.parent < 0 ? turn : Mat3(turned[static_cast<std::size_t>(node.parent)] * turn);
    }
    const Mat4 to_parent =
        node.has_matrix && !moved[i]
            ? node.matrix
            : matrix_of(out.node_translations[i], out.node_rotations[i], out.node_scales[i]);
    out.node_to_world[i] =
        node.parent < 0
            ? to_parent
            : Mat4(out.node_to_world[static_cast<std::size_t>(node.parent)] * to_parent);
    if (node.parent < 0 || node.parent_scale == Node::ParentScale::inherited) continue;
    const auto parent = static_cast<std::size_t>(node.parent);
    const Mat3 above = out.node_to_world[parent].topLeftCorner<3, 3>();
    const Mat3 linear = to_parent.topLeftCorner<3, 3>();
    out.node_to_world[i].topLeftCorner<3, 3>() =
        node.parent_scale == Node::ParentScale::compensated
            ? compensated(above, out.node_scales[parent], linear)
            : along_own_axes(turned[parent], above, out.node_rotations[i], out.node_scales[i],
                             linear);
  }
}

void Evaluator::evaluate_instance(std::size_t index, Evaluation& out) const {
  const Instance& instance = instances_[index];
  const Primitive& shape = primitive(instance);
  const Node& node = scene_->nodes[static_cast<std::size_t>(instance.node)];
  const Vertices vertices{out.positions[index], out.normals[index], out.tangents[index]};
  load_vectors(shape.positions, vertices.positions);
  load_vectors(shape.normals, vertices.normals);
  load_vectors(out.with_tangents ? shape.tangents : nullptr, vertices.tangents);
  const auto& weights = out.node_weights[static_cast<std::size_t>(instance.node)];
  add_targets(shape, weights, &MorphTarget::positions, vertices.positions);
  add_targets(shape, weights, &MorphTarget::normals, vertices.normals);
  add_targets(shape, weights, &MorphTarget::tangents, vertices.tangents);

  if (node.skin >= 0 && shape.influences_per_vertex > 0) {
    // The joints alone place a skinned mesh; its own node is ignored.
    fill_palette(scene_->skins[static_cast<std::size_t>(node.skin)], out.node_to_world,
                 out.palette);
    skin(shape, out.palette, vertices);
  } else {
    place(out.node_to_world[static_cast<std::size_t>(instance.node)], vertices);
  }
  normalize(vertices.normals);
  normalize(vertices.tangents);
}

int Evaluator::winding(const Instance& instance, const Evaluation& moment) const {
  const Mat4& matrix = moment.node_to_world[static_cast<std::size_t>(instance.node)];
  const double determinant = matrix.topLeftCorner<3, 3>().determinant();
  return determinant > 0 ? 1 : determinant < 0 ? -1 : 0;
}

bool Evaluator::displace(const Instance& instance, std::size_t target, const Evaluation& moment,
                         Displacements& out) const {
  const Primitive& shape = primitive(instance);
  const Node& node = scene_->nodes[static_cast<std::size_t>(instance.node)];
  const Mat4& matrix = moment.node_to_world[static_cast<std::size_t>(instance.node)];
  const bool skinned = node.skin >= 0 && shape.influences_per_vertex > 0;
  if (!skinned && matrix.topLeftCorner<3, 3>() == Mat3::Identity()) return false;
  // Without the offsets, which directions do not have.
  Mat4 linear = matrix;
  linear.topRightCorner<3, 1>().setZero();
  std::vector<Affine> palette;
  if (skinned) {
    fill_palette(scene_->skins[static_cast<std::size_t>(node.skin)], moment.node_to_world, palette);
    for (Affine& joint : palette) joint.col(3).setZero();
  }
  const auto place_all = [&](Directions& directions) {
    const Vertices vertices{directions.positions, directions.normals, directions.tangents};
    if (skinned) {
      skin(shape, palette, vertices);
    } else {
      place(linear, vertices);
    }
  };
  const MorphTarget& from = shape.targets[target];
  Directions changes(shape.vertex_count(), from.positions, from.normals, from.tangents);
  Directions whole(shape.vertex_count(), nullptr, shape.normals, shape.tangents);
  place_all(changes);
  place_all(whole);
  out.positions.clear();
  for (const Vec3& change : changes.positions) {
    if (from.positions) out.positions.push_back(change.cast<float>());
  }
  in_lengths(changes.normals, whole.normals, out.normals);
  in_lengths(changes.tangents, whole.tangents, out.tangents);
  return true;
}

void Evaluator::evaluate(int animation, double time, Evaluation& out) const {
  place_nodes(animation, time, out);
  out.positions.resize(instances_.size());
  out.normals.resize(instances_.size());
  out.tangents.resize(instances_.size());
  for (std::size_t i = 0; i < instances_.size(); ++i) evaluate_instance(i, out);
}

}  // namespace krok::nodes
