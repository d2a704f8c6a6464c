#include "ragdoll/bodies.h"

#include <algorithm>
#include <cmath>

#include "core/index.h"
#include "ik/anatomical_limits.h"
#include "math/quaternion.h"
#include "motion/hips_root.h"
#include "ragdoll/overlaps.h"

namespace krok::ragdoll {

namespace {

constexpr const char* kHeadName = "head";
constexpr double kInside = 0.9;  // share of the vertices that a shape reaches
constexpr std::size_t kMinPoints = 12;
constexpr double kAdult = 75;    // kg
constexpr double kWater = 1000;  // kg/m^3

double quantile(std::vector<double> values, double share) {
  const auto place = static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + place, values.end());
  return values[static_cast<std::size_t>(place)];
}

void fit_box(const std::vector<Vec3>& points, Body& body) {
  Vec3 centre = Vec3::Zero(), half = body.shape.half;
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<double> values;
    for (const Vec3& point : points) values.push_back(point[axis]);
    // Each of six sides cuts off its part.
    const double low = quantile(values, (1 - kInside) / 6);
    const double high = quantile(values, 1 - (1 - kInside) / 6);
    if (high - low < 0.01) continue;
    centre[axis] = 0.5 * (low + high);
    half[axis] = 0.5 * (high - low);
  }
  body.shape.half = half;
  body.to_joint.position = body.to_joint * centre;
}

void fit_capsule(const std::vector<Vec3>& points, Body& body) {
  Shape& shape = body.shape;
  const double whole = shape.half_length + shape.radius;
  std::vector<double> distances;
  for (const Vec3& point : points) distances.push_back(std::hypot(point.x(), point.z()));
  shape.radius = std::clamp(quantile(distances, kInside), 0.05 * whole, 0.95 * whole);
  shape.half_length = whole - shape.radius;
}

// A capsule about points beyond which there is no bone: as wide and as long as they are, where they
// are.
void fit_end(const std::vector<Vec3>& points, Body& body) {
  Body box = body;
  fit_box(points, box);
  const Vec3 half = box.shape.half;
  const double across = 0.5 * (half.x() + half.z());
  body.shape.radius = across < half.y() ? across : half.mean();
  body.shape.half_length = std::max(half.y() - across, 0.01 * body.shape.radius);
  body.to_joint.position = box.to_joint.position;
}

// Brings the shapes to the sizes of the model's vertices: sides and radii, not where the bones
// begin and end. Bodies with fewer than 12 vertices stay.
void fit_shapes(const Model& model, std::vector<Body>& bodies) {
  const std::vector<int> carrier = body_of_joint(model.skeleton, bodies);
  std::vector<std::vector<Vec3>> points(bodies.size());
  const auto influences = static_cast<std::size_t>(model.influences_per_vertex);
  for (std::size_t v = 0; v < model.positions.size(); ++v) {
    const int joint = model.influence_joints[v * influences];  // the largest weight comes first
    const int body = carrier[at(joint)];
    if (body < 0) continue;
    const Body& its = bodies[at(body)];
    const Transform to_world = model.skeleton.reference[at(its.joint)] * its.to_joint;
    points[at(body)].push_back(to_world.inverse() * Vec3(model.positions[v].cast<double>()));
  }
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    if (points[b].size() < kMinPoints) continue;
    if (bodies[b].shape.kind == Shape::Kind::box) {
      fit_box(points[b], bodies[b]);
    } else if (bodies[b].name == kHeadName) {
      fit_end(points[b], bodies[b]);
    } else {
      fit_capsule(points[b], bodies[b]);
    }
  }
}

// Shares of the stature, by the widths and girths of Drillis and Contini.
constexpr double kUpperArm = 0.027, kLowerArm = 0.021, kThigh = 0.042, kShank = 0.029;
constexpr double kHead = 0.052, kDepth = 0.058;

class BodyMaker {
 public:
  BodyMaker(const Skeleton& skeleton, const RoleMap& roles) : skeleton_(skeleton), roles_(roles) {}

