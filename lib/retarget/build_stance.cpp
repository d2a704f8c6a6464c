#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>
#include <utility>

#include "core/index.h"
#include "math/quaternion.h"
#include "retarget/actor_view_internal.h"
#include "retarget/pose_alignment.h"
#include "roles/roles.h"

namespace krok::retarget {

namespace {

// Share of the frames, in which a foot is flat on the ground.
constexpr double kLowest = 0.05;
constexpr float kUpright = 0.7F;  // cosine of a shank's angle with up, over a foot that stands
// From the ankle to the ball of a foot on the ground, and by how much feet differ from it.
constexpr double kUsualPitch = -0.5, kPitchRange = 0.6;
// Cosine of the angle by which bones may be off a T-pose's.
constexpr double kStraight = 0.97;
// Sine of the mean bend of a limb that shows its hinge.
constexpr double kBends = 0.02;

struct Limb {
  Role root, upper, lower, end;
  Vec3 along, hinge;  // in a T-pose: of its bones; of (upper bone) x (lower bone) where it bends
};

const Vec3 kLeft = Vec3::UnitX(), kUpwards = Vec3::UnitY(), kForward = Vec3::UnitZ();

class StanceBuilder {
 public:
  StanceBuilder(const Clip& clip, const RoleMap& roles)
      : clip_(clip),
        roles_(roles),
        pose_(clip.skeleton.reference),
        step_(step_in_take(clip.frame_count())) {}

  std::vector<Transform> build(bool limbs) {
    if (limbs && begins_in_a_stance()) {
      clip_.get_pose(0, pose_);
      return std::move(pose_);
    }
    take_bones();
    stand_up(limbs);
    if (!limbs) return std::move(pose_);
    turn_chest();
    straighten_limbs();
    level_head();
    return std::move(pose_);
  }

  // From a reference pose that is a frame of a motion: bones have their lengths in it, but where
  // trunk and head are turned is the frame's.
  std::vector<Transform> build_from_frame() {
    const int hips = roles_.joint(Role::hips);
    const Vec3 from = place(hips);
    const double ground = lowest();
    is_frame_ = true;
    stand_up(true);
    const std::vector<int> path = trunk();
    const int neck = roles_.joint(Role::neck);
    for (std::size_t i = 0; i + 1 < path.size() && path[i] != neck; ++i) {
      point(path[i], place(path[i + 1]) - place(path[i]), kUpwards, kForward);
    }
    turn_chest();
    const bool by_axes = align_by_axes(path);
    straighten_limbs();
    if (!by_axes) level_head();
    Vec3 moved = from - place(hips);
    moved.y() = ground - lowest();
    for (Transform& joint : pose_) joint.position += moved;
    return std::move(pose_);
  }

  // Some exporters put a T-pose before the motion: it shows more than bones do.
  bool begins_in_a_stance() const {
    if (clip_.frame_count() == 0) return false;
    const auto positions = clip_.frame_positions(0);
    const auto bone = [&](Role from, Role to) {
      const int a = roles_.joint(from), b = roles_.joint(to);
      if (a < 0 || b < 0) return Vec3(Vec3::Zero());
      return Vec3((positions[at(b)] - positions[at(a)]).cast<double>().stableNormalized());
    };
    const Vec3 left = bone(Role::right_upper_leg, Role::left_upper_leg);
    double least = 1;
    const auto limb = [&](Role upper, Role lower, Role end, const Vec3& along) {
      least = std::min({least, bone(upper, lower).dot(along), bone(lower, end).dot(along)});
    };
    limb(Role::left_upper_leg, Role::left_lower_leg, Role::left_foot, -kUpwards);
    limb(Role::right_upper_leg, Role::right_lower_leg, Role::right_foot, -kUpwards);
    limb(Role::left_upper_arm, Role::left_lower_arm, Role::left_hand, left);
    limb(Role::right_upper_arm, Role::right_lower_arm, Role::right_hand, -left);
    return least > kStraight;
  }

