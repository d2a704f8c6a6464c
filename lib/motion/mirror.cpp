#include "motion/mirror.h"

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <utility>

#include "core/index.h"
#include "math/quaternion.h"
#include "motion/hips_root.h"

namespace krok {

namespace {

// Mirrors points and rotations at x = 0; a rotation's axis is a pseudovector.
Vec3 image(const Vec3& point) {
  return {-point.x(), point.y(), point.z()};
}
Quat image(const Quat& q) {
  return {q.w(), q.x(), -q.y(), -q.z()};
}

constexpr double kSameOffset = 1e-7;  // metres

// How own bones lie to the images of the partner's: the singular values of the correlation of both.
// Of the joint in the mirrored motion they are the same, with the same lines, so that what is
// decided by them is decided alike when it is mirrored again.
class Correlation {
 public:
  explicit Correlation(const Mat3& own_to_images)
      : svd_(own_to_images, Eigen::ComputeFullU | Eigen::ComputeFullV) {}

  // Whether all bones lie about in one line, which tells nothing of the twist about it.
  bool leaves_twist() const {
    constexpr double kOffLine = 0.01;  // of a bone
    return svd_.singularValues()[1] < kOffLine * kOffLine * svd_.singularValues()[0];
  }

  // The angle between the lines of own bones, turned, and of the images.
  double angle_after(const Quat& turn) const {
    return std::atan2((turn * own()).cross(images()).norm(), (turn * own()).dot(images()));
  }

  // The rotation that takes own bones to the images (Horn, Closed-form solution of absolute
  // orientation using orthonormal matrices, J. Opt. Soc. Am. A 5, 1988). A twist that they leave
  // open is that of `usual`.
  Quat turn(const Quat& usual) const {
    if (leaves_twist()) return shortest_arc(usual * own(), images()) * usual;
    Mat3 flip = Mat3::Identity();
    flip(2, 2) = (svd_.matrixU() * svd_.matrixV().transpose()).determinant() < 0 ? -1 : 1;
    return normalized_or_identity(Quat(Mat3(svd_.matrixU() * flip * svd_.matrixV().transpose())));
  }

  // The line of own bones.
  Vec3 own() const { return svd_.matrixV().col(0); }

 private:
  Vec3 images() const { return svd_.matrixU().col(0); }

  Eigen::JacobiSVD<Mat3> svd_;
};

// Over the joint and those below it in the reference pose.
double extent_below(const Skeleton& skeleton, int joint) {
  std::vector<std::uint8_t> below(skeleton.names.size(), 0);
  Eigen::AlignedBox3d box;
  for (int j = joint; j < skeleton.joint_count(); ++j) {
    below[at(j)] = j == joint || below[at(skeleton.parents[at(j)])] != 0 ? 1 : 0;
    if (below[at(j)] != 0) box.extend(skeleton.reference[at(j)].position);
  }
  return box.diagonal().norm();
}

// How joints' own axes stand to those of their partners, see axes_to_images().
class AxesFinder {
 public:
  // `pose`: joint_to_world of a posture, or empty.
  AxesFinder(const Skeleton& skeleton, const MirrorPairs& pairs, std::span<const Transform> pose)
      : skeleton_(skeleton),
        pairs_(pairs),
        pose_(pose),
        children_(skeleton.children()),
        least_(0.01 * extent_below(skeleton, pairs.carrier)),
        found_(skeleton.names.size(), Quat::Identity()),
        turned_(skeleton.names.size(), 0) {}

  std::vector<Quat> find() {
    for (int j = 0; j < skeleton_.joint_count(); ++j) {
      const int other = pairs_.partners[at(j)];
      if (other == MirrorPairs::kNone) continue;
      found_[at(j)] = other < j ? image(found_[at(other)].conjugate()) : of(j, other);
      if (other < j) turned_[at(j)] = turned_[at(other)];
    }
    return std::move(found_);
  }

 private:
  // Offsets of a joint's children and the images of those of their partners.
  struct Bones {
    std::vector<Vec3> own, images;
  };
  Bones bones(int joint, int other) const {
    Bones result;
    for (const int child : children_[at(joint)]) {
      const int partner = pairs_.partners[at(child)];
      if (partner == MirrorPairs::kNone || skeleton_.parents[at(partner)] != other) continue;
      result.own.push_back(bone(joint, child));
      result.images.push_back(image(bone(other, partner)));
    }
    return result;
  }