  bool frame_found();
  void make();
  std::vector<Body> take() { return std::move(bodies_); }

 private:
  Vec3 place(int joint) const { return skeleton_.reference[at(joint)].position; }
  Vec3 place(Role role) const { return place(roles_.joint(role)); }
  int body_above(int joint) const;
  Vec3 farthest_below(int joint) const;
  void add(std::string name, int joint, const Shape& shape, const Transform& to_world);
  void add_box(std::string name, int joint, const Vec3& low, const Vec3& high, double half_width,
               double half_depth);
  void add_limb(std::string name, Role from, const Vec3& end, double radius);
  double ball_of(int ankle, const Vec3& forward) const;
  void add_trunk();
  void add_head();
  void add_hand(std::string name, Role role, Role above);
  void add_foot(std::string name, Role role);

  const Skeleton& skeleton_;
  const RoleMap& roles_;
  std::vector<Body> bodies_;
  Quat trunk_;  // x to the left, y up, z forwards, in the reference pose
  Vec3 hips_ = Vec3::Zero();
  double stature_ = 0;
};

int BodyMaker::body_above(int joint) const {
  for (int j = skeleton_.parents[at(joint)]; j >= 0; j = skeleton_.parents[at(j)]) {
    for (std::size_t b = 0; b < bodies_.size(); ++b) {
      if (bodies_[b].joint == j) return static_cast<int>(b);
    }
  }
  return -1;
}

// The joint below that is farthest away; the joint itself if there is none.
Vec3 BodyMaker::farthest_below(int joint) const {
  std::vector<bool> below(skeleton_.names.size(), false);
  below[at(joint)] = true;
  Vec3 best = place(joint);
  for (int j = joint + 1; j < skeleton_.joint_count(); ++j) {
    const int parent = skeleton_.parents[at(j)];
    if (parent < 0 || !below[at(parent)]) continue;
    below[at(j)] = true;
    if ((place(j) - place(joint)).norm() > (best - place(joint)).norm()) best = place(j);
  }
  return best;
}

bool BodyMaker::frame_found() {
  hips_ = 0.5 * (place(Role::left_upper_leg) + place(Role::right_upper_leg));
  const int top =
      roles_.joint(Role::neck) >= 0 ? roles_.joint(Role::neck) : roles_.joint(Role::head);
  const Vec3 left = (place(Role::left_upper_leg) - place(Role::right_upper_leg)).normalized();
  const Vec3 forward = left.cross(place(top) - hips_).normalized();
  Mat3 axes;
  axes << left, forward.cross(left), forward;
  trunk_ = Quat(axes).normalized();
  // Thigh and shank are 0.491 of the stature, hips to neck 0.32.
  const double leg = (place(Role::left_lower_leg) - place(Role::left_upper_leg)).norm() +
                     (place(Role::left_foot) - place(Role::left_lower_leg)).norm();
  stature_ = (leg + (place(top) - hips_).norm()) / 0.81;
  return trunk_.coeffs().allFinite() && leg > 0 && std::isfinite(stature_);
}

void BodyMaker::add(std::string name, int joint, const Shape& shape, const Transform& to_world) {
  Body body;
  body.name = std::move(name);
  body.joint = joint;
  body.parent = body_above(joint);
  body.shape = shape;
  body.to_joint = skeleton_.reference[at(joint)].inverse() * to_world;
  body.to_joint.orientation.normalize();
  bodies_.push_back(std::move(body));
}

// A box of the trunk between two points of its middle.
void BodyMaker::add_box(std::string name, int joint, const Vec3& low, const Vec3& high,
                        double half_width, double half_depth) {
  Shape shape;
  shape.half = Vec3(half_width, std::max(0.5 * (high - low).norm(), 0.02 * stature_), half_depth);
  const Quat turn = shortest_arc(trunk_ * Vec3(Vec3::UnitY()), high - low);
  add(std::move(name), joint, shape, {0.5 * (low + high), turn * trunk_});
}