 private:
  void straighten_limbs() {
    straighten(Limb{Role::left_collar, Role::left_upper_arm, Role::left_lower_arm, Role::left_hand,
                    kLeft, -kUpwards},
               Limb{Role::right_collar, Role::right_upper_arm, Role::right_lower_arm,
                    Role::right_hand, -kLeft, kUpwards});
    straighten(Limb{Role::root, Role::left_upper_leg, Role::left_lower_leg, Role::left_foot,
                    -kUpwards, kLeft},
               Limb{Role::root, Role::right_upper_leg, Role::right_lower_leg, Role::right_foot,
                    -kUpwards, kLeft});
    if (is_frame_) turn_feet_ahead();
    const std::vector<FootOnGround> on_ground = feet_on_ground();
    flatten(Role::left_foot, on_ground);
    flatten(Role::right_foot, on_ground);
    bend_toes(on_ground);
  }

  double lowest() const {
    double least = HUGE_VAL;
    for (const Transform& joint : pose_) least = std::min(least, joint.position.y());
    return least;
  }

  // Rigs give the joints of trunk and head the same axes across the body and upwards: where hips
  // and chest show them, those of a head that the frame has aside or bowed are known, too. Returns
  // whether they are.
  bool align_by_axes(const std::vector<int>& path) {
    constexpr double kShown = 0.9, kNear = 0.3;
    const int chest = roles_.joint(Role::chest), head = roles_.joint(Role::head);
    if (path.empty() || chest < 0 || head < 0) return false;
    // The axis of the hips that is along a direction, if that of the chest is, too.
    const auto shared_axis = [&](const Vec3& along) {
      const Vec3 hips = pose_[at(path.front())].orientation.conjugate() * along;
      Eigen::Index axis = 0;
      hips.cwiseAbs().maxCoeff(&axis);
      const Vec3 unit = Vec3::Unit(axis) * std::copysign(1.0, hips[axis]);
      const bool shown =
          hips.dot(unit) > kShown && (pose_[at(chest)].orientation * unit).dot(along) > kShown;
      return shown ? unit : Vec3(Vec3::Zero());
    };
    const Vec3 across = shared_axis(kLeft), upright = shared_axis(kUpwards);
    const auto align = [&](int joint, const Vec3& axis, const Vec3& along) {
      const Vec3 now = pose_[at(joint)].orientation * axis;
      if (!(now.dot(along) > kNear)) return false;
      turn(joint, shortest_arc(now, along));
      return true;
    };
    if (across.isZero()) return false;
    for (const int joint : path) align(joint, across, kLeft);
    return !upright.isZero() && align(head, upright, kUpwards);
  }

  Vec3 place(int joint) const { return pose_[at(joint)].position; }
  Vec3 between(Role from, Role to) const {
    const int a = roles_.joint(from), b = roles_.joint(to);
    return a < 0 || b < 0 ? Vec3(Vec3::Zero()) : Vec3(place(b) - place(a));
  }

  // Turns a joint and what is below it.
  void turn(int joint, const Quat& turn) {
    std::vector<char> inside(pose_.size(), 0);
    const Vec3 pivot = place(joint);
    for (int j = joint; j < clip_.joint_count(); ++j) {
      const int parent = clip_.skeleton.parents[at(j)];
      inside[at(j)] = j == joint || (parent >= 0 && inside[at(parent)] != 0) ? 1 : 0;
      if (inside[at(j)] == 0) continue;
      Transform& its = pose_[at(j)];
      its = {pivot + turn * (its.position - pivot), (turn * its.orientation).normalized()};
    }
  }

  // Turns a joint so that the direction to another is `along`; directions that are opposite by way
  // of `axis`.
  void point(int joint, const Vec3& bone, const Vec3& along, const Vec3& axis) {
    if (joint < 0 || !(bone.norm() > 0)) return;
    if (bone.normalized().dot(along) > -0.9) {
      turn(joint, shortest_arc(bone, along));
      return;
    }
    const Quat half = from_rotation_vector(kPi * axis);
    turn(joint, shortest_arc(half * bone, along) * half);
  }