  // In the parent's axes. Files whose joints have position channels need not state offsets that
  // agree with them: where the posture has another direction, its offset counts.
  Vec3 bone(int parent, int child) const {
    const Vec3 stated = skeleton_.reference_local(child).position;
    if (pose_.empty()) return stated;
    const Vec3 moved = pose_[at(parent)].inverse() * pose_[at(child)].position;
    return moved.dot(stated) < kSameWay * moved.norm() * stated.norm() ? moved : stated;
  }

  static double misfit(const Bones& bones, const Quat& turn) {
    double most = 0;
    for (std::size_t k = 0; k < bones.own.size(); ++k) {
      most = std::max(most, (turn * bones.own[k] - bones.images[k]).norm());
    }
    return most;
  }

  Quat of(int joint, int other) {
    const Quat by_reference = image(skeleton_.reference[at(other)].orientation).conjugate() *
                              skeleton_.reference[at(joint)].orientation;
    const int parent = skeleton_.parents[at(joint)];
    const bool has_parents =
        parent >= 0 && pairs_.partners[at(parent)] == skeleton_.parents[at(other)];
    const Bones all = bones(joint, other);
    double size = 0;
    for (const Vec3& bone : all.own) size = std::max(size, bone.norm());
    if (size < least_) {
      if (!has_parents) return by_reference;
      // Turned in its parent as its partner is in the reference pose.
      return image(skeleton_.reference_local(other).orientation).conjugate() * found_[at(parent)] *
             skeleton_.reference_local(joint).orientation;
    }
    const Correlation correlation(correlation_of(all));
    // In most captures joints have their parents' axes at rest, and need no reference pose.
    const bool turned_above = has_parents && turned_[at(parent)] != 0;
    const bool by_parent =
        has_parents &&
        correlation.angle_after(found_[at(parent)]) < (turned_above ? kBent : kFits) &&
        (turned_above || correlation.angle_after(by_reference) >= kFits);
    turned_[at(joint)] = by_parent && turned_above ? 1 : 0;
    Quat usual = by_parent ? found_[at(parent)] : by_reference;
    if (joint == other && has_parents && !pose_.empty() && correlation.leaves_twist()) {
      usual = by_posture(joint, correlation, usual);
    }
    // The usual case to the bit, whatever the rounding of the offsets was.
    const Quat fitted = misfit(all, usual) < kSameOffset ? usual : correlation.turn(usual);
    const bool at_trunk = parent >= 0 && pairs_.partners[at(parent)] == parent;
    if (joint != other && at_trunk && correlation.leaves_twist()) {
      return by_quarter_turns(joint, other, correlation, fitted);
    }
    const bool is_paired = joint != other && has_parents && correlation.leaves_twist();
    return is_paired ? by_half_turn(joint, other, correlation, fitted) : fitted;
  }

  // For a joint with a single bone next to the trunk. Reference poses whose left chains run along
  // +x and right ones along -x leave the twist to convention: of quarter turns about the bone, the
  // one that turns the joint least in its parent, if it does so clearly less than `fitted`.
  Quat by_quarter_turns(int joint, int other, const Correlation& correlation, const Quat& fitted) {
    std::vector<Quat> turns;
    for (int quarter = 1; quarter < 4; ++quarter) {
      turns.push_back(fitted * Quat(Eigen::AngleAxisd(quarter * kPi / 2, correlation.own())));
    }
    const Quat best = least_changed(joint, other, fitted, std::move(turns));
    turned_[at(joint)] = best.coeffs() == fitted.coeffs() ? 0 : 1;
    return best;
  }

  // The same for other joints of limbs with a single bone, such as feet, of a half turn alone:
  // forearms turn by far, but not by that much.
  Quat by_half_turn(int joint, int other, const Correlation& correlation, const Quat& fitted) {
    if (pose_.empty() || change(joint, other, fitted) < kPi - kHalfTurnWithin) return fitted;
    const Quat turn = fitted * Quat(Eigen::AngleAxisd(kPi, correlation.own()));
    if (change(joint, other, turn) > kHalfTurnWithin) return fitted;
    turned_[at(joint)] = 1;
    return turn;
  }