void BodyMaker::add_limb(std::string name, Role from, const Vec3& end, double radius) {
  const int joint = roles_.joint(from);
  if (joint < 0) return;
  const Vec3 bone = end - place(joint);
  Shape shape;
  shape.kind = Shape::Kind::capsule;
  shape.radius = std::min(radius, 0.45 * bone.norm());
  shape.half_length = 0.5 * bone.norm() - shape.radius;
  const Quat turn = shortest_arc(trunk_ * Vec3(-Vec3::UnitY()), bone);
  add(std::move(name), joint, shape, {place(joint) + 0.5 * bone, turn * trunk_});
}

void BodyMaker::add_trunk() {
  const Vec3 up = trunk_ * Vec3(Vec3::UnitY());
  const double wide = 0.5 * (place(Role::left_upper_leg) - place(Role::right_upper_leg)).norm();
  const int top =
      roles_.joint(Role::neck) >= 0 ? roles_.joint(Role::neck) : roles_.joint(Role::head);
  std::vector<int> trunk = roles_.joints(Role::spine);
  for (const int joint : roles_.joints(Role::chest)) trunk.push_back(joint);
  std::sort(trunk.begin(), trunk.end());
  const double depth = kDepth * stature_, low = 0.035 * stature_;
  const Vec3 begin = trunk.empty() ? Vec3(hips_ + 0.06 * stature_ * up) : place(trunk.front());
  add_box("pelvis", roles_.joint(Role::hips), hips_ - low * up,
          hips_ + std::max((begin - hips_).dot(up), low) * up, wide + 0.035 * stature_, depth);
  if (trunk.empty()) return;
  const double shoulders =
      0.5 * (place(Role::left_upper_arm) - place(Role::right_upper_arm)).norm();
  const double chest_width = std::max(shoulders - kUpperArm * stature_, wide);
  // The last joint that leaves enough of the trunk above it and below it.
  int chest = -1;
  const double whole = (place(top) - begin).norm();
  for (const int joint : trunk) {
    const double below = (place(joint) - begin).norm();
    if (below > 0.25 * whole && below < 0.75 * whole) chest = joint;
  }
  if (chest < 0) {
    add_box("chest", trunk.front(), begin, place(top), chest_width, depth);
    return;
  }
  add_box("abdomen", trunk.front(), begin, place(chest), wide + 0.025 * stature_, 0.9 * depth);
  add_box("chest", chest, place(chest), place(top), chest_width, depth);
}

// Distance from the ankle ahead to the toes; 0 if unknown.
double BodyMaker::ball_of(int ankle, const Vec3& forward) const {
  for (int j = ankle + 1; j < skeleton_.joint_count(); ++j) {
    if (skeleton_.parents[at(j)] == ankle && skeleton_.end_sites[at(j)] == 0) {
      const double ahead = (place(j) - place(ankle)).dot(forward);
      if (ahead > 0) return ahead;
    }
  }
  return 0;
}

// With the neck, which follows or leads it.
void BodyMaker::add_head() {
  const Vec3 up = trunk_ * Vec3(Vec3::UnitY());
  int joint = roles_.joint(Role::neck);
  const int head = roles_.joint(Role::head);
  if (joint < 0) joint = head;
  const Vec3 base = place(head >= 0 ? head : joint);
  const double radius = kHead * stature_;
  Shape shape;
  shape.kind = Shape::Kind::capsule;
  shape.radius = radius;
  shape.half_length = 0.012 * stature_;
  add(kHeadName, joint, shape, {base + 0.065 * stature_ * up, trunk_});
}