  // Turns a joint about an axis so that a direction comes as near as it can to another.
  void roll(int joint, const Vec3& axis, const Vec3& from, const Vec3& to) {
    const Vec3 now = from - from.dot(axis) * axis, wanted = to - to.dot(axis) * axis;
    if (joint < 0 || !(now.norm() > 1e-6) || !(wanted.norm() > 1e-6)) return;
    const double angle = std::atan2(now.cross(wanted).dot(axis), now.dot(wanted));
    turn(joint, from_rotation_vector(angle * axis));
  }

  // Bones as the motion has them on average: some exporters write their lengths alone into the
  // reference pose. Joints that bones do not show (heads, feet) keep the reference pose's rotation,
  // or that by quarter turns which is nearest to the motion's, where it is another rig's.
  void take_bones() {
    const Skeleton& skeleton = clip_.skeleton;
    std::vector<Vec3> offsets(pose_.size(), Vec3::Zero());
    std::vector<Mat3> turns(pose_.size(), Mat3::Zero());
    int count = 0;
    for (int f = 0; f < clip_.frame_count(); f += step_, ++count) {
      const auto positions = clip_.frame_positions(f);
      const auto orientations = clip_.frame_orientations(f);
      for (int j = 1; j < clip_.joint_count(); ++j) {
        const std::size_t parent = at(skeleton.parents[at(j)]);
        const Quat back = orientations[parent].cast<double>().normalized().conjugate();
        offsets[at(j)] += back * (positions[at(j)] - positions[parent]).cast<double>();
        if (!shown_by_motion(j)) continue;
        const Quat local = back * orientations[at(j)].cast<double>().normalized();
        turns[at(j)] +=
            (skeleton.reference_local(j).orientation.conjugate() * local).toRotationMatrix();
      }
    }
    const std::vector<Quat> quarters = quarter_turns(turns);
    for (int j = 1; count > 0 && j < clip_.joint_count(); ++j) {
      const Quat local = skeleton.reference_local(j).orientation * quarters[at(j)];
      pose_[at(j)] = pose_[at(skeleton.parents[at(j)])] * Transform{offsets[at(j)] / count, local};
    }
  }

  // Those of all joints. A rig has them on both sides; on one alone they are a hand that is held
  // aside throughout a take.
  std::vector<Quat> quarter_turns(const std::vector<Mat3>& sums) const {
    std::vector<Quat> turns;
    for (const Mat3& sum : sums) turns.push_back(quarter_turns(sum));
    for (const auto& [left, right] : {std::pair(Role::left_collar, Role::right_collar),
                                      std::pair(Role::left_hand, Role::right_hand),
                                      std::pair(Role::left_foot, Role::right_foot),
                                      std::pair(Role::left_toes, Role::right_toes)}) {
      const int a = roles_.joint(left), b = roles_.joint(right);
      if (a < 0 || b < 0) continue;
      const auto none = [&](int joint) { return std::abs(turns[at(joint)].w()) > 0.99; };
      if (none(a) || none(b)) turns[at(a)] = turns[at(b)] = Quat::Identity();
    }
    return turns;
  }

  bool shown_by_motion(int joint) const {
    switch (roles_.roles[at(joint)]) {
      case Role::spine:
      case Role::chest:
      case Role::neck:
      case Role::head:
      case Role::left_collar:
      case Role::right_collar:
      case Role::left_hand:
      case Role::right_hand:
      case Role::left_foot:
      case Role::right_foot:
      case Role::left_toes:
      case Role::right_toes:
        return true;
      default:
        return false;
    }
  }