  // Of `turns` the one that turns the joint least in its parent, where that is clearly less than
  // what `usual` does, and what `usual` would do to the mirrored motion: it is decided alike when
  // that is mirrored again.
  Quat least_changed(int joint, int other, const Quat& usual, std::vector<Quat> turns,
                     double clearly_less = kClearlyLess) const {
    if (pose_.empty()) return usual;
    const auto changed = [&](const Quat& turn) { return change(joint, other, turn); };
    std::ranges::stable_sort(turns, {}, changed);
    for (const Quat& turn : turns) {
      const double before = std::min(changed(usual), changed(turn * usual.conjugate() * turn));
      if (before - changed(turn) > clearly_less) return turn;
    }
    return usual;
  }

  // By how much mirroring turns the joint in its parent, both of the posture.
  double change(int joint, int other, const Quat& turn) const {
    return angle_between(Quat::Identity(), change_by(joint, other, turn));
  }
  // What leads back, in the joint's axes.
  Quat change_by(int joint, int other, const Quat& turn) const {
    const int parent = skeleton_.parents[at(joint)], source = skeleton_.parents[at(other)];
    const Quat before = pose_[at(parent)].orientation.conjugate() * pose_[at(joint)].orientation;
    const Quat theirs = pose_[at(source)].orientation.conjugate() * pose_[at(other)].orientation;
    return (found_[at(parent)].conjugate() * image(theirs) * turn).conjugate() * before;
  }

  // The axes that the nearest joint of the middle below, whose bones leave nothing open, has.
  std::optional<Quat> below(int joint) const {
    for (const int child : children_[at(joint)]) {
      if (pairs_.partners[at(child)] != child) continue;
      const Bones all = bones(child, child);
      double size = 0;
      for (const Vec3& bone : all.own) size = std::max(size, bone.norm());
      if (size < least_) continue;
      const Correlation correlation(correlation_of(all));
      return correlation.leaves_twist() ? below(child) : correlation.turn(Quat::Identity());
    }
    return {};
  }

  // For a joint of the middle with a single bone: some reference poses are twisted between hips and
  // chest, and say nothing. Mirrored, people stand about as before: of `usual` and the axes of the
  // joints above and below, those which turn the joint least in its parent; where these turn it
  // far, `usual` turned about the bone.
  Quat by_posture(int joint, const Correlation& correlation, const Quat& usual) const {
    // As they will be, fitted to the bone: it is decided alike when mirrored again.
    const Quat fitted = correlation.turn(usual);
    std::vector<Quat> turns;
    const auto consider = [&](const Quat& turn) {
      if (correlation.angle_after(turn) < kBent) turns.push_back(correlation.turn(turn));
    };
    consider(found_[at(skeleton_.parents[at(joint)])]);
    const auto found = below(joint);
    if (found) consider(*found);
    // Mirroring turns a head that looks aside by twice as much.
    const double clearly_less = found ? kClearlyLess : 2 * kLooksAside;
    const Quat chosen = least_changed(joint, joint, fitted, std::move(turns), clearly_less);
    const bool of_body = pairs_.in_body.empty() || pairs_.in_body[at(joint)] != 0;
    if (chosen.coeffs() != fitted.coeffs()) return chosen;
    if (!of_body) return usual;
    // The bone alone says nothing of the twist about it: half round, or else whatever it is.
    const auto twisted = [&](double angle) {
      return Quat(fitted * Quat(Eigen::AngleAxisd(angle, correlation.own())));
    };
    const Quat left = change_by(joint, joint, fitted);
    const double twist = 2 * std::atan2(left.vec().dot(correlation.own()), left.w());
    for (const double angle : {kPi, twist}) {
      const Quat turn = least_changed(joint, joint, fitted, {twisted(angle)}, clearly_less);
      if (turn.coeffs() != fitted.coeffs()) return turn;
    }
    return usual;
  }

  static Mat3 correlation_of(const Bones& bones) {
    Mat3 correlation = Mat3::Zero();
    for (std::size_t k = 0; k < bones.own.size(); ++k) {
      correlation += bones.images[k] * bones.own[k].transpose();
    }
    return correlation;
  }