void BodyMaker::add_hand(std::string name, Role role, Role above) {
  const int joint = roles_.joint(role);
  if (joint < 0) return;
  Vec3 bone = farthest_below(joint) - place(joint);
  const double length = 0.1 * stature_;  // to the middle of the bent fingers
  const int arm = roles_.joint(above);
  if (bone.norm() < 0.01 * stature_ && arm >= 0) bone = place(joint) - place(arm);
  if (bone.norm() < 1e-6) return;
  bone *= std::min(1.0, length / bone.norm());
  if (bone.norm() < 0.6 * length) bone *= 0.6 * length / bone.norm();
  Shape shape;
  shape.half = Vec3(0.012 * stature_, 0.5 * bone.norm(), 0.024 * stature_);
  const Quat turn = shortest_arc(trunk_ * Vec3(-Vec3::UnitY()), bone);
  add(std::move(name), joint, shape, {place(joint) + 0.5 * bone, turn * trunk_});
}

// From the heel to just beyond the ball, upright in the reference pose: toes are bent where the
// heel is up, and would be in the ground.
void BodyMaker::add_foot(std::string name, Role role) {
  const int joint = roles_.joint(role);
  if (joint < 0) return;
  const Vec3 up = trunk_ * Vec3(Vec3::UnitY());
  Vec3 toes = farthest_below(joint) - place(joint);
  const double height = std::max(-toes.dot(up), 0.036 * stature_);
  toes -= toes.dot(up) * up;
  const double ahead = toes.norm();
  if (ahead < 0.02 * stature_) toes = trunk_ * Vec3(Vec3::UnitZ());
  const Vec3 forward = toes.normalized();
  const double length = std::max(ball_of(joint, forward), 0.07 * stature_) + 0.01 * stature_;
  const double heel = 0.036 * stature_;
  Shape shape;
  shape.half = Vec3(0.026 * stature_, 0.45 * height, 0.5 * (length + heel));
  Mat3 axes;
  axes << up.cross(forward), up, forward;
  const Vec3 centre =
      place(joint) + 0.5 * (length - heel) * forward - (height - shape.half.y()) * up;
  add(std::move(name), joint, shape, {centre, Quat(axes).normalized()});
}

void BodyMaker::make() {
  add_trunk();
  add_head();
  const auto limbs = [&](const std::string& side, Role arm, Role elbow, Role hand, Role leg,
                         Role knee, Role foot) {
    if (roles_.joint(elbow) >= 0) {
      add_limb(side + "_upper_arm", arm, place(elbow), kUpperArm * stature_);
      add_limb(side + "_lower_arm", elbow, place(hand), kLowerArm * stature_);
    } else {
      add_limb(side + "_arm", arm, place(hand), kUpperArm * stature_);
    }
    add_hand(side + "_hand", hand, elbow);
    add_limb(side + "_thigh", leg, place(knee), kThigh * stature_);
    add_limb(side + "_shank", knee, place(foot), kShank * stature_);
    add_foot(side + "_foot", foot);
  };
  limbs("left", Role::left_upper_arm, Role::left_lower_arm, Role::left_hand, Role::left_upper_leg,
        Role::left_lower_leg, Role::left_foot);
  limbs("right", Role::right_upper_arm, Role::right_lower_arm, Role::right_hand,
        Role::right_upper_leg, Role::right_lower_leg, Role::right_foot);
}

// Shares of the joints that a body carries.
void share_mass(const Skeleton& skeleton, const RoleMap& roles, double mass,
                std::vector<Body>& bodies) {
  const ik::BodyMasses shares = ik::body_masses(skeleton, roles);
  const std::vector<int> carrier = body_of_joint(skeleton, bodies);
  std::vector<double> sums(bodies.size(), 0.0);
  double whole = 0;
  for (std::size_t j = 0; j < carrier.size(); ++j) {
    sums[at(std::max(carrier[j], 0))] += shares.masses[j];
    whole += shares.masses[j];
  }
  // A part without a share (in a skeleton without elbows) still gets mass.
  double total = 0;
  for (double& sum : sums) {
    sum = std::max(sum, 0.003 * whole);
    total += sum;
  }
  for (std::size_t b = 0; b < bodies.size(); ++b) bodies[b].mass = mass * sums[b] / total;
}

