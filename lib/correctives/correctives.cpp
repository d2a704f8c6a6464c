#include "correctives/correctives.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <set>

#include "core/index.h"
#include "math/quaternion.h"

namespace krok {

namespace {

// 4 tan(angle / 4) times the axis, for w >= 0.
Vec3 rodrigues(const Quat& q) {
  return q.vec() * (4 / (1 + q.w()));
}

Error shape(const JointCorrective& of, std::string_view what) {
  Error error("correctives-shape", fmt::format("the correctives of {} {}", of.joint, what),
              "create the file again with krok-fit");
  error.joint = of.joint;
  return error;
}

bool is_finite(const std::vector<Vec3f>& vectors) {
  return std::ranges::all_of(vectors, [](const Vec3f& v) { return v.allFinite(); });
}

Status check(const JointCorrective& of, int vertex_count) {
  if (of.joint.empty()) return shape(of, "have no joint");
  const auto d = of.directions.size();
  const std::size_t parameters = d + (of.squares ? d * (d + 1) / 2 : 0);
  if (d < 1 || d > 3 || parameters != at(std::max(0, of.weights.dimensions))) {
    return shape(of, "have weights of other parameters");
  }
  if (Status status = of.weights.check(); !status) return status;
  const std::size_t values = at(of.target_count()) * of.vertices.size();
  if (of.target_count() < 1 || of.offsets.size() != values ||
      (!of.normal_offsets.empty() && of.normal_offsets.size() != values)) {
    return shape(of, "do not have the offsets of each vertex for each target");
  }
  for (std::size_t i = 0; i < of.vertices.size(); ++i) {
    if (of.vertices[i] >= static_cast<std::uint32_t>(vertex_count) ||
        (i > 0 && of.vertices[i] <= of.vertices[i - 1])) {
      return shape(of, "have vertices that do not exist, or not in order");
    }
  }
  bool finite =
      is_finite(of.offsets) && is_finite(of.normal_offsets) && std::abs(of.axis.norm() - 1) < 1e-6;
  for (const Vec3& direction : of.directions) {
    finite = finite && std::abs(direction.norm() - 1) < 1e-6;
  }
  if (finite) return {};
  Error error = shape(of, "have offsets that are not finite, or axes that are not of length 1");
  error.code = "correctives-value";
  return error;
}

}  // namespace

Vec3 swing_and_twist(const Vec3& axis, const Quat& reference, const Quat& joint_to_parent) {
  Quat q = normalized_or_identity(reference.conjugate() * joint_to_parent);
  if (q.w() < 0) q.coeffs() = -q.coeffs();
  Quat twist(q.w(), 0, 0, 0);
  twist.vec() = axis * q.vec().dot(axis);
  twist = normalized_or_identity(twist);
  Quat swing = q * twist.conjugate();
  if (swing.w() < 0) swing.coeffs() = -swing.coeffs();
  return rodrigues(swing) + rodrigues(twist);
}

Vec3 bone_axis(const Skeleton& skeleton, int joint) {
  Vec3 sum = Vec3::Zero();
  for (int j = joint + 1; j < skeleton.joint_count(); ++j) {
    if (skeleton.parents[at(j)] == joint) sum += skeleton.reference_local(j).position;
  }
  return sum.norm() > 1e-9 ? Vec3(sum.normalized()) : Vec3::UnitY();
}

void JointCorrective::parameters(const Quat& reference, const Quat& joint_to_parent,
                                 std::span<double> out) const {
  const Vec3 rotation = swing_and_twist(axis, reference, joint_to_parent);
  const std::size_t d = directions.size();
  for (std::size_t a = 0; a < d; ++a) {
    out[a] = std::clamp(directions[a].dot(rotation), weights.lower[a], weights.upper[a]);
  }
  if (!squares) return;
  std::size_t next = d;
  for (std::size_t a = 0; a < d; ++a) {
    for (std::size_t b = a; b < d; ++b) out[next++] = out[a] * out[b];
  }
}

int Correctives::target_count() const {
  int count = 0;
  for (const JointCorrective& joint : joints) count += joint.target_count();
  return count;
}

Status check(const Correctives& correctives) {
  std::set<std::string_view> names;
  for (const JointCorrective& joint : correctives.joints) {
    if (Status status = check(joint, correctives.vertex_count); !status) return status;
    if (!names.insert(joint.joint).second) return shape(joint, "are there twice");
  }
  return {};
}

MorphSet targets_of(const Correctives& correctives, const Model& model) {
  assert(correctives.vertex_count == model.vertex_count());
  MorphSet morphs;
  morphs.vertex_count = model.vertex_count();
  for (const JointCorrective& joint : correctives.joints) {
    for (int t = 0; t < joint.target_count(); ++t) {
      morphs.names.push_back(fmt::format("{}_{}", joint.joint, t + 1));
      const std::size_t first = morphs.positions.size();
      morphs.positions.insert(morphs.positions.end(), model.positions.begin(),
                              model.positions.end());
      morphs.normals.insert(morphs.normals.end(), model.normals.begin(), model.normals.end());
      const std::size_t from = at(t) * joint.vertices.size();
      for (std::size_t i = 0; i < joint.vertices.size(); ++i) {
        const std::size_t to = first + joint.vertices[i];
        morphs.positions[to] += joint.offsets[from + i];
        if (model.normals.empty() || joint.normal_offsets.empty()) continue;
        const Vec3f normal = morphs.normals[to] + joint.normal_offsets[from + i];
        if (normal.norm() > 1e-3f) morphs.normals[to] = normal.normalized();
      }
    }
  }
  return morphs;
}

Result<CorrectiveWeights> CorrectiveWeights::create(const Correctives& correctives,
                                                    const Skeleton& skeleton) {
  if (Status status = check(correctives); !status) return status.error();
  CorrectiveWeights made;
  made.target_count_ = krok::at(correctives.target_count());
  for (const JointCorrective& of : correctives.joints) {
    const int joint = skeleton.find(of.joint);
    if (joint < 0) {
      Error error("correctives-joint",
                  fmt::format("the skeleton has no joint {}, whose rotation the correctives need",
                              of.joint),
                  "use correctives that were fitted to this model");
      error.joint = of.joint;
      return error;
    }
    auto evaluator = rbf::WeightEvaluator::create(of.weights);
    if (!evaluator) return evaluator.error();
    JointCorrective plain{of.joint, of.axis, of.directions, of.squares, of.weights, {}, {}, {}};
    made.joints_.push_back({joint, skeleton.parents[krok::at(joint)],
                            skeleton.reference_local(joint).orientation, std::move(plain),
                            *std::move(evaluator)});
  }
  return made;
}

void CorrectiveWeights::at(std::span<const Transform> joint_to_world,
                           std::span<float> weights) const {
  std::array<double, rbf::kMaxDimensions> parameters{};
  std::array<double, rbf::kMaxExamples> values;
  std::size_t next = 0;
  for (const Joint& of : joints_) {
    const Quat& own = joint_to_world[krok::at(of.joint)].orientation;
    const Quat local =
        of.parent < 0 ? own : joint_to_world[krok::at(of.parent)].orientation.conjugate() * own;
    const auto dimensions = krok::at(of.corrective.weights.dimensions);
    const auto examples = krok::at(of.corrective.weights.examples);
    of.corrective.parameters(of.reference, local, std::span(parameters).first(dimensions));
    of.evaluator.weights(std::span(parameters).first(dimensions),
                         std::span(values).first(examples));
    for (std::size_t i = 1; i < examples; ++i) {
      weights[next++] = static_cast<float>(
          std::clamp(values[i], Correctives::kMinWeight, Correctives::kMaxWeight));
    }
  }
}

}  // namespace krok
