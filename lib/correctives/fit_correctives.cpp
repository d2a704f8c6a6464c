#include "correctives/fit_correctives.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "core/index.h"
#include "core/parallel.h"
#include "rbf/weight_solver.h"
#include "skin/morph.h"

namespace krok {

namespace {

constexpr double kMinOffset = 1e-5;  // metres
constexpr double kLeastNormal = 1e-3;
constexpr double kLeastRotation = 0.1;  // see swing_and_twist()
constexpr double kDamping = 3e-4;       // added to squared singular values
constexpr double kOffsetUnit = 1e-6, kNormalUnit = 1e-4;

Vec3f rounded(const Vec3& v, double unit) {
  return ((v / unit).array().round() * unit).matrix().cast<float>();
}

// A mesh before skinning.
struct Shape {
  std::vector<Vec3f> positions, normals;
};

// The affine maps by which a method moves the vertices in a pose, found by skinning.
class PosedSkin {
 public:
  PosedSkin(const SkinBinding& binding, const Model& model, int jobs)
      : binding_(binding), pose_(binding), model_(model), jobs_(jobs) {}

  std::vector<Vec3f> positions(const SculptedPose& pose, std::span<const Vec3f> from) {
    pose_.set(pose.joint_to_world);
    std::vector<Vec3f> moved(from.size());
    skin(binding_, pose_, {from, {}, {}}, {moved, {}, {}}, jobs_);
    return moved;
  }

  // The mesh that skinning brings to the sculpt: x of the smallest |B x - sculpt|^2 + kDamping
  // |x - v|^2.
  Shape pulled_back(const SculptedPose& pose) {
    std::array<std::vector<Vec3f>, 4> moved;  // of v and v + 1 m along each axis
    for (int axis = 0; axis < 4; ++axis) {
      std::vector<Vec3f> from = model_.positions;
      if (axis > 0) {
        for (Vec3f& v : from) v += Vec3f::Unit(axis - 1);
      }
      moved[at(axis)] = positions(pose, from);
    }
    Shape shape{model_.positions, model_.normals};
    parallel_for(shape.positions.size(), 4096, jobs_, [&](std::size_t begin, std::size_t end) {
      for (std::size_t v = begin; v < end; ++v) {
        Mat3 b;
        for (int c = 0; c < 3; ++c) b.col(c) = (moved[at(c + 1)][v] - moved[0][v]).cast<double>();
        const Mat3 a = b.transpose() * b + kDamping * Mat3::Identity();
        Mat3 inverse;  // by cofactors; a is symmetric and positive definite
        inverse << a.col(1).cross(a.col(2)), a.col(2).cross(a.col(0)), a.col(0).cross(a.col(1));
        inverse /= a.col(0).dot(a.col(1).cross(a.col(2)));
        const Vec3 missing = (pose.positions[v] - moved[0][v]).cast<double>();
        const Vec3 offset = inverse * (b.transpose() * missing);
        shape.positions[v] += offset.cast<float>();
        if (pose.normals.empty() || shape.normals.empty()) continue;
        const Vec3 normal = inverse * (b.transpose() * pose.normals[v].cast<double>());
        if (normal.norm() > 1e-9) shape.normals[v] = normal.normalized().cast<float>();
      }
    });
    return shape;
  }

 private:
  const SkinBinding& binding_;
  SkinPose pose_;
  const Model& model_;
  int jobs_;
};

// The rotations' directions, see fit_correctives(); at most `most`.
std::vector<Vec3> directions_of(std::vector<Vec3> rotations, std::size_t most) {
  std::vector<Vec3> directions;
  while (directions.size() < std::min<std::size_t>(3, most)) {
    const auto longest = std::ranges::max_element(rotations, {}, &Vec3::squaredNorm);
    if (longest->norm() < kLeastRotation) break;
    const Vec3 direction = longest->normalized();
    directions.push_back(direction);
    for (Vec3& rotation : rotations) rotation -= direction * direction.dot(rotation);
  }
  return directions;
}

class JointFit {
 public:
  JointFit(const Model& model, const SculptedJoint& input, CorrectiveFit& fit, PosedSkin& skin,
           const CorrectiveFitOptions& options)
      : model_(model), input_(input), fit_(fit), skin_(skin), options_(options) {}