  // Of the 24 rotations by quarter turns the one nearest to the mean of some; none for their sum 0.
  // None, too, where the mean is not clearly another's (beyond about 65 degrees about one axis):
  // hands are turned by half a quarter in whole takes.
  static Quat quarter_turns(const Mat3& sum) {
    constexpr double kClearly = 1.5;
    Mat3 best = Mat3::Identity();
    double most = best.cwiseProduct(sum).sum();
    if (most > 0) most *= kClearly;
    std::array<int, 3> axes = {0, 1, 2};
    do {
      for (int signs = 0; signs < 8; ++signs) {
        Mat3 turn = Mat3::Zero();
        for (int k = 0; k < 3; ++k) turn(axes[at(k)], k) = ((signs >> k) & 1) != 0 ? -1 : 1;
        const double alike = turn.cwiseProduct(sum).sum();
        if (turn.determinant() < 0 || alike <= most) continue;
        most = alike;
        best = turn;
      }
    } while (std::ranges::next_permutation(axes).found);
    return Quat(best).normalized();
  }

  // From the hips to the head or neck; empty if there is no such way.
  std::vector<int> trunk() const {
    const int hips = roles_.joint(Role::hips), head = roles_.joint(Role::head);
    std::vector<int> path;
    for (int j = head >= 0 ? head : roles_.joint(Role::neck); j >= 0;
         j = clip_.skeleton.parents[at(j)]) {
      path.push_back(j);
      if (j == hips) {
        std::ranges::reverse(path);
        return path;
      }
    }
    return {};
  }

  // The pelvis upright if the trunk is to be straightened, else the trunk as a whole.
  void stand_up(bool straighten) {
    const std::vector<int> path = trunk();
    if (path.size() < 2) return;
    const Vec3 left = between(Role::right_upper_leg, Role::left_upper_leg);
    Vec3 up = place(path.back()) - place(path.front());
    for (std::size_t i = 1; straighten && i < path.size(); ++i) {
      const Vec3 bone = place(path[i]) - place(path.front());
      if (bone.norm() < 0.2 * left.norm()) continue;
      up = bone;
      break;
    }
    const Vec3 ahead = left.cross(up);
    if (!(ahead.norm() > 1e-6 * left.norm() * up.norm()) || !(ahead.norm() > 0)) return;
    if (up.normalized().y() > 0.8) {  // within 37 degrees; people lean a little
      roll(0, kUpwards, left, kLeft);
    } else {
      Mat3 body;
      body << left.normalized(), ahead.cross(left).normalized(), ahead.normalized();
      turn(0, Quat(Mat3(body.transpose())).normalized());
    }
    for (std::size_t i = 1; straighten && i + 1 < path.size(); ++i) {
      const Vec3 bone = place(path[i + 1]) - place(path[i]);
      if (bone.normalized().y() < 0.8) point(path[i], bone, kUpwards, kForward);
    }
    // As a whole, up to the neck, which heads are ahead of: what it leans is the motion's.
    const int neck = roles_.joint(Role::neck) >= 0 ? roles_.joint(Role::neck) : path.back();
    const Vec3 whole = place(neck) - place(path.front());
    if (straighten && whole.norm() > 0) turn(0, shortest_arc(whole, kUpwards));
  }

  // The trunk's joints may turn about it from one to the next.
  void turn_chest() {
    const int hips = roles_.joint(Role::hips);
    int above = roles_.joint(Role::left_upper_arm);
    while (above >= 0 && clip_.skeleton.parents[at(above)] != hips) {
      above = clip_.skeleton.parents[at(above)];
    }
    roll(above, kUpwards, between(Role::right_upper_arm, Role::left_upper_arm), kLeft);
  }

  void straighten(const Limb& left, const Limb& right) {
    const std::array limbs = {left, right};
    if (std::ranges::all_of(limbs, [&](const Limb& limb) { return is_arm_of_a_stance(limb); }))
      return;
    for (const Limb& limb : limbs) straighten(limb);
    const std::array hinges = {hinge_of(left), hinge_of(right)};
    for (std::size_t i = 0; i < limbs.size(); ++i) {
      const Limb& limb = limbs[i];
      const int upper = roles_.joint(limb.upper);
      Vec3 hinge = hinges[i];
      if (hinge.norm() < kBends) hinge = likely_hinge(limb, hinges[1 - i]);
      if (upper >= 0) roll(upper, limb.along, pose_[at(upper)].orientation * hinge, limb.hinge);
    }
  }

