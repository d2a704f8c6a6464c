#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/index.h"
#include "core/parallel.h"
#include "math/hermite.h"
#include "math/quaternion.h"
#include "settle/settler_internal.h"

namespace krok::settling {

namespace {

// One over the square of what counts as an error of 1, in a frame.
constexpr double one_at(double error) {
  return 1 / (error * error);
}
constexpr double kOnGround = one_at(0.0015);                                     // metres
constexpr double kAside = one_at(0.01);                                          // metres, points
constexpr double kShiftAside = one_at(0.05), kShiftUp = one_at(1.0);             // metres, hips
constexpr double kYaw = one_at(0.05), kTilt = one_at(0.3), kUpright = 60;        // radians
constexpr double kTrunk = one_at(0.2), kLimb = one_at(0.3), kEnd = one_at(0.5);  // radians
constexpr double kHinge = one_at(0.5), kAcross = 30;
constexpr double kShiftBend = one_at(10), kTurnBend = one_at(13);  // metres, radians per second^2
// The change is as much smoother as the source accelerates less than the first, down to the second
// (metres per second^2), so that who hardly moves is not shaken; from pass to pass it is looser.
constexpr double kMoving = 40, kMinMoving = 0.3, kLoosening = 1.15;
constexpr double kStraight = 0.02;  // radians that knees stay bent, as far as they are
constexpr double kMaxTurn = 0.8, kBeyond = one_at(0.01);  // radians, of a joint
constexpr double kMaxLack = 0.03, kMaxPush = 0.1;         // metres, of a pass and of all
constexpr double kKept = 0.1;    // weight of a part's heights after the first pass
constexpr double kNearby = 200;  // of staying where the pass before ended: metres, radians
constexpr int kPasses = 60, kRounds = 4;
constexpr double kGain = 1e-4;                // share of the errors that a round must take away
constexpr double kDone = 2e-4;                // metres or radians
constexpr int kStretch = 480, kOverlap = 60;  // frames

// How a rotation turns on as its rotation vector changes (the left Jacobian of SO(3)).
Mat3 turning(const Vec3& v) {
  const double square = v.squaredNorm(), angle = std::sqrt(square);
  Mat3 cross;
  cross << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  if (angle < 1e-4) return Mat3::Identity() + 0.5 * cross;
  return Mat3::Identity() + (1 - std::cos(angle)) / square * cross +
         (angle - std::sin(angle)) / (square * angle) * cross * cross;
}

}  // namespace

void Settler::find_freedoms() {
  const auto is_one_of = [&](int joint, std::initializer_list<Role> roles) {
    const Role role = roles_.roles[at(joint)];
    return std::ranges::find(roles, role) != roles.end();
  };
  std::vector<int> freedom_of(parents_.size(), -1);
  for (const ragdoll::Body& body : bodies_) {
    Freedom freedom;
    freedom.joint = body.parent < 0 ? 0 : body.joint;
    freedom_of[at(freedom.joint)] = static_cast<int>(freedoms_.size());
    double damping = kLimb;
    if (is_one_of(body.joint, {Role::spine, Role::chest, Role::neck, Role::head})) damping = kTrunk;
    if (is_one_of(body.joint,
                  {Role::left_hand, Role::right_hand, Role::left_foot, Role::right_foot})) {
      damping = kEnd;
    }
    freedom.damping *= damping;
    freedoms_.push_back(freedom);
  }
  const std::array<std::array<Role, 3>, 4> limbs = {
      {{Role::left_upper_leg, Role::left_lower_leg, Role::left_foot},
       {Role::right_upper_leg, Role::right_lower_leg, Role::right_foot},
       {Role::left_upper_arm, Role::left_lower_arm, Role::left_hand},
       {Role::right_upper_arm, Role::right_lower_arm, Role::right_hand}}};
  std::vector<std::pair<Freedom*, Vec3>> bending;  // those of knees and elbows, and their axes
  for (const auto& [upper, lower, end] : limbs) {
    const int joint = roles_.joint(lower);
    if (joint < 0 || freedom_of[at(joint)] < 0) continue;
    Freedom& freedom = freedoms_[at(freedom_of[at(joint)])];
    freedom.bone_from = roles_.joint(upper);
    freedom.bone_to = roles_.joint(end);
    if (freedom.bone_from < 0 || freedom.bone_to < 0) continue;
    bending.emplace_back(&freedom, Vec3::Zero());
  }
  each(rooted_, [&](int, const LocalMotion& block) {
    for (int i = 0; i < block.frames; ++i) {
      const std::vector<Transform> pose = pose_of(block, i);
      for (auto& [freedom, sum] : bending) {
        const Vec3& middle = pose[at(freedom->joint)].position;
        const Vec3 axis = (middle - pose[at(freedom->bone_from)].position)
                              .cross(pose[at(freedom->bone_to)].position - middle);
        sum += pose[at(parents_[at(freedom->joint)])].orientation.conjugate() * axis;
      }
    }
  });
  for (const auto& [freedom, sum] : bending) {
    if (!(sum.norm() > 0)) continue;
    freedom->hinge = sum.normalized();
    const Mat3 along = *freedom->hinge * freedom->hinge->transpose();
    freedom->damping = kHinge * (along + kAcross * (Mat3::Identity() - along));
  }
  for (const ragdoll::Body& body : bodies_) {
    std::vector<std::size_t>& chain = chains_.emplace_back();
    for (int j = body.joint; j >= 0; j = parents_[at(j)]) {
      if (freedom_of[at(j)] >= 0) chain.push_back(at(freedom_of[at(j)]));
    }
  }
  values_.assign(at(frames()), Eigen::VectorXd::Zero(static_cast<Eigen::Index>(size())));
  for (int f = 0; f < frames(); ++f) values_[at(f)][1] = ground_below_[at(f)];
}

std::vector<Transform> Settler::moved_pose(int frame) const {
  const Eigen::VectorXd& values = values_[at(frame)];
  std::vector<Quat> turns(parents_.size(), Quat::Identity());
  for (std::size_t i = 0; i < freedoms_.size(); ++i) {
    turns[at(freedoms_[i].joint)] =
        from_rotation_vector(values.segment<3>(static_cast<Eigen::Index>(3 + 3 * i)));
  }
  std::vector<Transform> pose(parents_.size());
  for (std::size_t j = 0; j < pose.size(); ++j) {
    Transform local = stretch_.at(static_cast<int>(j), frame - stretch_first_);
    local.orientation = turns[j] * local.orientation;
    const int parent = parents_[j];
    if (parent < 0) {
      if (j == 0) local.position += values.head<3>();
      pose[j] = local;
    } else {
      pose[j] = pose[at(parent)] * local;
    }
  }
  return pose;
}

// 1 while the trunk is upright, 0 while it lies.
double Settler::upright(std::span<const Transform> pose) const {
  const int neck =
      roles_.joint(Role::neck) >= 0 ? roles_.joint(Role::neck) : roles_.joint(Role::head);
  const int hips = roles_.joint(Role::hips);
  if (!roles_.humanoid || neck < 0) return 0;
  const Vec3 trunk = (pose[at(neck)].position - pose[at(hips)].position).normalized();
  return smoother_step((trunk.y() - 0.3) / 0.6);
}

// How far a limb is bent about its hinge, radians.
double Settler::bend_of(const Freedom& freedom, std::span<const Transform> pose) const {
  const Vec3& middle = pose[at(freedom.joint)].position;
  const Vec3 upper = middle - pose[at(freedom.bone_from)].position;
  const Vec3 lower = pose[at(freedom.bone_to)].position - middle;
  const Vec3 axis = pose[at(parents_[at(freedom.joint)])].orientation * *freedom.hinge;
  return std::atan2(axis.dot(upper.cross(lower)), upper.dot(lower));
}

double Settler::add_damping(int frame, std::span<const Transform> pose, Eigen::MatrixXd& matrix,
                            Eigen::VectorXd& right) const {
  const Eigen::VectorXd& values = values_[at(frame)];
  const std::vector<Transform> source = pose_of(stretch_, frame - stretch_first_);
  Eigen::VectorXd off = values;
  off[1] -= ground_below_[at(frame)];
  const double tilt = kTilt * (1 + kUpright * upright(source));
  Eigen::VectorXd own(6);
  own << kShiftAside, kShiftUp, kShiftAside, tilt, kYaw, tilt;
  matrix.diagonal().head<6>() += own;
  right.head<6>() -= own.cwiseProduct(off.head<6>());
  double errors = 0.5 * off.head<6>().dot(own.cwiseProduct(off.head<6>()));
  if (!near_.empty()) {
    const Eigen::VectorXd away = values - near_[at(frame - stretch_first_)];
    matrix.diagonal().array() += kNearby;
    right -= kNearby * away;
    errors += 0.5 * kNearby * away.squaredNorm();
  }
  for (std::size_t i = 1; i < freedoms_.size(); ++i) {
    const Freedom& freedom = freedoms_[i];
    const auto row = static_cast<Eigen::Index>(3 + 3 * i);
    matrix.block<3, 3>(row, row) += freedom.damping;
    const Vec3 pull = freedom.damping * off.segment<3>(row);
    right.segment<3>(row) -= pull;
    errors += 0.5 * pull.dot(off.segment<3>(row));
    if (const double turn = off.segment<3>(row).norm(); turn > kMaxTurn) {
      const Vec3 axis = off.segment<3>(row) / turn;
      matrix.block<3, 3>(row, row) += kBeyond * axis * axis.transpose();
      right.segment<3>(row) -= kBeyond * (turn - kMaxTurn) * axis;
      errors += 0.5 * kBeyond * (turn - kMaxTurn) * (turn - kMaxTurn);
    }
    if (!freedom.hinge) continue;
    const double lack = std::min(kStraight, bend_of(freedom, source)) - bend_of(freedom, pose);
    if (!(lack > 0)) continue;
    matrix.block<3, 3>(row, row) += one_at(kStraight) * *freedom.hinge * freedom.hinge->transpose();
    right.segment<3>(row) += one_at(kStraight) * lack * *freedom.hinge;
    errors += 0.5 * one_at(kStraight) * lack * lack;
  }
  return errors;
}

double Settler::add_goals(int frame, std::span<const Transform> pose, Eigen::MatrixXd& matrix,
                          Eigen::VectorXd& right) const {
  const Eigen::VectorXd& values = values_[at(frame)];
  double errors = 0;
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    const auto [begin, end] = points_of_[b];
    const auto add_row = [&](const Vec3& place, const Vec3& axis, double weight, double lack) {
      errors += 0.5 * weight * lack * lack;
      // Turns of a joint move a point by turn x arm; along the axis that is turn . (arm x axis).
      std::array<std::pair<Eigen::Index, Vec3>, 24> parts;
      std::size_t count = 0;
      parts[count++] = {0, axis};
      for (const std::size_t i : chains_[b]) {
        const int joint = freedoms_[i].joint, parent = parents_[at(joint)];
        Vec3 part = (place - pose[at(joint)].position).cross(axis);
        if (parent >= 0) part = pose[at(parent)].orientation.conjugate() * part;
        part = turning(values.segment<3>(static_cast<Eigen::Index>(3 + 3 * i))).transpose() * part;
        if (count < parts.size()) parts[count++] = {static_cast<Eigen::Index>(3 + 3 * i), part};
      }
      for (std::size_t i = 0; i < count; ++i) {
        const auto& [row, own] = parts[i];
        right.segment<3>(row) += weight * lack * own;
        for (std::size_t k = 0; k < count; ++k) {
          const auto& [column, other] = parts[k];
          if (column <= row) matrix.block<3, 3>(row, column) += weight * own * other.transpose();
        }
      }
    };
    const double kept = near_.empty() ? 1 : std::min(1.0, kKept / static_cast<double>(end - begin));
    for (std::size_t p = begin; p < end; ++p) {
      const Target& target = targets_[at(frame - stretch_first_) * points_.size() + p];
      const Vec3 place = pose[at(bodies_[b].joint)] * points_[p].centre;
      const Vec3 moved = place - target.place;
      const double weight = target.pressed ? 1 : kept * target.weight;
      if (weight > 1e-6) {
        add_row(place, Vec3::UnitY() - target.slope, kOnGround * weight,
                target.pressed.value_or(target.rise) + target.slope.dot(moved) - moved.y());
        const double aside = kAside / static_cast<double>(end - begin) * target.weight;
        add_row(place, Vec3::UnitX(), aside, -moved.x());
        add_row(place, Vec3::UnitZ(), aside, -moved.z());
      }
    }
  }
  return errors;
}