  Status run() {
    made_.joint = model_.skeleton.names[at(input_.joint)];
    made_.axis = bone_axis(model_.skeleton, input_.joint);
    if (input_.examples.empty()) {
      return wrong("correctives-examples", fmt::format("{} has no examples", made_.joint),
                   "give a pose and a shape for each");
    }
    auto before = CorrectiveWeights::create(fit_.correctives, model_.skeleton);
    if (!before) return before.error();
    const MorphSet targets = targets_of(fit_.correctives, model_);
    for (const auto* poses : {&input_.examples, &input_.held_out}) {
      for (const SculptedPose& pose : *poses) {
        if (Status status = add(pose, poses == &input_.held_out, *before, targets); !status) {
          return status;
        }
      }
    }
    for (int refined = 0;; ++refined) {
      if (Status status = solve(); !status) return status;
      measure();
      const auto worst = std::ranges::max_element(poses_, {}, [](const Pose& pose) {
        return pose.error.held_out ? pose.error.corrected.largest : -1;
      });
      const bool more = worst->error.held_out && refined < options_.refine &&
                        worst->error.corrected.largest > options_.max_error;
      if (!more) {
        fit_.refined.push_back(refined);
        break;
      }
      worst->error.held_out = false;
      worst->rest = difference(skin_.pulled_back(*worst->sculpt), worst->base);
      std::rotate(poses_.begin() + examples_, worst, worst + 1);
      ++examples_;
    }
    fit_.correctives.joints.push_back(std::move(made_));
    auto& errors = fit_.errors.emplace_back();
    for (Pose& pose : poses_) errors.push_back(std::move(pose.error));
    return {};
  }

 private:
  struct Pose {
    const SculptedPose* sculpt = nullptr;
    Quat local;
    Shape base;  // the model with the correctives of the joints before
    Shape rest;  // of examples: what is to be added to it, per vertex
    PoseError error;
  };

  Status wrong(std::string code, std::string message, std::string hint) const {
    Error error(std::move(code), std::move(message), std::move(hint));
    error.joint = made_.joint;
    return error;
  }

  static Shape difference(const Shape& of, const Shape& from) {
    Shape result = of;
    for (std::size_t v = 0; v < of.positions.size(); ++v) result.positions[v] -= from.positions[v];
    for (std::size_t v = 0; v < of.normals.size(); ++v) result.normals[v] -= from.normals[v];
    return result;
  }

  Status add(const SculptedPose& sculpt, bool held_out, const CorrectiveWeights& before,
             const MorphSet& targets) {
    if (sculpt.positions.size() != model_.positions.size() ||
        sculpt.joint_to_world.size() != model_.skeleton.names.size()) {
      return wrong("correctives-vertices",
                   fmt::format("{} has {} vertices, but the model has {}", sculpt.name,
                               sculpt.positions.size(), model_.positions.size()),
                   "shapes need the model's vertices in the model's order");
    }
    Pose pose;
    pose.sculpt = &sculpt;
    pose.base = {model_.positions, model_.normals};
    std::vector<float> weights(targets.names.size());
    before.at(sculpt.joint_to_world, weights);
    apply_morphs(targets, weights, {model_.positions, model_.normals},
                 {pose.base.positions, pose.base.normals}, options_.jobs);
    const int parent = model_.skeleton.parents[at(input_.joint)];
    pose.local = sculpt.joint_to_world[at(input_.joint)].orientation;
    if (parent >= 0)
      pose.local = sculpt.joint_to_world[at(parent)].orientation.conjugate() * pose.local;
    pose.error.name = sculpt.name;
    pose.error.rotation = swing_and_twist(made_.axis, reference(), pose.local);
    pose.error.held_out = held_out;
    if (!held_out) {
      pose.rest = difference(skin_.pulled_back(sculpt), pose.base);
      ++examples_;
    }
    poses_.push_back(std::move(pose));
    return {};
  }

  Quat reference() const { return model_.skeleton.reference_local(input_.joint).orientation; }
  std::span<const Pose> examples() const { return std::span(poses_).first(at(examples_)); }

  Status solve() {
    std::vector<Vec3> rotations;
    for (const Pose& pose : examples()) rotations.push_back(pose.error.rotation);
    made_.directions = directions_of(rotations, rotations.size());
    if (made_.directions.empty()) {
      return wrong("correctives-examples",
                   fmt::format("{} does not rotate in its examples", made_.joint),
                   "give poses in which it bends or twists by more than 6 degrees");
    }
    // Products of parameters where there are examples for them, and they are of full rank.
    const std::size_t d = made_.directions.size(), products = d * (d + 1) / 2;
    made_.squares = d < 3 && rotations.size() >= d + products;
    Status status = solve_weights();
    if (!status && made_.squares && status.error().code != "rbf-duplicate") {
      made_.squares = false;
      status = solve_weights();
    }
    if (!status) {
      status.error().joint = made_.joint;
      status.error().message = fmt::format("the rotations of {} in its examples: {}", made_.joint,
                                           status.error().message);
      return status;
    }
    take_offsets();
    return {};
  }