  // Arms may hang or be held anywhere but folded or up, as long as the shoulders are aside.
  bool is_arm_of_a_stance(const Limb& limb) const {
    if (limb.root == Role::root || is_frame_) return false;
    const auto bone = [&](Role from, Role to) {
      return Vec3(between(from, to).stableNormalized());
    };
    const Vec3 root = bone(limb.root, limb.upper), upper = bone(limb.upper, limb.lower);
    const Vec3 lower = bone(limb.lower, limb.end);
    return (root.isZero() || root.dot(limb.along) > 0.7) && upper.y() < 0.7 &&
           (lower.isZero() || upper.dot(lower) > 0.5);
  }

  void straighten(const Limb& limb) {
    const Vec3 across = limb.along.cross(limb.hinge);
    const int root = limb.root == Role::root ? -1 : roles_.joint(limb.root);
    const int upper = roles_.joint(limb.upper), lower = roles_.joint(limb.lower);
    point(root, between(limb.root, limb.upper), limb.along, across);
    point(upper, between(limb.upper, lower >= 0 ? limb.lower : limb.end), limb.along, across);
    point(lower, between(limb.lower, limb.end), limb.along, across);
  }

  // For a limb that never bends: the other side's, in the direction in which it is nearer to a
  // T-pose's when the bone is turned there by the least. Rigs have both sides' axes alike or
  // opposite.
  Vec3 likely_hinge(const Limb& limb, const Vec3& others) const {
    const int upper = roles_.joint(limb.upper);
    const int next =
        roles_.joint(limb.lower) >= 0 ? roles_.joint(limb.lower) : roles_.joint(limb.end);
    if (others.norm() < kBends || upper < 0 || next < 0) return Vec3::Zero();
    double alike = 0;
    for (int f = 0; f < clip_.frame_count(); f += step_) {
      const Quat trunk = trunk_turn(f);
      const auto positions = clip_.frame_positions(f);
      const Vec3 bone = (positions[at(next)] - positions[at(upper)]).cast<double>();
      const Quat frame = clip_.frame_orientations(f)[at(upper)].cast<double>().normalized();
      const Vec3 expected = shortest_arc(trunk * limb.along, bone) * (trunk * limb.hinge);
      alike += expected.dot(frame * others);
    }
    return alike < 0 ? Vec3(-others) : others;
  }

  // Bones do not show how far a head nods. People who do not lie look ahead, on average.
  void level_head() {
    constexpr double kLies = 0.5;  // the trunk's rise
    constexpr double kNods = 10 * kRadiansPerDegree;
    const int head = roles_.joint(Role::head), hips = roles_.joint(Role::hips);
    const int left = roles_.joint(Role::left_upper_leg),
              right = roles_.joint(Role::right_upper_leg);
    if (head < 0 || hips < 0 || left < 0 || right < 0) return;
    Vec3 ahead = Vec3::Zero();
    for (int f = 0; f < clip_.frame_count(); f += step_) {
      const auto positions = clip_.frame_positions(f);
      const Vec3 trunk = (positions[at(head)] - positions[at(hips)]).cast<double>();
      if (trunk.stableNormalized().y() < kLies) continue;
      const Vec3 across = (positions[at(left)] - positions[at(right)]).cast<double>();
      const Quat heading = axis_rotation(Axis::y, std::atan2(-across.z(), across.x()));
      const Quat now = clip_.frame_orientations(f)[at(head)].cast<double>().normalized();
      ahead += heading.conjugate() * now * (pose_[at(head)].orientation.conjugate() * kForward);
    }
    const double nod = std::atan2(-ahead.y(), ahead.z());
    if (ahead.z() > 0 && std::abs(nod) > kNods) turn(head, from_rotation_vector(nod * kLeft));
  }

