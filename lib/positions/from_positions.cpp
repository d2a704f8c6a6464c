#include "positions/from_positions.h"

#include <Eigen/SVD>
#include <algorithm>
#include <array>
#include <cmath>
#include <complex>

#include "core/index.h"
#include "core/parallel.h"
#include "math/quaternion.h"
#include "roles/limbs.h"

namespace krok {

namespace {

constexpr double kNoLength = 1e-5;  // metres: a bone without a direction
constexpr std::size_t kGrain = 256;
constexpr std::size_t kFramesOfShape = 2000;

// The rotation nearest to a sum of outer products target * source^T.
Quat nearest_rotation(const Mat3& products) {
  const Eigen::JacobiSVD<Mat3> parts(products, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Mat3 u = parts.matrixU();
  if ((u * parts.matrixV().transpose()).determinant() < 0) u.col(2) *= -1;
  return Quat(Mat3(u * parts.matrixV().transpose())).normalized();
}

// The angle of a rotation about an axis (unit), in (-pi, pi].
double twist_about(const Vec3& axis, const Quat& rotation) {
  double angle = 2 * std::atan2(rotation.vec().dot(axis), rotation.w());
  if (angle > kPi) angle -= 2 * kPi;
  if (angle <= -kPi) angle += 2 * kPi;
  return angle;
}

void unwrap(std::vector<double>& angles) {
  double turns = 0, mean = 0;
  for (std::size_t t = 1; t < angles.size(); ++t) {
    angles[t] += turns;
    const double more = -2 * kPi * std::round((angles[t] - angles[t - 1]) / (2 * kPi));
    angles[t] += more;
    turns += more;
  }
  for (const double angle : angles) mean += angle / static_cast<double>(angles.size());
  const double whole = 2 * kPi * std::round(mean / (2 * kPi));
  for (double& angle : angles) angle -= whole;
}

// Angles that follow `measured` by their weights, and zero weakly: the least sum of
// weight |z - measured|^2 + smoothness |steps of z|^2 + pull |z - 1|^2 over unit complex numbers,
// of which the lengths are left free, so that the system is linear.
std::vector<double> angles_over_time(std::span<const double> measured,
                                     std::span<const double> weights, double smoothness,
                                     double pull) {
  const std::size_t n = measured.size();
  std::vector<double> upper(n, 0);
  std::vector<std::complex<double>> z(n);
  for (std::size_t t = 0; t < n; ++t) {
    double diagonal = weights[t] + pull + (t > 0 ? smoothness : 0) + (t + 1 < n ? smoothness : 0);
    z[t] = std::polar(weights[t], measured[t]) + pull;
    if (t > 0) {
      diagonal -= smoothness * upper[t - 1];
      z[t] += smoothness * z[t - 1];
    }
    upper[t] = smoothness / diagonal;
    z[t] /= diagonal;
  }
  std::vector<double> angles(n);
  for (std::size_t t = n; t-- > 0;) {
    if (t + 1 < n) z[t] += upper[t] * z[t + 1];
    angles[t] = std::arg(z[t]);
  }
  return angles;
}

class Solver {
 public:
  explicit Solver(const PositionsToPose& input)
      : input_(input),
        parents_(input.skeleton.parents),
        children_(input.skeleton.children()),
        joints_(parents_.size()),
        frames_(joints_ == 0 ? 0 : input.positions.size() / joints_),
        measured_(joints_ * frames_),
        placed_(joints_ * frames_),
        turns_(joints_ * frames_, Quat::Identity()),
        offsets_(joints_, Vec3::Zero()),
        weights_(joints_, 1) {
    for (std::size_t f = 0; f < frames_; ++f) {
      for (std::size_t j = 0; j < joints_; ++j) {
        measured_[j * frames_ + f] = input.positions[f * joints_ + j];
      }
    }
    for (std::size_t j = 0; j < joints_; ++j) {
      if (parents_[j] < 0) continue;
      offsets_[j] =
          input.skeleton.reference[j].position - input.skeleton.reference[at(parents_[j])].position;
    }
  }

  PoseFromPositions solve() {
    find_noise();
    if (frames_ > 0) {
      place(true);
      if (shift_root()) place(false);
      twist_limbs();
      spread_twists();
    }
    finish();
    return std::move(result_);
  }

 private:
  using Track = std::span<Quat>;
  Track turns_of(std::size_t joint) { return std::span(turns_).subspan(joint * frames_, frames_); }
  std::span<Vec3> measured_of(std::size_t joint) {
    return std::span(measured_).subspan(joint * frames_, frames_);
  }

  void find_noise() {
    const std::vector<double> noise = noise_of(parents_, measured_);
    double squares = 0, worst = 0;
    for (const double n : noise) {
      squares += n * n / static_cast<double>(joints_);
      worst = std::max(worst, n);
    }
    result_.noise = std::sqrt(squares);
    if (!input_.smooth || worst == 0) return;
    std::vector<char> changed(joints_, 0);
    parallel_for(joints_, 1, input_.jobs, [&](std::size_t begin, std::size_t end) {
      for (std::size_t j = begin; j < end; ++j) {
        changed[j] = smooth_track(measured_of(j), noise[j], input_.rate) ? 1 : 0;
      }
    });
    result_.smoothed = std::ranges::find(changed, 1) != changed.end();
    for (std::size_t j = 0; j < joints_ && result_.smoothed; ++j) {
      const double trust = std::max(noise[j] / result_.noise, 0.1);
      weights_[j] = 1 / (trust * trust);
    }
  }

  // Rotations and places from the root down. With `measure`, offsets are measured first.
  void place(bool measure) {
    for (std::size_t j = 0; j < joints_; ++j) {
      if (parents_[j] < 0 && measure) std::ranges::copy(measured_of(j), &placed_[j * frames_]);
      const std::vector<int>& children = children_[j];
      if (children.size() == 1) {
        if (measure) measure_bone(j, at(children[0]));
        point(j, at(children[0]));
      } else if (children.size() > 1) {
        if (measure) measure_shape(j);
        fit(j);
      } else if (parents_[j] >= 0) {
        std::ranges::copy(turns_of(at(parents_[j])), turns_of(j).begin());
      }
      for (const int child : children) {
        for (std::size_t f = 0; f < frames_; ++f) {
          placed_[at(child) * frames_ + f] =
              placed_[j * frames_ + f] + turns_[j * frames_ + f] * offsets_[at(child)];
        }
      }
    }
  }

  Quat turn_above(std::size_t joint, std::size_t frame) const {
    return parents_[joint] < 0 ? Quat::Identity() : turns_[at(parents_[joint]) * frames_ + frame];
  }
  Vec3 way(std::size_t joint, std::size_t child, std::size_t frame) const {
    return measured_[child * frames_ + frame] - measured_[joint * frames_ + frame];
  }

  void measure_bone(std::size_t j, std::size_t child) {
    double length = 0;
    Vec3 mean = Vec3::Zero();
    for (std::size_t f = 0; f < frames_; ++f) {
      length += way(j, child, f).norm();
      mean += turn_above(j, f).conjugate() * way(j, child, f);
    }
    const Vec3& direction = offsets_[child].norm() > kNoLength ? offsets_[child] : mean;
    offsets_[child] = length / static_cast<double>(frames_) * direction.stableNormalized();
  }

  Mat3 products(std::size_t j, std::size_t frame, const Vec3& from) const {
    Mat3 sum = Mat3::Zero();
    double size = 0;
    for (const int child : children_[j]) {
      const Vec3 weighted = weights_[at(child)] * offsets_[at(child)];
      sum += (measured_[at(child) * frames_ + frame] - from) * weighted.transpose();
      size += weighted.dot(offsets_[at(child)]);
    }
    // The parent's rotation decides what the children leave open.
    return sum + 1e-6 * std::max(size, 1e-12) * turn_above(j, frame).toRotationMatrix();
  }

  // The mean offsets of several children in their joint's frame.
  void measure_shape(std::size_t j) {
    const std::size_t step = (frames_ + kFramesOfShape - 1) / kFramesOfShape;
    bool none = true;
    for (const int child : children_[j]) none = none && offsets_[at(child)].norm() <= kNoLength;
    if (none) {
      for (const int child : children_[j]) {
        offsets_[at(child)] = turn_above(j, 0).conjugate() * way(j, at(child), 0);
      }
    }
    std::vector<Vec3> reference;
    for (const int child : children_[j]) reference.push_back(offsets_[at(child)]);
    for (int iteration = 0; iteration < 3; ++iteration) {
      std::vector<Vec3> sums(children_[j].size(), Vec3::Zero());
      double count = 0;
      for (std::size_t f = 0; f < frames_; f += step) {
        const Quat back = nearest_rotation(products(j, f, measured_[j * frames_ + f])).conjugate();
        for (std::size_t c = 0; c < sums.size(); ++c) {
          sums[c] += back * way(j, at(children_[j][c]), f);
        }
        ++count;
      }
      for (std::size_t c = 0; c < sums.size(); ++c) offsets_[at(children_[j][c])] = sums[c] / count;
    }
    // As the reference pose stands, as nearly as the shape allows.
    Mat3 sum = 1e-9 * Mat3::Identity();
    for (std::size_t c = 0; c < reference.size(); ++c) {
      sum += reference[c] * offsets_[at(children_[j][c])].transpose();
    }
    const Quat turn = nearest_rotation(sum);
    for (const int child : children_[j]) offsets_[at(child)] = turn * offsets_[at(child)];
  }

  void fit(std::size_t j) {
    parallel_for(frames_, kGrain, input_.jobs, [&](std::size_t begin, std::size_t end) {
      for (std::size_t f = begin; f < end; ++f) {
        turns_[j * frames_ + f] = nearest_rotation(products(j, f, placed_[j * frames_ + f]));
      }
    });
  }

  void point(std::size_t j, std::size_t child) {
    const bool known = offsets_[child].norm() > kNoLength;
    for (std::size_t f = 0; f < frames_; ++f) {
      const Quat above = turn_above(j, f);
      Quat& turn = turns_[j * frames_ + f];
      turn = above;
      const Vec3 to = measured_[child * frames_ + f] - placed_[j * frames_ + f];
      if (!known || to.norm() < kNoLength) continue;
      turn = (shortest_arc(above * offsets_[child], to) * above).normalized();
    }
  }

  // Moves the root so that the joints are right in the mean; false if they are.
  bool shift_root() {
    double largest = 0;
    for (std::size_t f = 0; f < frames_; ++f) {
      Vec3 sum = Vec3::Zero();
      double weights = 0;
      for (std::size_t j = 0; j < joints_; ++j) {
        sum += weights_[j] * (measured_[j * frames_ + f] - placed_[j * frames_ + f]);
        weights += weights_[j];
      }
      placed_[f] += sum / weights;
      largest = std::max(largest, sum.norm() / weights);
    }
    return largest > 1e-7;
  }

  // Turns a joint with one child about its bone.
  void twist(std::size_t j, std::size_t frame, double angle) {
    Quat& turn = turns_[j * frames_ + frame];
    turn = (turn * Quat(Eigen::AngleAxisd(angle, bone(j)))).normalized();
  }
  Vec3 bone(std::size_t j) const { return offsets_[at(children_[j][0])].stableNormalized(); }

  bool has_bone(int joint) const {
    return joint >= 0 && children_[at(joint)].size() == 1 &&
           offsets_[at(children_[at(joint)][0])].norm() > kNoLength;
  }

  // The chain's joints below `from` down to the first that is no link, with the rotations that
  // follow from that of `from`.
  void point_below(std::size_t from) {
    for (std::size_t j = from; children_[j].size() == 1;) {
      j = at(children_[j][0]);
      if (children_[j].size() == 1) {
        point(j, at(children_[j][0]));
      } else if (children_[j].empty()) {
        std::ranges::copy(turns_of(at(parents_[j])), turns_of(j).begin());
      }
    }
  }

  void twist_limb(int upper, int lower, int end, const Vec3& forward) {
    if (!has_bone(upper) || lower < 0 || end < 0) return;
    const std::size_t u = at(upper);
    const auto& reference = input_.skeleton.reference;
    const Vec3 first = reference[at(lower)].position - reference[u].position;
    const Vec3 second = reference[at(end)].position - reference[at(lower)].position;
    // The hinge, as the reference pose shows it or as anatomy has it.
    Vec3 hinge = first.cross(second);
    if (hinge.norm() < 0.17 * first.norm() * second.norm()) hinge = first.cross(forward);
    hinge -= hinge.dot(bone(u)) * bone(u);
    if (hinge.norm() < 1e-9) return;
    hinge.normalize();
    std::vector<double> angles(frames_), weights(frames_);
    for (std::size_t f = 0; f < frames_; ++f) {
      const Vec3 along = way(u, at(lower), f), beyond = way(at(lower), at(end), f);
      const double size = along.norm() * beyond.norm();
      if (size < 1e-8) continue;
      const Vec3 normal = along.cross(beyond);
      const Vec3 local = turns_[u * frames_ + f].conjugate() * normal;
      angles[f] = std::atan2(bone(u).dot(hinge.cross(local)), hinge.dot(local));
      weights[f] = normal.squaredNorm() / (size * size);
    }
    const double steps = 0.05 * input_.rate;
    const auto found = angles_over_time(angles, weights, 0.003 * steps * steps, 1e-5);
    for (std::size_t f = 0; f < frames_; ++f) twist(u, f, found[f]);
    point_below(u);
  }

  void twist_limbs() {
    for (const ArmRoles& arm : kArmRoles) {
      const auto joint = [&](Role role) { return input_.roles.joint(role); };
      twist_limb(joint(arm.upper), joint(arm.lower), joint(arm.hand), Vec3::UnitZ());
    }
    for (const LegRoles& leg : kLegRoles) {
      const auto joint = [&](Role role) { return input_.roles.joint(role); };
      twist_limb(joint(leg.upper), joint(leg.lower), joint(leg.foot), -Vec3::UnitZ());
    }
  }

  // The share of the twist between the ends of a chain that a link and those above it take.
  double share_of(std::size_t joint, std::size_t place, std::size_t links) const {
    switch (joint < input_.roles.roles.size() ? input_.roles.roles[joint] : Role::none) {
      case Role::left_lower_arm:
      case Role::right_lower_arm:
        return 1;
      case Role::left_upper_arm:
      case Role::right_upper_arm:
      case Role::left_upper_leg:
      case Role::right_upper_leg:
      case Role::left_lower_leg:
      case Role::right_lower_leg:
        return 0;
      default:
        return static_cast<double>(place + 1) / static_cast<double>(links + 1);
    }
  }

  void spread_twists() {
    for (std::size_t end = 0; end < joints_; ++end) {
      if (children_[end].size() < 2) continue;
      std::vector<std::size_t> links;
      for (int j = parents_[end]; has_bone(j); j = parents_[at(j)]) links.push_back(at(j));
      // From a joint known in full to the next.
      if (links.empty() || parents_[links.back()] < 0) continue;
      std::ranges::reverse(links);
      std::vector<double> angles(frames_);
      for (std::size_t f = 0; f < frames_; ++f) {
        angles[f] = twist_about(bone(links.back()), turns_[links.back() * frames_ + f].conjugate() *
                                                        turns_[end * frames_ + f]);
      }
      unwrap(angles);
      for (std::size_t i = 0; i < links.size(); ++i) {
        const double share = share_of(links[i], i, links.size());
        for (std::size_t f = 0; share > 0 && f < frames_; ++f) {
          twist(links[i], f, share * angles[f]);
        }
      }
    }
  }

  void finish() {
    Clip& clip = result_.clip;
    clip.skeleton = input_.skeleton;
    clip.rate = input_.rate;
    auto& reference = clip.skeleton.reference;
    for (std::size_t j = 0; j < joints_ && frames_ > 0; ++j) {
      if (parents_[j] >= 0) {
        reference[j].position = reference[at(parents_[j])].position + offsets_[j];
      }
    }
    clip.resize(static_cast<int>(frames_));
    double squares = 0;
    for (std::size_t f = 0; f < frames_; ++f) {
      for (std::size_t j = 0; j < joints_; ++j) {
        const std::size_t from = j * frames_ + f, to = f * joints_ + j;
        clip.positions[to] = placed_[from].cast<float>();
        clip.orientations[to] =
            (turns_[from] * input_.skeleton.reference[j].orientation).normalized().cast<float>();
        const double off = (placed_[from] - input_.positions[to]).norm();
        squares += off * off;
        if (off <= result_.largest) continue;
        result_.largest = off;
        result_.largest_joint = static_cast<int>(j);
        result_.largest_frame = static_cast<int>(f);
      }
    }
    if (frames_ > 0) result_.rms = std::sqrt(squares / static_cast<double>(placed_.size()));
    measure_variation();
  }

  void measure_variation() {
    double bones = 0;
    for (std::size_t j = 0; j < joints_ && frames_ > 0; ++j) {
      const double length = offsets_[j].norm();
      if (parents_[j] < 0 || length < kNoLength) continue;
      double squares = 0;
      for (std::size_t f = 0; f < frames_; ++f) {
        const Vec3 here =
            input_.positions[f * joints_ + j] - input_.positions[f * joints_ + at(parents_[j])];
        squares += (here.norm() - length) * (here.norm() - length);
      }
      result_.length_variation += std::sqrt(squares / static_cast<double>(frames_)) / length;
      ++bones;
    }
    if (bones > 0) result_.length_variation /= bones;
  }

  const PositionsToPose& input_;
  const std::vector<int>& parents_;
  const std::vector<std::vector<int>> children_;
  const std::size_t joints_, frames_;
  std::vector<Vec3> measured_, placed_;  // [joints x frames]
  std::vector<Quat> turns_;              // [joints x frames] from the reference pose, in world axes
  std::vector<Vec3> offsets_;            // [joints] from the parent, in the reference pose
  std::vector<double> weights_;          // [joints] by noise
  PoseFromPositions result_;
};

}  // namespace

PoseFromPositions from_positions(const PositionsToPose& input) {
  return Solver(input).solve();
}

}  // namespace krok