  Status solve_weights() {
    const std::size_t d = made_.directions.size();
    const std::size_t dimensions = d + (made_.squares ? d * (d + 1) / 2 : 0);
    made_.weights.lower.assign(d, 0.0);
    made_.weights.upper.assign(d, 0.0);
    for (std::size_t a = 0; a < d; ++a) {
      for (const Pose& pose : examples()) {
        const double along = made_.directions[a].dot(pose.error.rotation);
        made_.weights.lower[a] = std::min(made_.weights.lower[a], along);
        made_.weights.upper[a] = std::max(made_.weights.upper[a], along);
      }
    }
    std::vector<double> centres((examples().size() + 1) * dimensions);  // the first: reference pose
    made_.parameters(reference(), reference(), std::span(centres).first(dimensions));
    std::size_t row = 1;
    for (const Pose& pose : examples()) {
      made_.parameters(reference(), pose.local,
                       std::span(centres).subspan(row++ * dimensions, dimensions));
    }
    const auto solver = rbf::WeightSolver::create(static_cast<int>(dimensions), centres);
    if (!solver) return solver.error();
    made_.weights = solver->function();
    return {};
  }

  // The vertices that any example moves, and how.
  void take_offsets() {
    made_.vertices.clear();
    for (std::size_t v = 0; v < model_.positions.size(); ++v) {
      const bool moves = std::ranges::any_of(examples(), [&](const Pose& pose) {
        return pose.rest.positions[v].norm() > kMinOffset ||
               (!pose.rest.normals.empty() && !pose.sculpt->normals.empty() &&
                pose.rest.normals[v].norm() > kLeastNormal);
      });
      if (moves) made_.vertices.push_back(static_cast<std::uint32_t>(v));
    }
    made_.offsets.clear();
    made_.normal_offsets.clear();
    for (const Pose& pose : examples()) {
      for (const std::uint32_t v : made_.vertices) {
        made_.offsets.push_back(rounded(pose.rest.positions[v].cast<double>(), kOffsetUnit));
        if (model_.normals.empty()) continue;
        made_.normal_offsets.push_back(rounded(pose.rest.normals[v].cast<double>(), kNormalUnit));
      }
    }
  }

  void measure() {
    Correctives alone{model_.vertex_count(), fit_.correctives.method, {made_}};
    const auto weights_of = CorrectiveWeights::create(alone, model_.skeleton);
    std::vector<std::vector<Vec3f>> skinned, corrected;
    std::vector<char> counts(model_.positions.size(), 0);
    for (const std::uint32_t v : made_.vertices) counts[v] = 1;
    std::vector<float> weights(at(made_.target_count()));
    for (const Pose& pose : poses_) {
      weights_of->at(pose.sculpt->joint_to_world, weights);
      std::vector<Vec3f> shape = pose.base.positions;
      for (std::size_t t = 0; t < weights.size(); ++t) {
        for (std::size_t i = 0; i < made_.vertices.size(); ++i) {
          shape[made_.vertices[i]] += weights[t] * made_.offsets[t * made_.vertices.size() + i];
        }
      }
      skinned.push_back(skin_.positions(*pose.sculpt, model_.positions));
      corrected.push_back(skin_.positions(*pose.sculpt, shape));
      for (std::size_t v = 0; v < counts.size(); ++v) {
        if ((skinned.back()[v] - pose.sculpt->positions[v]).norm() > kMinOffset) counts[v] = 1;
      }
    }
    for (std::size_t p = 0; p < poses_.size(); ++p) {
      poses_[p].error.skinned = distance(skinned[p], poses_[p].sculpt->positions, counts);
      poses_[p].error.corrected = distance(corrected[p], poses_[p].sculpt->positions, counts);
    }
  }

  static SculptError distance(const std::vector<Vec3f>& a, const std::vector<Vec3f>& b,
                              const std::vector<char>& counts) {
    SculptError error;
    double sum = 0, count = 0;
    for (std::size_t v = 0; v < a.size(); ++v) {
      if (counts[v] == 0) continue;
      const double apart = (a[v] - b[v]).cast<double>().norm();
      sum += apart * apart;
      count += 1;
      if (apart > error.largest) {
        error.largest = apart;
        error.vertex = static_cast<int>(v);
      }
    }
    error.root_mean_square = count > 0 ? std::sqrt(sum / count) : 0;
    return error;
  }

  const Model& model_;
  const SculptedJoint& input_;
  CorrectiveFit& fit_;
  PosedSkin& skin_;
  const CorrectiveFitOptions& options_;
  JointCorrective made_;
  std::vector<Pose> poses_;  // examples first
  int examples_ = 0;
};

}  // namespace

Result<CorrectiveFit> fit_correctives(const Model& model, SkinMethod method,
                                      const std::vector<SculptedJoint>& joints,
                                      const CorrectiveFitOptions& options) {
  const SkinBinding binding(model, method);
  PosedSkin skin(binding, model, options.jobs);
  CorrectiveFit fit;
  fit.correctives.vertex_count = model.vertex_count();
  fit.correctives.method = method;
  for (const SculptedJoint& joint : joints) {
    if (Status status = JointFit(model, joint, fit, skin, options).run(); !status) {
      return status.error();
    }
  }
  if (Status status = check(fit.correctives); !status) return status.error();
  return fit;
}

}  // namespace krok