// With `mass` as all of it, or at the density of water.
void share_mass_by_volume(std::optional<double> mass, std::vector<Body>& bodies) {
  double whole = 0;
  for (const Body& body : bodies) whole += volume(body.shape);
  const double density = mass ? *mass / whole : kWater;
  for (Body& body : bodies) body.mass = density * volume(body.shape);
}

}  // namespace

double volume(const Shape& shape) {
  const double r = shape.radius;
  switch (shape.kind) {
    case Shape::Kind::box:
      return 8 * shape.half.prod();
    case Shape::Kind::capsule:
      return kPi * r * r * (2 * shape.half_length + 4.0 / 3 * r);
    case Shape::Kind::sphere:
      return 4.0 / 3 * kPi * r * r * r;
  }
  return 0;
}

std::vector<int> body_of_joint(const Skeleton& skeleton, const std::vector<Body>& bodies) {
  std::vector<int> carrier(skeleton.names.size(), -1);
  for (std::size_t b = 0; b < bodies.size(); ++b)
    carrier[at(bodies[b].joint)] = static_cast<int>(b);
  for (int j = 1; j < skeleton.joint_count(); ++j) {
    if (carrier[at(j)] < 0) carrier[at(j)] = carrier[at(skeleton.parents[at(j)])];
  }
  return carrier;
}

Result<std::vector<Body>> make_bodies(const Skeleton& motion, const RoleMap& roles,
                                      const BodyOptions& options) {
  // A mesh is made around a standing pose, which a capture's reference pose need not be.
  const Skeleton& skeleton = options.model != nullptr ? options.model->skeleton : motion;
  if (const std::string difference = difference_in_structure(skeleton, motion);
      !difference.empty()) {
    return Error("ragdoll-model", "the model has another skeleton than the motion: " + difference,
                 "give the model that the motion animates; krok-retarget brings motions to others");
  }
  if (options.mass && (!(*options.mass > 0) || !std::isfinite(*options.mass))) {
    return Error("ragdoll-size", "the mass is not above 0");
  }
  std::vector<Body> bodies;
  if (roles.humanoid) {
    BodyMaker maker(skeleton, roles);
    if (!maker.frame_found()) {
      return Error("ragdoll-size",
                   "the reference pose has no extent: hips, knees and neck coincide");
    }
    maker.make();
    bodies = maker.take();
  } else {
    bodies = bone_bodies(skeleton, carrying_joint(roles));
    if (bodies.empty()) {
      return Error("ragdoll-size", "the reference pose has no extent: all joints coincide");
    }
  }
  if (options.model != nullptr) fit_shapes(*options.model, bodies);
  if (roles.humanoid) {
    share_mass(skeleton, roles, options.mass.value_or(kAdult), bodies);
  } else {
    share_mass_by_volume(options.mass, bodies);
  }
  for (const Body& body : bodies) {
    if (!(volume(body.shape) > 0) || !body.to_joint.position.allFinite()) {
      Error error("ragdoll-size", "the part '" + body.name + "' has no extent");
      error.joint = skeleton.names[at(body.joint)];
      return error;
    }
  }
  return bodies;
}

double covered_share(const Model& model, const std::vector<Body>& bodies, double distance) {
  if (model.positions.empty()) return 1;
  std::vector<Transform> to_body;
  for (const Body& body : bodies) {
    to_body.push_back((model.skeleton.reference[at(body.joint)] * body.to_joint).inverse());
  }
  std::size_t covered = 0;
  for (const Vec3f& position : model.positions) {
    const Vec3 point = position.cast<double>();
    for (std::size_t b = 0; b < bodies.size(); ++b) {
      if (signed_distance(bodies[b].shape, to_body[b] * point) > distance) continue;
      ++covered;
      break;
    }
  }
  return static_cast<double>(covered) / static_cast<double>(model.positions.size());
}

std::string_view body_mode_name(BodyMode mode) {
  switch (mode) {
    case BodyMode::simulated:
      return "simulated";
    case BodyMode::animated:
      return "animated";
    case BodyMode::powered:
      return "powered";
  }
  return "";
}

}  // namespace krok::ragdoll