double Settler::add_frames(int first, int last, const Eigen::VectorXd& bend,
                           SmoothSystem& system) const {
  const auto count = at(last - first + 1);
  std::vector<double> errors(count, 0);
  system.clear();
  parallel_for(count, 4, options_.jobs, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const int frame = first + static_cast<int>(i);
      Eigen::MatrixXd& matrix = system.matrix(static_cast<int>(i));
      Eigen::VectorXd& right = system.right(static_cast<int>(i));
      const std::vector<Transform> pose = moved_pose(frame);
      errors[i] = add_goals(frame, pose, matrix, right) + add_damping(frame, pose, matrix, right);
    }
  });
  double sum = 0;
  for (const double error : errors) sum += error;
  for (int f = std::max(first - 2, 0); f + 2 <= last; ++f) {
    const Eigen::VectorXd bent = values_[at(f)] - 2 * values_[at(f + 1)] + values_[at(f + 2)];
    sum += 0.5 * bent.dot(bend.cwiseProduct(bent));
  }
  return sum;
}

// Levenberg and Marquardt's method. The first pass lays the body on the ground as a whole; those
// after it, each near the one before, press single points on it, and the closest is kept.
void Settler::solve_stretch(int first, int last, double loose) {
  near_.clear();
  const int before = std::min(first, 2), count = last - first + 1;
  Eigen::VectorXd as_strong =
      Eigen::VectorXd::Constant(static_cast<Eigen::Index>(size()), kTurnBend);
  as_strong.head<3>().setConstant(kShiftBend);
  as_strong *= std::pow(rooted_.rate, 4);
  SmoothSystem system(count, as_strong.size());
  const auto stretch = std::span(values_).subspan(at(first - before), at(count + before));
  Values closest;
  double closest_off = std::numeric_limits<double>::infinity();
  for (int pass = 0; pass < kPasses; ++pass) {
    const Eigen::VectorXd bend = as_strong * one_at(loose);
    loose = std::min(1.0, kLoosening * loose);
    Values best(stretch.begin(), stretch.end());
    double least = std::numeric_limits<double>::infinity(), careful = 1e-2;
    for (int round = 0; round < kRounds; ++round) {
      double errors = add_frames(first, last, bend, system);
      if (errors > least) {
        std::ranges::copy(best, stretch.begin());
        careful *= 10;
        add_frames(first, last, bend, system);
      } else {
        std::ranges::copy(stretch, best.begin());
        const bool ends = least - errors < kGain * errors;
        least = errors;
        careful = std::max(careful / 4, 1e-4);
        if (ends) break;
      }
      for (int i = 0; i < count; ++i) system.matrix(i).diagonal() *= 1 + careful;
      const auto& steps = system.solve(stretch, before, bend);
      double largest = 0;
      for (int i = 0; i < count; ++i) {
        stretch[at(before + i)] += steps[at(i)];
        largest = std::max(largest, steps[at(i)].lpNorm<Eigen::Infinity>());
      }
      if (largest < kDone) break;
    }
    if (add_frames(first, last, bend, system) > least) std::ranges::copy(best, stretch.begin());
    const double off = correct_targets(first, last);
    near_.assign(stretch.begin() + before, stretch.end());
    if (off < closest_off) closest.assign(stretch.begin(), stretch.end());
    closest_off = std::min(off, closest_off);
    if (off < kTolerated / 2) break;
  }
  std::ranges::copy(closest, stretch.begin());
}