  // From the pose that is built to a frame, of the hips.
  Quat trunk_turn(int frame) const {
    const int hips = roles_.joint(Role::hips);
    return clip_.frame_orientations(frame)[at(hips)].cast<double>().normalized() *
           pose_[at(hips)].orientation.conjugate();
  }

  // The mean of (upper bone) x (lower bone) over the motion, in the upper joint's frame.
  Vec3 hinge_of(const Limb& limb) const {
    const int upper = roles_.joint(limb.upper), lower = roles_.joint(limb.lower);
    const int end = roles_.joint(limb.end);
    Vec3 sum = Vec3::Zero();
    int count = 0;
    if (upper < 0 || lower < 0 || end < 0) return sum;
    for (int f = 0; f < clip_.frame_count(); f += step_, ++count) {
      const auto positions = clip_.frame_positions(f);
      const Vec3 first = (positions[at(lower)] - positions[at(upper)]).cast<double>();
      const Vec3 second = (positions[at(end)] - positions[at(lower)]).cast<double>();
      const Quat frame = clip_.frame_orientations(f)[at(upper)].cast<double>().normalized();
      sum += frame.conjugate() * first.stableNormalized().cross(second.stableNormalized());
    }
    return count > 0 ? Vec3(sum / count) : sum;
  }

  // A foot in a frame in which it may be flat on the ground.
  struct FootOnGround {
    float height;  // of ankle and ball together
    double pitch;  // radians; upwards is positive
    int frame;
    Role foot;
  };

  // Legs of a frame are turned: both feet point outwards by as much, and by little. Rigs have an
  // axis of a foot level with its sole, across it.
  void turn_feet_ahead() {
    constexpr double kMaxOut = 10 * kRadiansPerDegree, kAcross = 0.8;
    std::array<Vec3, 2> ways = {Vec3::Zero(), Vec3::Zero()};
    double out = 0;
    for (std::size_t side = 0; side < 2; ++side) {
      const int foot = roles_.joint(kLegRoles[side].foot);
      const int front = foot_front(clip_.skeleton, roles_, kLegRoles[side].foot);
      if (foot < 0 || front < 0) return;
      ways[side] = place(front) - place(foot);
      out += (side == 0 ? 0.5 : -0.5) * std::atan2(ways[side].x(), ways[side].z());
    }
    out = std::clamp(out, 0.0, kMaxOut);
    for (std::size_t side = 0; side < 2; ++side) {
      const Vec3 wanted = std::cos(out) * kForward + (side == 0 ? 1 : -1) * std::sin(out) * kLeft;
      const int foot = roles_.joint(kLegRoles[side].foot);
      roll(foot, kUpwards, ways[side], wanted);
      const Vec3 across = kUpwards.cross(wanted);
      const Vec3 local = pose_[at(foot)].orientation.conjugate() * across;
      Eigen::Index axis = 0;
      if (local.cwiseAbs().maxCoeff(&axis) < kAcross) continue;
      const Vec3 unit = Vec3::Unit(axis) * std::copysign(1.0, local[axis]);
      roll(foot, wanted, pose_[at(foot)].orientation * unit, across);
    }
  }

  // Turns a foot about the ankle's hinge to the pitch that feet have on the ground.
  void flatten(Role role, const std::vector<FootOnGround>& on_ground) {
    const int foot = roles_.joint(role), front = foot_front(clip_.skeleton, roles_, role);
    if (foot < 0 || front < 0) return;
    const Vec3 now = place(front) - place(foot);
    const double own = std::asin(std::clamp(now.y() / std::max(now.norm(), 1e-9), -1.0, 1.0));
    const bool known = std::abs(own - kUsualPitch) < kPitchRange;
    if (on_ground.empty() && known) return;
    const double pitch = on_ground.empty() ? kUsualPitch : on_ground[on_ground.size() / 2].pitch;
    // What of it points aside stays.
    const Vec3 wanted = std::cos(pitch) * kForward + std::sin(pitch) * kUpwards;
    roll(foot, kLeft, now, wanted);
  }