  static constexpr double kFits = 0.01;    // radians
  static constexpr double kSameWay = 0.9;  // cosine
  static constexpr double kBent = 0.3;     // radians, between joints of a spine
  static constexpr double kHalfTurnWithin = 40 * kRadiansPerDegree;
  static constexpr double kClearlyLess = 60 * kRadiansPerDegree;
  static constexpr double kLooksAside = 55 * kRadiansPerDegree;  // all the time

  const Skeleton& skeleton_;
  const MirrorPairs& pairs_;
  std::span<const Transform> pose_;
  std::vector<std::vector<int>> children_;
  double least_;
  std::vector<Quat> found_;
  std::vector<std::uint8_t> turned_;  // 1 where by_quarter_turns() changed the twist, and below
};

constexpr double kStill = 2 * kRadiansPerDegree;     // relative to the parent, over the whole clip
constexpr double kTwisted = 60 * kRadiansPerDegree;  // the turn by mirroring

constexpr double kFixed = 1e-3;  // radians

// What joints do over the whole motion.
struct Rests {
  std::vector<std::uint8_t> still;  // not part of the body, does not rotate in its parent
  std::vector<std::uint8_t> fixed;  // above the hips, does not rotate in the world
};

Result<Rests> rests_in(const FrameSource& source, const MirrorPairs& pairs, int jobs) {
  const std::size_t joints = source.skeleton.names.size();
  Rests rests = {std::vector<std::uint8_t>(joints, 0), std::vector<std::uint8_t>(joints, 0)};
  if (source.frame_count == 0) return rests;
  std::vector<std::size_t> above, outside;
  for (int j = source.skeleton.parents[at(pairs.carrier)]; j >= 0;
       j = source.skeleton.parents[at(j)]) {
    above.push_back(at(j));
  }
  for (std::size_t j = 1; j < pairs.in_body.size(); ++j) {
    if (pairs.in_body[j] == 0) outside.push_back(j);
  }
  if (above.empty() && outside.empty()) return rests;
  for (const std::size_t j : above) rests.fixed[j] = 1;
  for (const std::size_t j : outside) rests.still[j] = 1;
  std::vector<Transform> pose(joints);
  std::vector<Quat> first_local(joints), first_world(joints);
  const auto local = [&](std::size_t j) {
    const int parent = source.skeleton.parents[j];
    return Quat(pose[at(parent)].orientation.conjugate() * pose[j].orientation);
  };
  const Status status = for_each_block(source, jobs, [&](int first, const Clip& block) {
    for (int f = 0; f < block.frame_count(); ++f) {
      block.get_pose(f, pose);
      for (const std::size_t j : above) {
        const Quat& now = pose[j].orientation;
        if (first + f == 0) first_world[j] = now;
        if (!(angle_between(first_world[j], now) < kFixed)) rests.fixed[j] = 0;
      }
      for (const std::size_t j : outside) {
        if (rests.still[j] == 0) continue;
        if (first + f == 0) first_local[j] = local(j);
        rests.still[j] = angle_between(first_local[j], local(j)) <= kStill ? 1 : 0;
      }
    }
    return Status();
  });
  if (!status) return status.error();
  return rests;
}

// Mirrors poses of one skeleton.
class PoseMirror {
 public:
  PoseMirror(const Skeleton& skeleton, const MirrorPairs& pairs, std::span<const Transform> posture)
      : skeleton_(skeleton), pairs_(pairs), axes_(axes_to_images(skeleton, pairs, posture)) {}

  // The axes of joints above the hips: one that is fixed, or keeps to the hips' ground frame in the
  // first frame, is turned as before.
  void find_axes_above(const Clip& first, std::span<const std::uint8_t> fixed) {
    for (int j = skeleton_.parents[at(pairs_.carrier)]; j >= 0; j = skeleton_.parents[at(j)]) {
      Quat turn = first.frame_orientations(0)[at(j)].cast<double>().normalized();
      if (fixed[at(j)] == 0) {
        turn = ground_frame(first, pairs_.carrier, 0).to_world().orientation.conjugate() * turn;
      }
      axes_[at(j)] = image(turn).conjugate() * turn;
    }
  }