// Points that came into the ground are to be on it, and parts that touch and still hover lower. By
// the method of multipliers: what they lack is added to what they lacked before. Returns the max
// height or depth of what should be on the ground.
double Settler::correct_targets(int first, int last) {
  std::vector<double> off(at(last - first + 1), 0);
  parallel_for(off.size(), 4, options_.jobs, [&](std::size_t begin, std::size_t end) {
    std::vector<double> heights(points_.size());
    for (std::size_t f = at(first) + begin; f < at(first) + end; ++f) {
      const std::vector<Transform> pose = moved_pose(static_cast<int>(f));
      for (std::size_t b = 0; b < bodies_.size(); ++b) {
        const auto [from, to] = points_of_[b];
        double lowest = std::numeric_limits<double>::infinity();
        for (std::size_t p = from; p < to; ++p) {
          const Vec3 place = pose[at(bodies_[b].joint)] * points_[p].centre;
          heights[p] = over_rest(points_[p], place, static_cast<int>(f));
          lowest = std::min(lowest, heights[p]);
        }
        if (!std::isfinite(lowest)) continue;
        const bool rests = touches(b, f);
        off[f - at(first)] = std::max({off[f - at(first)], -lowest, rests ? lowest : 0});
        for (std::size_t p = from; p < to; ++p) {
          Target& target = targets_[(f - at(first)) * points_.size() + p];
          const double height = std::max(heights[p], -kMaxLack), above = std::max(lowest, 0.0);
          const bool lacks = height < 0 || (rests && height <= lowest + kTolerated);
          double& push = target.push;
          if (lacks) {
            push -= std::min(height, above);
          } else {
            push = push > 0 ? std::max(0.0, push - height) : std::min(0.0, push + height - above);
          }
          push = std::clamp(push, -kMaxPush, kMaxPush);
          target.pressed.reset();
          if (!lacks && push == 0) continue;
          const Vec3 place = pose[at(bodies_[b].joint)] * points_[p].centre;
          const Vec3 moved = place - target.place;
          target.slope = slope_under(points_[p], place, static_cast<int>(f));
          target.pressed = moved.y() - target.slope.dot(moved) - heights[p] + push;
        }
      }
    }
  });
  return *std::ranges::max_element(off);
}