  // Bends the toes as they are then: by the median of both sides, about the ankle's hinge alone.
  void bend_toes(const std::vector<FootOnGround>& on_ground) {
    std::vector<double> bends;
    for (const FootOnGround& one : on_ground) {
      const int toes = toes_of(one.foot);
      if (toes < 0) continue;
      const std::size_t parent = at(clip_.skeleton.parents[at(toes)]);
      const auto orientations = clip_.frame_orientations(one.frame);
      const Quat local =
          orientations[parent].cast<double>().conjugate() * orientations[at(toes)].cast<double>();
      const Quat bend = pose_[parent].orientation * local * pose_[at(toes)].orientation.conjugate();
      const double angle = 2 * std::atan2(bend.vec().dot(kLeft), bend.w());
      bends.push_back(std::remainder(angle, 2 * kPi));
    }
    if (bends.empty()) return;
    const auto middle = bends.begin() + static_cast<std::ptrdiff_t>(bends.size() / 2);
    std::ranges::nth_element(bends, middle);
    for (const Role foot : {Role::left_foot, Role::right_foot}) {
      const int toes = toes_of(foot);
      if (toes >= 0) turn(toes, from_rotation_vector(*middle * kLeft));
    }
  }

  // The first joint of a foot's toes if it is the foot's child, else -1.
  int toes_of(Role foot) const {
    const int toes = roles_.joint(foot == Role::left_foot ? Role::left_toes : Role::right_toes);
    return toes >= 0 && clip_.skeleton.parents[at(toes)] == roles_.joint(foot) ? toes : -1;
  }

  // By pitch. A foot is flat where ankle and ball are both low: on tiptoe and on the heel one of
  // them is not. Of both feet together, as a take may hold one of them up. Nobody stands on the
  // feet of a leg that lies or kneels.
  std::vector<FootOnGround> feet_on_ground() const {
    std::vector<FootOnGround> frames;
    for (const LegRoles& leg : kLegRoles) {
      const Role role = leg.foot;
      const int foot = roles_.joint(role), front = foot_front(clip_.skeleton, roles_, role);
      const int knee = roles_.joint(leg.lower);
      if (foot < 0 || front < 0) continue;
      for (int f = 0; f < clip_.frame_count(); f += step_) {
        const auto positions = clip_.frame_positions(f);
        if (knee >= 0) {
          const Vec3f shank = positions[at(knee)] - positions[at(foot)];
          if (shank.y() < kUpright * shank.norm()) continue;
        }
        const Vec3 bone = (positions[at(front)] - positions[at(foot)]).cast<double>();
        const double sine = bone.y() / std::max(bone.norm(), 1e-9);
        frames.push_back({positions[at(foot)].y() + positions[at(front)].y(),
                          std::asin(std::clamp(sine, -1.0, 1.0)), f, role});
      }
    }
    if (frames.empty()) return frames;
    const auto by_height = [](const FootOnGround& a) {
      return std::tuple(a.height, a.frame, a.foot);
    };
    std::ranges::sort(frames, {}, by_height);
    frames.resize(1 + static_cast<std::size_t>(kLowest * static_cast<double>(frames.size() - 1)));
    std::ranges::stable_sort(frames, {}, &FootOnGround::pitch);
    return frames;
  }

  const Clip& clip_;
  const RoleMap& roles_;
  std::vector<Transform> pose_;
  int step_;
  bool is_frame_ = false;  // the reference pose is one of a motion
};

}  // namespace

int step_in_take(int frames) {
  constexpr int kMaxFrames = 2000;
  return 1 + frames / kMaxFrames;
}

std::vector<Transform> build_stance(const Clip& clip, const RoleMap& roles, bool limbs) {
  return StanceBuilder(clip, roles).build(limbs);
}

std::vector<Transform> build_stance_from_frame(const Clip& clip, const RoleMap& roles) {
  return StanceBuilder(clip, roles).build_from_frame();
}

bool begins_in_a_stance(const Clip& clip, const RoleMap& roles) {
  return StanceBuilder(clip, roles).begins_in_a_stance();
}

}  // namespace krok::retarget
