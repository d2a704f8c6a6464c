#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "character/joints.h"
#include "character/rig.h"
#include "core/index.h"
#include "core/numbers.h"
#include "core/text.h"
#include "math/dense_solve.h"
#include "math/quaternion.h"

namespace krok::character {

using nodes::Scene;

namespace {

void report_joint(Diagnostics& diagnostics, Severity severity, std::string code,
                  std::string message, std::string joint = {}) {
  Diagnostic diagnostic = make_diagnostic(severity, std::move(code), std::move(message));
  diagnostic.joint = std::move(joint);
  diagnostics.push_back(std::move(diagnostic));
}

// The rotation by multiples of 90 degrees nearest to another.
Mat3 nearest_by_quarters(const Mat3& rotation) {
  Mat3 best = Mat3::Identity();
  double most = -4;
  for (int axes = 0; axes < 6; ++axes) {
    for (int signs = 0; signs < 8; ++signs) {
      Mat3 turn = Mat3::Zero();
      const int x = axes / 2, y = (x + 1 + axes % 2) % 3, z = 3 - x - y;
      turn(x, 0) = signs & 1 ? -1 : 1;
      turn(y, 1) = signs & 2 ? -1 : 1;
      turn(z, 2) = signs & 4 ? -1 : 1;
      const double trace = (turn.transpose() * rotation).trace();
      if (turn.determinant() > 0 && trace > most) {
        most = trace;
        best = turn;
      }
    }
  }
  return best;
}

double angle_of(const Mat3& rotation) {
  return angle_between(Quat(rotation), Quat::Identity());
}

class Finder {
 public:
  Finder(const Scene& scene, const nodes::Evaluator& evaluator, const Joints& joints,
         const Mat4& to_axes, Diagnostics& diagnostics)
      : scene_(scene),
        evaluator_(evaluator),
        joints_(joints),
        to_axes_(to_axes),
        diagnostics_(diagnostics),
        reference_(at(joints.count()), Mat4::Identity()),
        known_(at(joints.count()), 0),
        weighted_(at(joints.count()), 0),
        doubtful_(at(joints.count()), 0) {}

  BindPose find() {
    evaluator_.place_nodes(-1, 0, rest_);
    measure();
    find_weighted();
    for (const int skin : by_size()) use_skin(skin);
    follow_nodes();
    report_binds();
    return {std::move(reference_), std::move(weighted_)};
  }

 private:
  const nodes::Skin& skin_of(int skin) const { return scene_.skins[at(skin)]; }
  std::size_t joint_of(int skin, std::size_t place) const {
    return at(joints_.node_to_joint[at(skin_of(skin).joints[place])]);
  }
  // The transform of the joint's node without animation.
  Mat4 rest(int joint) const {
    const int node = joints_.nodes[at(joint)];
    return node < 0 ? to_axes_ : Mat4(to_axes_ * rest_.node_to_world[at(node)]);
  }
  void measure();
  void find_weighted();
  std::vector<int> by_size() const;
  Mat4 world_of_mesh(int skin) const;
  Mat4 upright(int skin, const std::vector<std::size_t>& places, const Mat4& by_top) const;
  Mat4 mesh_to_world(int skin, const std::vector<std::size_t>& places);
  std::vector<std::size_t> usable_binds(int skin);
  bool fits_others(std::size_t joint, const Mat4& place) const;
  void use_skin(int skin);
  void follow_nodes();
  void report_binds();