  // Leaves still joints turned in their parents as they are where the mirror image of `pose` has
  // them turned far from that.
  void keep_twisted(std::span<const Transform> pose, std::span<const std::uint8_t> still) {
    std::vector<Transform> mirrored(pose.size());
    for (int j = 0; j < skeleton_.joint_count(); ++j) {
      place(j, pose, mirrored);
      const int source = pairs_.partners[at(j)];
      if (still[at(j)] == 0 || source == MirrorPairs::kNone || still[at(source)] == 0) continue;
      const auto parent = at(skeleton_.parents[at(j)]);
      const Quat before = pose[parent].orientation.conjugate() * pose[at(j)].orientation;
      const Quat after = mirrored[parent].orientation.conjugate() * mirrored[at(j)].orientation;
      if (angle_between(before, after) <= kTwisted) continue;
      axes_[at(j)] =
          image(pose[at(source)].orientation).conjugate() * mirrored[parent].orientation * before;
      place(j, pose, mirrored);
    }
  }

  void operator()(std::span<const Transform> pose, std::span<Transform> mirrored) const {
    for (int j = 0; j < skeleton_.joint_count(); ++j) place(j, pose, mirrored);
  }

  // The skeleton whose bones are as long, and set at the angles, as the images of the partners'.
  Skeleton mirrored_skeleton() const {
    Skeleton result = skeleton_;
    for (int j = 1; j < skeleton_.joint_count(); ++j) {
      const int parent = skeleton_.parents[at(j)], source = pairs_.partners[at(j)];
      Transform local = skeleton_.reference_local(j);
      if (source != MirrorPairs::kNone &&
          skeleton_.parents[at(source)] == pairs_.partners[at(parent)]) {
        const Vec3 offset =
            axes_[at(parent)].conjugate() * image(skeleton_.reference_local(source).position);
        if ((offset - local.position).norm() > kSameOffset) local.position = offset;
      }
      result.reference[at(j)] = result.reference[at(parent)] * local;
    }
    return result;
  }

 private:
  // Joints above it are placed already.
  void place(int j, std::span<const Transform> pose, std::span<Transform> mirrored) const {
    const int source = pairs_.partners[at(j)];
    if (source == MirrorPairs::kNone) {
      const int parent = skeleton_.parents[at(j)];
      mirrored[at(j)] = mirrored[at(parent)] * (pose[at(parent)].inverse() * pose[at(j)]);
      return;
    }
    mirrored[at(j)] = {image(pose[at(source)].position),
                       normalized_or_identity(image(pose[at(source)].orientation) * axes_[at(j)])};
  }

  Skeleton skeleton_;
  MirrorPairs pairs_;
  std::vector<Quat> axes_;
};

}  // namespace

std::vector<Quat> axes_to_images(const Skeleton& skeleton, const MirrorPairs& pairs,
                                 std::span<const Transform> posture) {
  return AxesFinder(skeleton, pairs, posture).find();
}

Clip mirror(const Clip& clip, const MirrorPairs& pairs, std::span<const Transform> posture) {
  // Frames of a clip are always there.
  Clip result = *load(*mirror(frames_of(clip), pairs, 1, posture), 1);
  result.provenance = clip.provenance;
  return result;
}

Result<FrameSource> mirror(const FrameSource& source, const MirrorPairs& pairs, int jobs,
                           std::span<const Transform> posture) {
  const auto frame = [&](int number) {
    return load(part_of(source, number, std::min(source.frame_count, 1)), 1);
  };
  const auto first = frame(0), last = frame(std::max(source.frame_count - 1, 0));
  const auto usual = usual_pose(source);
  if (!first) return first.error();
  if (!last) return last.error();
  if (!usual) return usual.error();
  const auto mirror_pose = std::make_shared<PoseMirror>(
      source.skeleton, pairs, posture.empty() ? std::span<const Transform>(*usual) : posture);
  if (source.frame_count > 0) {
    const auto rests = rests_in(source, pairs, jobs);
    if (!rests) return rests.error();
    mirror_pose->find_axes_above(*first, rests->fixed);
    mirror_pose->keep_twisted(usual_pose(*last), rests->still);
  }
  FrameSource result = changed(source, [mirror_pose](Clip& frames) {
    std::vector<Transform> pose(frames.skeleton.names.size()), mirrored(pose.size());
    for (int f = 0; f < frames.frame_count(); ++f) {
      frames.get_pose(f, pose);
      (*mirror_pose)(pose, mirrored);
      frames.set_pose(f, mirrored);
    }
    return Status();
  });
  result.skeleton = mirror_pose->mirrored_skeleton();
  return result;
}

}  // namespace krok
