#include "parametric/measure.h"

#include <cassert>
#include <cmath>

#include "math/quaternion.h"
#include "motion/hips_root.h"
#include "pose/packed_pose.h"

namespace krok::parametric {

namespace {

constexpr double kMinSum = 1e-6;
constexpr double kMinLevel = 1e-3;   // of the horizontal part of the sole's direction
constexpr double kSamePlace = 2e-6;  // metres, within the rounding of floats

Vec3 forward_of(double heading) {
  return {std::sin(heading), 0, std::cos(heading)};
}
Vec3 left_of(double heading) {
  return {std::cos(heading), 0, -std::sin(heading)};
}

}  // namespace

// A footprint with the data for its derivatives.
struct Measure::Print {
  int node = 0;
  Footprint print;
  Vec3 heel = Vec3::Zero(), forward = Vec3::Zero();  // world
  double length = 0;                                 // of the sole if the foot is on its ball
};

Measure::Measure(const Library& library, const PackedExamples& packed)
    : examples_(packed.examples()),
      side_(library.swing == FootSide::left ? 1 : -1),
      stance_(library.foot(library.stance())),
      swing_(library.foot(library.swing)),
      parameters_(library.parameters) {
  std::vector<std::vector<std::uint8_t>> needed(
      library.keytimes.size(), std::vector<std::uint8_t>(library.skeleton.names.size(), 0));
  const auto need = [&](int keytime, int joint) {
    for (; joint >= 0; joint = library.skeleton.parents[static_cast<std::size_t>(joint)]) {
      needed[static_cast<std::size_t>(keytime)][static_cast<std::size_t>(joint)] = 1;
    }
  };
  need(0, stance_.joint);
  for (const Parameter& parameter : parameters_) {
    if (parameter.quantity == Quantity::duration) continue;
    need(parameter.keytime, parameter.quantity == Quantity::joint ? parameter.joint : swing_.joint);
  }
  add_nodes(library, needed);
  fill_nodes(packed);
  durations_ = packed.times.bottomRows(1).transpose() - packed.times.topRows(1).transpose();
}

void Measure::add_nodes(const Library& library, std::vector<std::vector<std::uint8_t>>& needed) {
  for (int k = 0; k < static_cast<int>(needed.size()); ++k) {
    const auto& joints = needed[static_cast<std::size_t>(k)];
    for (int j = 0; j < static_cast<int>(joints.size()); ++j) {
      if (!joints[static_cast<std::size_t>(j)]) continue;
      const int parent = library.skeleton.parents[static_cast<std::size_t>(j)];
      nodes_.push_back({k, j, parent < 0 ? -1 : node(k, parent), false, Vec3::Zero()});
    }
  }
}

int Measure::node(int keytime, int joint) const {
  for (std::size_t n = 0; n < nodes_.size(); ++n) {
    if (nodes_[n].keytime == keytime && nodes_[n].joint == joint) return static_cast<int>(n);
  }
  assert(false);
  return -1;
}

void Measure::fill_nodes(const PackedExamples& packed) {
  const auto count = static_cast<Eigen::Index>(nodes_.size());
  rotations_.resize(examples_, 4 * count);
  places_.resize(examples_, 3 * count);
  const auto joints = static_cast<std::size_t>(packed.reference.joints);
  std::vector<PoseBlock> pose(static_cast<std::size_t>(packed.reference.blocks_per_pose()));
  std::vector<Transform> reference(joints), local(joints);
  for (int k = 0; k < packed.keytimes(); ++k) {
    sample_pose(packed.reference, packed.generic[static_cast<std::size_t>(k)], pose);
    unpack_pose(pose, reference);
    for (int i = 0; i < examples_; ++i) {
      sample_pose(packed.clips[static_cast<std::size_t>(i)], packed.times(k, i), pose);
      unpack_pose(pose, local);
      for (Eigen::Index n = 0; n < count; ++n) {
        const Node& at = nodes_[static_cast<std::size_t>(n)];
        if (at.keytime != k) continue;
        const auto j = static_cast<std::size_t>(at.joint);
        rotations_.block<1, 4>(i, 4 * n) =
            in_hemisphere_of(reference[j].orientation, local[j].orientation).coeffs().transpose();
        places_.block<1, 3>(i, 3 * n) = local[j].position.transpose();
      }
    }
  }
  for (Eigen::Index n = 0; n < count; ++n) {
    const auto all = places_.middleCols<3>(3 * n);
    Node& at = nodes_[static_cast<std::size_t>(n)];
    at.place = all.colwise().mean().transpose();
    at.moves = (all.rowwise() - at.place.transpose()).cwiseAbs().maxCoeff() > kSamePlace;
  }
}

Status Measure::pose(const Eigen::Ref<const Eigen::VectorXd>& weights, Scratch& scratch) const {
  for (std::size_t n = 0; n < nodes_.size(); ++n) {
    const Node& at = nodes_[n];
    NodeState& state = scratch[n];
    const auto column = static_cast<Eigen::Index>(n);
    Vec4 sum;
    for (int c = 0; c < 4; ++c) sum[c] = rotations_.col(4 * column + c).dot(weights);
    state.length = sum.norm();
    if (!(state.length > kMinSum)) {
      return Error("parametric-sum", "rotations of the examples cancel each other",
                   "use more similar examples or less extreme weights");
    }
    state.rotation.coeffs() = sum / state.length;
    Vec3 place = at.place;
    if (at.moves) {
      for (int c = 0; c < 3; ++c) place[c] = places_.col(3 * column + c).dot(weights);
    }
    const Transform to_parent{place, state.rotation};
    state.to_world = at.parent < 0
                         ? to_parent
                         : scratch[static_cast<std::size_t>(at.parent)].to_world * to_parent;
  }
  return {};
}

Status Measure::print_of(const FootShape& foot, int node, const Scratch& scratch,
                         Print& print) const {
  const Transform& to_world = scratch[static_cast<std::size_t>(node)].to_world;
  print.node = node;
  print.heel = to_world * foot.heel;
  print.forward = to_world.orientation * foot.forward;
  if (std::hypot(print.forward.x(), print.forward.z()) < kMinLevel) {
    return Error("parametric-foot", "a foot is vertical, so its heading is undefined",
                 "use a keytime at which it is flat");
  }
  print.print = footprint(foot, to_world);
  print.length = print.forward.y() < 0 ? foot.length : 0;
  return {};
}

// Adds the derivatives by the print's position and heading to its node, as a force and a moment
// about the origin.
void Measure::pull(const Print& print, const Vec3& place, double heading, Scratch& scratch) const {
  NodeState& state = scratch[static_cast<std::size_t>(print.node)];
  const Vec3& ahead = print.forward;
  const double level = ahead.x() * ahead.x() + ahead.z() * ahead.z();
  const double turning = heading - print.length * place.dot(left_of(print.print.heading));
  const Vec3 direction = print.length * place + turning / level * Vec3(ahead.z(), 0, -ahead.x());
  state.force += place;
  state.moment += print.heel.cross(place) + ahead.cross(direction);
}

Status Measure::evaluate(const Parameter& parameter, const Print& stance, Scratch& scratch,
                         double& value, bool gradient) const {
  const bool joint = parameter.quantity == Quantity::joint;
  const int moved = node(parameter.keytime, joint ? parameter.joint : swing_.joint);
  NodeState& state = scratch[static_cast<std::size_t>(moved)];
  Print print;
  Vec3 place = state.to_world.position;
  if (!joint) {
    if (Status status = print_of(swing_, moved, scratch, print); !status) return status;
    place = print.print.place;
  }
  const double heading = stance.print.heading;
  if (is_turn(parameter.quantity)) {
    const bool path = parameter.quantity == Quantity::path_turn;
    const double toes = path ? swing_.toe_out - stance_.toe_out : 0;
    value = side_ * wrapped(print.print.heading - heading - toes);
    if (!gradient) return {};
    pull(print, Vec3::Zero(), side_, scratch);
    pull(stance, Vec3::Zero(), -side_, scratch);
    return {};
  }
  Direction direction = parameter.direction;
  if (parameter.quantity == Quantity::step_length) direction = Direction::along;
  if (parameter.quantity == Quantity::step_width) direction = Direction::across;
  if (parameter.quantity == Quantity::step_height) direction = Direction::up;
  // The axis, and its derivative by the stance foot's heading.
  Vec3 axis = Vec3::UnitY(), change = Vec3::Zero();
  if (direction == Direction::along) {
    axis = forward_of(heading);
    change = left_of(heading);
  } else if (direction == Direction::across) {
    axis = side_ * left_of(heading);
    change = -side_ * forward_of(heading);
  }
  const Vec3 way = place - stance.print.place;
  value = way.dot(axis);
  if (!gradient) return {};
  pull(stance, -axis, way.dot(change), scratch);
  if (joint) {
    state.force += axis;
    state.moment += place.cross(axis);
  } else {
    pull(print, axis, 0, scratch);
  }
  return {};
}

// Accumulates forces up the hierarchy into the derivatives by each example's rotations and
// positions. A rotation of a joint by a small vector v in its parent's frame is 2 vec(dq q*); the
// component along q drops out, as it must for a normalised sum.
void Measure::gather(Scratch& scratch, Eigen::Ref<Eigen::RowVectorXd> row) const {
  row.setZero();
  for (std::size_t n = nodes_.size(); n-- > 0;) {
    const Node& at = nodes_[n];
    NodeState& state = scratch[n];
    Quat world_to_parent = Quat::Identity();
    if (at.parent >= 0) {
      NodeState& parent = scratch[static_cast<std::size_t>(at.parent)];
      parent.force += state.force;
      parent.moment += state.moment;
      world_to_parent = parent.to_world.orientation.conjugate();
    }
    const Vec3 m =
        world_to_parent * Vec3(state.moment - state.to_world.position.cross(state.force));
    const Vec3 v = state.rotation.vec();
    const double scale = 2 / state.length;
    Vec4 by_rotation;
    by_rotation.head<3>() = scale * (state.rotation.w() * m - v.cross(m));
    by_rotation[3] = -scale * m.dot(v);
    const auto column = static_cast<Eigen::Index>(n);
    for (int c = 0; c < 4; ++c) {
      row += by_rotation[c] * rotations_.col(4 * column + c).transpose();
    }
    if (!at.moves) continue;
    const Vec3 by_place = world_to_parent * state.force;
    for (int c = 0; c < 3; ++c) row += by_place[c] * places_.col(3 * column + c).transpose();
  }
}

Status Measure::operator()(std::span<const double> weights, std::span<double> parameters,
                           std::span<double> jacobian, Scratch& scratch) const {
  assert(weights.size() == static_cast<std::size_t>(examples_));
  assert(parameters.size() == parameters_.size() && scratch.size() == nodes_.size());
  assert(jacobian.empty() || jacobian.size() == weights.size() * parameters.size());
  const Eigen::Map<const Eigen::VectorXd> w(weights.data(), examples_);
  if (Status status = pose(w, scratch); !status) return status;
  Print stance;
  if (Status status = print_of(stance_, node(0, stance_.joint), scratch, stance); !status)
    return status;
  for (std::size_t d = 0; d < parameters_.size(); ++d) {
    Eigen::Map<Eigen::RowVectorXd> row(jacobian.empty() ? nullptr : &jacobian[d * weights.size()],
                                       jacobian.empty() ? 0 : examples_);
    if (parameters_[d].quantity == Quantity::duration) {
      parameters[d] = durations_.dot(w);
      if (!jacobian.empty()) row = durations_.transpose();
      continue;
    }
    for (NodeState& state : scratch) state.force = state.moment = Vec3::Zero();
    const bool gradient = !jacobian.empty();
    if (Status status = evaluate(parameters_[d], stance, scratch, parameters[d], gradient);
        !status) {
      return status;
    }
    if (gradient) gather(scratch, row);
  }
  return {};
}

}  // namespace krok::parametric