  const Scene& scene_;
  const nodes::Evaluator& evaluator_;
  const Joints& joints_;
  const Mat4& to_axes_;
  Diagnostics& diagnostics_;
  nodes::Evaluation rest_;
  double size_ = 1.0;  // of the skeleton, in the scene's unit
  std::vector<Mat4> reference_;
  std::vector<char> known_;
  std::vector<char> weighted_;
  std::vector<char> doubtful_;  // without vertices, and bound where it cannot be
  std::size_t unusable_ = 0;
  std::string first_unusable_;
};

void Finder::measure() {
  Eigen::AlignedBox3d box;
  for (int j = 0; j < joints_.count(); ++j) {
    const Vec3 position = rest(j).topRightCorner<3, 1>();
    if (position.allFinite()) box.extend(position);
  }
  const double extent = box.isEmpty() ? 0.0 : box.sizes().maxCoeff();
  if (extent > 0) size_ = extent;
}

void Finder::find_weighted() {
  for (std::size_t n = 0; n < scene_.nodes.size(); ++n) {
    const nodes::Node& node = scene_.nodes[n];
    if (node.mesh < 0) continue;
    if (node.skin < 0) {
      const int joint = joints_.node_to_joint[n];
      if (joint >= 0) weighted_[at(joint)] = 1;
      continue;
    }
    const nodes::Skin& skin = skin_of(node.skin);
    for (const nodes::Primitive& primitive : scene_.meshes[at(node.mesh)].primitives) {
      for (std::size_t k = 0; k < primitive.influence_joints.size(); ++k) {
        if (!(primitive.influence_weights[k] > 0)) continue;
        const int joint = joints_.node_to_joint[at(skin.joints[primitive.influence_joints[k]])];
        if (joint >= 0) weighted_[at(joint)] = 1;
      }
    }
  }
}

// The skins, those with the most joints first.
std::vector<int> Finder::by_size() const {
  std::vector<int> skins = joints_.skins;
  std::stable_sort(skins.begin(), skins.end(), [&](int a, int b) {
    return skin_of(a).joints.size() > skin_of(b).joints.size();
  });
  return skins;
}

// The transform of the first node in the scene whose mesh is bound by the skin; NaN if there is
// none.
Mat4 Finder::world_of_mesh(int skin) const {
  for (const int node : evaluator_.order()) {
    const nodes::Node& one = scene_.nodes[at(node)];
    if (one.skin == skin && one.mesh >= 0 && one.in_scene) {
      return to_axes_ * rest_.node_to_world[at(node)];
    }
  }
  return Mat4::Constant(std::nan(""));
}

// The mesh_to_world of the bind pose for a character whose nodes are in another pose that rotates
// the topmost joint: fits all joints as a whole, aligned to the axes.
Mat4 Finder::upright(int skin, const std::vector<std::size_t>& places, const Mat4& by_top) const {
  const nodes::Skin& one = skin_of(skin);
  const Mat3 linear = by_top.topLeftCorner<3, 3>();
  const double scale = std::cbrt(linear.determinant());
  if (!(scale > 0)) return by_top;
  const Transform top = nodes::rigid_part(by_top);
  constexpr double kOnAxis = 1e-3, kNear = 40 * kRadiansPerDegree;
  const Mat3 top_turn = top.orientation.toRotationMatrix();
  if (angle_of(nearest_by_quarters(top_turn).transpose() * top_turn) < kOnAxis) return by_top;

  Vec3 bound_mean = Vec3::Zero(), shown_mean = Vec3::Zero();
  std::vector<std::pair<Vec3, Vec3>> pairs;
  for (const std::size_t k : places) {
    if (!weighted_[joint_of(skin, k)]) continue;
    const Vec3 bound = inverse_or_identity(one.inverse_binds[k]).topRightCorner<3, 1>() * scale;
    const Vec3 shown = rest(static_cast<int>(joint_of(skin, k))).topRightCorner<3, 1>();
    if (!bound.allFinite() || !shown.allFinite()) continue;
    pairs.emplace_back(bound, shown);
    bound_mean += bound;
    shown_mean += shown;
  }
  if (pairs.size() < 3) return by_top;
  bound_mean /= static_cast<double>(pairs.size());
  shown_mean /= static_cast<double>(pairs.size());
  Mat3 covariance = Mat3::Zero();
  for (const auto& [bound, shown] : pairs) {
    covariance += (shown - shown_mean) * (bound - bound_mean).transpose();
  }
  if (!covariance.allFinite()) return by_top;
  Mat3 turn = nearest_rotation(covariance);
  const Mat3 quarters = nearest_by_quarters(turn);
  if (angle_of(quarters.transpose() * turn) < kNear) turn = quarters;
  Vec3 offset = shown_mean - turn * bound_mean;
  if (offset.norm() < 0.5 * size_) offset.setZero();  // the mesh's origin is the better ground
  Mat4 result = Mat4::Identity();
  result.topLeftCorner<3, 3>() = turn * scale;
  result.topRightCorner<3, 1>() = offset;
  return result;
}

// X for a skin without a joint whose bind pose is known.
Mat4 Finder::mesh_to_world(int skin, const std::vector<std::size_t>& places) {
  const nodes::Skin& one = skin_of(skin);
  const std::size_t top = places.front();
  const int top_joint = static_cast<int>(joint_of(skin, top));
  // Below known joints: attached as its node is.
  for (int above = joints_.parents[at(top_joint)]; above >= 0; above = joints_.parents[at(above)]) {
    if (!known_[at(above)]) continue;
    const Mat4 local = inverse_or_identity(rest(above)) * rest(top_joint);
    return reference_[at(above)] * local * one.inverse_binds[top];
  }
  const Mat4 by_top = rest(top_joint) * one.inverse_binds[top];
  const Mat4 by_mesh = world_of_mesh(skin);
  bool all_agree = true, mesh_agrees = false;
  for (const std::size_t k : places) {
    if (!weighted_[joint_of(skin, k)]) continue;
    const Mat4 shown = rest(static_cast<int>(joint_of(skin, k))) * one.inverse_binds[k];
    all_agree = all_agree && nearly_same(shown, by_top, size_);
    mesh_agrees = mesh_agrees || nearly_same(shown, by_mesh, size_);
  }
  const Mat4 chosen = all_agree ? by_top : mesh_agrees ? by_mesh : upright(skin, places, by_top);
  // Any X gives the same motion of the vertices, so avoid tilting the character by rounding in the
  // file.
  const bool untouched = (chosen - Mat4::Identity()).cwiseAbs().maxCoeff() < 1e-5;
  return untouched ? Mat4(Mat4::Identity()) : chosen;
}

// Indices in a skin's list whose matrices are usable, those of joints with vertices first, parents
// before children.
std::vector<std::size_t> Finder::usable_binds(int skin) {
  const nodes::Skin& one = skin_of(skin);
  std::vector<std::size_t> places;
  for (std::size_t k = 0; k < one.joints.size(); ++k) {
    bool works = false;
    inverse_or_identity(one.inverse_binds[k], &works);
    if (works) places.push_back(k);
    if (!works && unusable_++ == 0) first_unusable_ = scene_.nodes[at(one.joints[k])].name;
  }
  std::stable_sort(places.begin(), places.end(), [&](std::size_t a, std::size_t b) {
    const std::size_t joint_a = joint_of(skin, a), joint_b = joint_of(skin, b);
    if (weighted_[joint_a] != weighted_[joint_b]) return weighted_[joint_a] != 0;
    return joint_a < joint_b;
  });
  return places;
}

// Whether a joint without vertices has the scale that its nodes give it relative to a joint whose
// bind pose is known, and the distance from its parent. Some exporters write arbitrary matrices for
// such joints, or the identity for all of them.
bool Finder::fits_others(std::size_t joint, const Mat4& place) const {
  const auto differ = [](double a, double b) { return std::abs(a - b) > 0.02 * std::max(a, b); };
  const auto fits = [&](int other, bool by_distance) {
    const Mat4 bound = inverse_or_identity(reference_[at(other)]) * place;
    const Mat4 by_nodes = inverse_or_identity(rest(other)) * rest(static_cast<int>(joint));
    return !differ(bound.topLeftCorner<3, 3>().norm(), by_nodes.topLeftCorner<3, 3>().norm()) &&
           !(by_distance &&
             differ(bound.topRightCorner<3, 1>().norm(), by_nodes.topRightCorner<3, 1>().norm()));
  };
  const int parent = joints_.parents[joint];
  if (parent >= 0 && doubtful_[at(parent)]) return false;
  for (int above = parent; above >= 0; above = joints_.parents[at(above)]) {
    if (known_[at(above)]) return fits(above, above == parent);
  }
  std::vector<char> inside(at(joints_.count()), 0);
  inside[joint] = 1;
  for (int below = static_cast<int>(joint) + 1; below < joints_.count(); ++below) {
    const int its = joints_.parents[at(below)];
    inside[at(below)] = its >= 0 ? inside[at(its)] : 0;
    if (inside[at(below)] && known_[at(below)]) return fits(below, false);
  }
  return true;
}

void Finder::use_skin(int skin) {
  const nodes::Skin& one = skin_of(skin);
  const std::vector<std::size_t> places = usable_binds(skin);
  if (places.empty()) return;
  const auto shared = std::find_if(places.begin(), places.end(),
                                   [&](std::size_t k) { return known_[joint_of(skin, k)]; });
  const Mat4 to_world = shared != places.end()
                            ? Mat4(reference_[joint_of(skin, *shared)] * one.inverse_binds[*shared])
                            : mesh_to_world(skin, places);
  double farthest = 0, widest = 0;
  int worst = -1;
  for (const std::size_t k : places) {
    const std::size_t joint = joint_of(skin, k);
    const Mat4 place = to_world * inverse_or_identity(one.inverse_binds[k]);
    if (!weighted_[joint] && !fits_others(joint, place)) {
      doubtful_[joint] = known_[joint] == 0 ? 1 : 0;
      continue;
    }
    Mat4& reference = reference_[joint];
    if (!known_[joint]) {
      reference = place;
      known_[joint] = 1;
      doubtful_[joint] = 0;
      continue;
    }
    if (nearly_same(place, reference, size_)) continue;
    const Transform a = nodes::rigid_part(place), b = nodes::rigid_part(reference);
    const double distance = (a.position - b.position).norm();
    const double angle = angle_between(a.orientation, b.orientation);
    if (worst >= 0 && distance / size_ + angle <= farthest / size_ + widest) continue;
    farthest = distance;
    widest = angle;
    worst = one.joints[k];
  }
  if (worst < 0) return;
  const std::string joint = scene_.nodes[at(worst)].name;
  report_joint(
      diagnostics_, Severity::warning, "scene-bind",
      fmt::format("{} binds {} {} units and {} degrees away from another skin; the bind pose of "
                  "the skin with the most joints is kept",
                  label("skin", skin, one.name), shown(joint), readable(farthest, 3),
                  readable(widest / kRadiansPerDegree, 3)),
      joint);
}

// Joints without inverse bind matrices: ancestors from their descendants, then the rest from their
// parents.
void Finder::follow_nodes() {
  const int count = joints_.count();
  const auto& parents = joints_.parents;
  for (int j = count - 1; j > 0; --j) {
    const int parent = parents[at(j)];
    if (!known_[at(j)] || known_[at(parent)] || joints_.nodes[at(parent)] < 0) continue;
    bool usable = false;
    const Mat4 back = inverse_or_identity(rest(j), &usable);
    if (!usable) continue;
    reference_[at(parent)] = reference_[at(j)] * (back * rest(parent));
    known_[at(parent)] = 1;
  }
  for (int j = 0; j < count; ++j) {
    if (known_[at(j)]) continue;
    known_[at(j)] = 1;
    const int parent = parents[at(j)];
    bool usable = parent >= 0;
    const Mat4 back = usable ? inverse_or_identity(rest(parent), &usable) : Mat4::Identity();
    reference_[at(j)] = usable ? Mat4(reference_[at(parent)] * (back * rest(j))) : rest(j);
  }
}

void Finder::report_binds() {
  if (unusable_ > 0) {
    report_joint(
        diagnostics_, Severity::warning, "scene-bind",
        fmt::format("{} cannot be inverted, first that of {}; such joints use the transform of "
                    "their node",
                    counted(static_cast<long long>(unusable_), "inverse bind matrix",
                            "inverse bind matrices"),
                    shown(first_unusable_)),
        first_unusable_);
  }
  if (joints_.skins.empty()) return;
  // Joints that are moved, as eyes of another face, count from a two thousandth of the size on.
  double widest = 0, farthest = 0;
  int worst = -1, moved = -1;
  for (int j = 1; j < joints_.count(); ++j) {
    const int parent = joints_.parents[at(j)];
    const auto local = [&](const Mat4& above, const Mat4& here) {
      return nodes::rigid_part(above).inverse() * nodes::rigid_part(here);
    };
    const Transform shown_there = local(rest(parent), rest(j));
    const Transform bound_there = local(reference_[at(parent)], reference_[at(j)]);
    const double angle = angle_between(shown_there.orientation, bound_there.orientation);
    const double distance = (shown_there.position - bound_there.position).norm();
    if (distance > std::max(farthest, 5e-4 * size_)) {
      farthest = distance;
      moved = j;
    }
    if (angle > std::max(widest, 0.5 * kRadiansPerDegree)) {
      widest = angle;
      worst = j;
    }
  }
  if (worst < 0 && moved < 0) return;
  const int node = joints_.nodes[at(worst < 0 ? moved : worst)];
  const std::string joint = node < 0 ? std::string() : scene_.nodes[at(node)].name;
  report_joint(
      diagnostics_, Severity::note, "scene-pose",
      fmt::format("without animation the nodes are not in the bind pose of the mesh ({} is {}); "
                  "the bind pose is the reference pose",
                  shown(joint),
                  worst < 0 ? fmt::format("moved by {} of the file's units", readable(farthest, 3))
                            : fmt::format("rotated by {} degrees",
                                          readable(widest / kRadiansPerDegree, 3))),
      joint);
}

}  // namespace

Mat4 inverse_or_identity(const Mat4& matrix, bool* usable) {
  const Mat3 linear = matrix.topLeftCorner<3, 3>();
  const double size = linear.norm();
  const double determinant = linear.determinant();
  const bool works = matrix.allFinite() && size > 1e-100 && size < 1e100 &&
                     std::abs(determinant) > 1e-9 * size * size * size;
  if (usable != nullptr) *usable = works;
  Mat4 result = Mat4::Identity();
  if (!works) return result;
  const Mat3 back = linear.inverse();
  result.topLeftCorner<3, 3>() = back;
  result.topRightCorner<3, 1>() = -(back * matrix.topRightCorner<3, 1>());
  return result;
}

bool nearly_same(const Mat4& a, const Mat4& b, double size) {
  constexpr double kTolerance = 1e-4;
  const Mat3 linear = a.topLeftCorner<3, 3>() - b.topLeftCorner<3, 3>();
  const Vec3 offset = a.topRightCorner<3, 1>() - b.topRightCorner<3, 1>();
  return linear.norm() <= kTolerance * b.topLeftCorner<3, 3>().norm() &&
         offset.norm() <= kTolerance * size;
}

BindPose find_bind_pose(const Scene& scene, const nodes::Evaluator& evaluator, const Joints& joints,
                        const Mat4& to_axes, Diagnostics& diagnostics) {
  return Finder(scene, evaluator, joints, to_axes, diagnostics).find();
}

}  // namespace krok::character