void Settler::solve() {
  const double acceleration = differences(false, {0, 1, -2, 1}) * rooted_.rate * rooted_.rate;
  const double loose = std::clamp(acceleration, kMinMoving, kMoving) / kMoving;
  for (int first = 0; first < frames(); first += kStretch - kOverlap) {
    const int last = std::min(first + kStretch, frames()) - 1;
    set_targets(first, last);
    if (!status_) return;
    solve_stretch(first, last, loose);
    if (last + 1 == frames()) break;
  }
  raised_ = {};
}

SmoothSystem::SmoothSystem(int frames, Eigen::Index size)
    : matrix_(at(frames)),
      one_before_(at(frames)),
      two_before_(at(frames)),
      right_(at(frames)),
      size_(size) {
  clear();
}

void SmoothSystem::clear() {
  for (std::size_t f = 0; f < matrix_.size(); ++f) {
    for (auto* block : {&matrix_[f], &one_before_[f], &two_before_[f]}) {
      block->setZero(size_, size_);
    }
    right_[f].setZero(size_);
  }
}

const std::vector<Eigen::VectorXd>& SmoothSystem::solve(std::span<const Eigen::VectorXd> values,
                                                        int before, const Eigen::VectorXd& bend) {
  constexpr std::array<double, 3> kDifference = {1, -2, 1};
  const int count = static_cast<int>(values.size());
  for (int first = 0; first + 2 < count; ++first) {
    const Eigen::VectorXd bent =
        values[at(first)] - 2 * values[at(first + 1)] + values[at(first + 2)];
    for (int i = 0; i < 3; ++i) {
      const int row = first + i - before;
      if (row < 0) continue;
      right_[at(row)] -= kDifference[at(i)] * bend.cwiseProduct(bent);
      for (int k = 0; k <= i; ++k) {
        if (first + k < before) continue;
        auto& block = i == k ? matrix_ : i - k == 1 ? one_before_ : two_before_;
        block[at(row)].diagonal() += kDifference[at(i)] * kDifference[at(k)] * bend;
      }
    }
  }
  // Each block becomes the factor's; lower triangles on the diagonal.
  const int frames = count - before;
  const auto lower = [&](int f) { return matrix_[at(f)].triangularView<Eigen::Lower>(); };
  for (int f = 0; f < frames; ++f) {
    Eigen::MatrixXd& own = matrix_[at(f)];
    Eigen::MatrixXd& one = one_before_[at(f)];
    Eigen::MatrixXd& two = two_before_[at(f)];
    if (f >= 2) {
      lower(f - 2).transpose().solveInPlace<Eigen::OnTheRight>(two);
      one.noalias() -= two * one_before_[at(f - 1)].transpose();
      own.selfadjointView<Eigen::Lower>().rankUpdate(two, -1);
    }
    if (f >= 1) {
      lower(f - 1).transpose().solveInPlace<Eigen::OnTheRight>(one);
      own.selfadjointView<Eigen::Lower>().rankUpdate(one, -1);
    }
    Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>> in_place(own);
    Eigen::VectorXd& right = right_[at(f)];
    if (f >= 1) right -= one * right_[at(f - 1)];
    if (f >= 2) right -= two * right_[at(f - 2)];
    lower(f).solveInPlace(right);
  }
  for (int f = frames - 1; f >= 0; --f) {
    Eigen::VectorXd& right = right_[at(f)];
    if (f + 1 < frames) right -= one_before_[at(f + 1)].transpose() * right_[at(f + 1)];
    if (f + 2 < frames) right -= two_before_[at(f + 2)].transpose() * right_[at(f + 2)];
    lower(f).transpose().solveInPlace(right);
  }
  return right_;
}

}  // namespace krok::settling
