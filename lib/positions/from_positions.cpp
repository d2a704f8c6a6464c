#include "positions/from_positions.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <complex>
#include <utility>

#include "core/index.h"
#include "core/parallel.h"
#include "math/dense_solve.h"
#include "math/hermite.h"
#include "math/quaternion.h"

namespace krok {

namespace {

constexpr double kNoLength = 1e-5;  // metres: a bone without a direction
constexpr double kNoNoise = 2e-4;   // metres
constexpr int kMaxSteps = 4;
constexpr double kNoMisfit = 1e-11;  // square metres, of all joints together
constexpr double kDamping = 10;      // levers of three misfits turn freely
constexpr std::size_t kGrain = 256;
constexpr std::size_t kFramesOfShape = 2000;

// By a rotation vector in world axes, up to its third power, and at most a half turn.
void turn_by(const Vec3& vector, Quat& turn) {
  Quat by;
  by.w() = 1;
  by.vec() = 0.5 * vector;
  turn = (by * turn).normalized();
}

// The angle of a rotation about an axis (unit), in (-pi, pi].
double twist_about(const Vec3& axis, const Quat& rotation) {
  double angle = 2 * std::atan2(rotation.vec().dot(axis), rotation.w());
  if (angle > kPi) angle -= 2 * kPi;
  if (angle <= -kPi) angle += 2 * kPi;
  return angle;
}

// In place: without jumps of a whole turn, their mean within half a turn.
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

using Turn = std::complex<double>;  // an angle in a plane, as a unit number

// Turns that follow `measured` by their weights, and none weakly: the least sum of
// weight |z - measured|^2 + smoothness |steps of z base|^2 + pull |z - 1|^2 over unit complex
// numbers, of which the lengths are left free, so that the system is linear. `base`: the turns of
// what z turns.
std::vector<Turn> turns_over_time(std::span<const Turn> measured, std::span<const Turn> base,
                                  std::span<const double> weights, double smoothness, double pull) {
  const std::size_t n = measured.size();
  std::vector<double> upper(n, 0);
  std::vector<Turn> z(n);
  for (std::size_t t = 0; t < n; ++t) {
    double diagonal = weights[t] + pull + (t > 0 ? smoothness : 0) + (t + 1 < n ? smoothness : 0);
    z[t] = (weights[t] * measured[t] + pull) * base[t];
    if (t > 0) {
      diagonal -= smoothness * upper[t - 1];
      z[t] += smoothness * z[t - 1];
    }
    upper[t] = smoothness / diagonal;
    z[t] /= diagonal;
  }
  for (std::size_t t = n; t-- > 1;) z[t - 1] += upper[t - 1] * z[t];
  for (std::size_t t = 0; t < n; ++t) {
    const double length = std::sqrt(std::norm(z[t]));
    z[t] = length > 0 ? z[t] * std::conj(base[t]) / length : Turn(1);
  }
  return z;
}

// Half of a turn, at most a quarter turn: a quaternion's w, and its vector along the axis.
Turn half_of(const Turn& turn) {
  if (turn.real() >= 0) {
    const double cosine = std::sqrt(0.5 * (1 + turn.real()));
    return {cosine, 0.5 * turn.imag() / cosine};
  }
  const double sine = std::copysign(std::sqrt(0.5 * (1 - turn.real())), turn.imag());
  return {0.5 * turn.imag() / sine, sine};
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
        weights_(joints_, 1),
        targets_(joints_),
        shapes_(joints_),
        twisted_(joints_, false) {
    for (std::size_t f = 0; f < frames_; ++f) {
      for (std::size_t j = 0; j < joints_; ++j) {
        measured_[j * frames_ + f] = input.positions[f * joints_ + j];
      }
    }
  }

  PoseFromPositions solve() {
    find_noise();
    if (frames_ > 0) {
      find_targets();
      place();
      move_to_measured();
      twist_limbs();
      spread_twists();
      for (std::size_t j = 1; j < joints_; ++j) follow(j);
    }
    finish();
    return std::move(result_);
  }

 private:
  std::span<Quat> turns_of(std::size_t joint) {
    return std::span(turns_).subspan(joint * frames_, frames_);
  }
  std::span<Vec3> measured_of(std::size_t joint) {
    return std::span(measured_).subspan(joint * frames_, frames_);
  }

  // A root that stays behind while the body moves, as one at the origin does, has no bone to it: it
  // is put where its only child is.
  void put_root_at_body() {
    constexpr double kMoves = 0.004;  // standard deviation, of the body's extent, beyond noise
    if (joints_ < 3 || frames_ < 2 || children_[0].size() != 1) return;
    const auto child = at(children_[0][0]);
    double sum = 0, squares = 0;
    for (std::size_t f = 0; f < frames_; ++f) {
      const double length = way(0, child, f).norm();
      sum += length;
      squares += length * length;
    }
    const auto count = static_cast<double>(frames_);
    Eigen::AlignedBox3d body;
    for (std::size_t j = 1; j < joints_; ++j) body.extend(measured_[j * frames_]);
    const double variance = squares / count - sum / count * (sum / count);
    const double of_noise = 4 * (noise_[0] * noise_[0] + noise_[child] * noise_[child]);
    if (!(variance > std::pow(kMoves * body.diagonal().norm(), 2) + of_noise)) return;
    std::ranges::copy(measured_of(child), measured_.begin());
    noise_[0] = noise_[child];
    result_.root_at_body = true;
  }

  void find_noise() {
    noise_ = noise_of(parents_, measured_);
    put_root_at_body();
    double squares = 0, worst = 0;
    for (const double n : noise_) {
      squares += n * n / static_cast<double>(joints_);
      worst = std::max(worst, n);
    }
    result_.noise = std::sqrt(squares);
    if (!input_.smooth || worst < kNoNoise) return;
    result_.smoothed = smooth_tracks(noise_, input_.rate, input_.jobs, measured_);
    for (std::size_t j = 0; j < joints_ && result_.smoothed; ++j) {
      const double trust = std::max(noise_[j] / result_.noise, 0.1);
      weights_[j] = 1 / (trust * trust);
    }
  }

  // Metres, over a part of the frames.
  double usual_length(std::size_t from, std::size_t to) const {
    double sum = 0, count = 0;
    for (std::size_t f = 0; f < frames_; f += sample_step()) {
      sum += way(from, to, f).norm();
      ++count;
    }
    return sum / count;
  }
  std::size_t sample_step() const { return (frames_ + 49) / 50; }

  // The joints that show a joint's rotation: its children, and beyond those at its own place their
  // children, if it needs them.
  void find_targets() {
    for (std::size_t j = joints_; j-- > 0;) {
      std::vector<int>& targets = targets_[j];
      std::vector<int> near;
      for (const int child : children_[j]) {
        const double noise = 2.5 * std::hypot(noise_[j], noise_[at(child)]);
        const bool away = usual_length(j, at(child)) > std::max(kNoLength, noise);
        (away ? targets : near).push_back(child);
      }
      const bool few = targets.size() < 2;
      for (std::size_t i = 0; few && i < near.size(); ++i) {
        const std::vector<int>& beyond = targets_[at(near[i])];
        targets.insert(targets.end(), beyond.begin(), beyond.end());
      }
      if (const int only = only_target(j); only >= 0) targets = {only};
      for (const int target : targets) {
        shapes_[j].push_back(input_.skeleton.reference[at(target)].position -
                             input_.skeleton.reference[j].position);
      }
    }
  }

  // The farthest target if all are in one line; otherwise -1.
  int only_target(std::size_t j) const {
    int farthest = -1;
    double length = 0, aside = 0, count = 0;
    for (const int target : targets_[j]) {
      const double here = usual_length(j, at(target));
      if (here <= length) continue;
      length = here;
      farthest = target;
    }
    if (farthest < 0) return farthest;
    for (std::size_t f = 0; f < frames_; f += sample_step(), ++count) {
      const Vec3 along = way(j, at(farthest), f).stableNormalized();
      double most = 0;
      for (const int target : targets_[j]) {
        most = std::max(most, along.cross(way(j, at(target), f)).norm());
      }
      aside += most;
    }
    return aside / count <= std::max(0.03 * length, 3 * result_.noise) ? farthest : -1;
  }

  // Offsets are measured, and joints brought near where they were measured, from the root down.
  void place() {
    std::ranges::copy(measured_of(0), placed_.begin());
    for (std::size_t j = 0; j < joints_; ++j) {
      if (targets_[j].size() == 1) {
        measure_bone(j);
        point(j);
      } else if (!targets_[j].empty()) {
        measure_shape(j);
        fit(j);
      } else if (parents_[j] >= 0) {
        std::ranges::copy(turns_of(at(parents_[j])), turns_of(j).begin());
      }
      for (const int child : children_[j]) {
        const auto target = std::ranges::find(targets_[j], child);
        if (target != targets_[j].end()) {
          offsets_[at(child)] = shapes_[j][static_cast<std::size_t>(target - targets_[j].begin())];
        } else {
          measure_aside(j, at(child));
        }
        for (std::size_t f = 0; f < frames_; ++f) hang(at(child), f);
      }
    }
  }
  void hang(std::size_t child, std::size_t f) {
    const std::size_t from = at(parents_[child]) * frames_ + f;
    placed_[child * frames_ + f] = placed_[from] + turns_[from] * offsets_[child];
  }

  Quat turn_at(int joint, std::size_t frame) const {
    return joint < 0 ? Quat::Identity() : turns_[at(joint) * frames_ + frame];
  }
  Quat turn_above(std::size_t joint, std::size_t frame) const {
    return turn_at(parents_[joint], frame);
  }
  // The joint above that a bone is turned against: past helpers, whose twist nothing shows.
  int base_of(std::size_t j) const {
    int base = parents_[j];
    for (; base > 0 && targets_[at(base)].size() < 2; base = parents_[at(base)]) {
      const Role role = input_.roles.roles.empty() ? Role::none : input_.roles.roles[at(base)];
      if (role != Role::none && role != Role::helper) break;
    }
    return base;
  }
  Vec3 way(std::size_t joint, std::size_t child, std::size_t frame) const {
    return measured_[child * frames_ + frame] - measured_[joint * frames_ + frame];
  }

  void measure_bone(std::size_t j) {
    const std::size_t target = at(targets_[j][0]);
    const int base = base_of(j);
    double length = 0;
    Vec3 mean = Vec3::Zero();
    for (std::size_t f = 0; f < frames_; ++f) {
      length += way(j, target, f).norm();
      mean += turn_at(base, f).conjugate() * way(j, target, f);
    }
    const Vec3 direction = shapes_[j][0].norm() > kNoLength ? shapes_[j][0] : mean;
    shapes_[j][0] = length / static_cast<double>(frames_) * direction.stableNormalized();
  }

  void measure_aside(std::size_t j, std::size_t child) {
    offsets_[child].setZero();
    for (std::size_t f = 0; f < frames_; ++f) {
      offsets_[child] += turns_[j * frames_ + f].conjugate() * way(j, child, f);
    }
    offsets_[child] /= static_cast<double>(frames_);
  }

  Mat3 products(std::size_t j, std::size_t frame, const Vec3& from) const {
    Mat3 sum = Mat3::Zero();
    double size = 0;
    for (std::size_t i = 0; i < targets_[j].size(); ++i) {
      const std::size_t target = at(targets_[j][i]);
      const Vec3 weighted = weights_[target] * shapes_[j][i];
      sum += (measured_[target * frames_ + frame] - from) * weighted.transpose();
      size += weighted.dot(shapes_[j][i]);
    }
    // The parent's rotation decides what the children leave open.
    return sum + 1e-6 * std::max(size, 1e-12) * turn_above(j, frame).toRotationMatrix();
  }

  // The mean offsets of several targets in their joint's frame.
  void measure_shape(std::size_t j) {
    const std::size_t step = (frames_ + kFramesOfShape - 1) / kFramesOfShape;
    std::vector<Vec3>& shape = shapes_[j];
    if (std::ranges::all_of(shape, [](const Vec3& v) { return v.norm() <= kNoLength; })) {
      for (std::size_t i = 0; i < shape.size(); ++i) {
        shape[i] = turn_above(j, 0).conjugate() * way(j, at(targets_[j][i]), 0);
      }
    }
    const std::vector<Vec3> reference = shape;
    for (int iteration = 0; iteration < 3; ++iteration) {
      std::vector<Vec3> sums(shape.size(), Vec3::Zero());
      double count = 0;
      for (std::size_t f = 0; f < frames_; f += step, ++count) {
        Quat& turn = turns_[j * frames_ + f];
        turn = nearest_rotation(products(j, f, measured_[j * frames_ + f]),
                                f == 0 || iteration > 0 ? turn : turns_[j * frames_ + f - step]);
        const Quat back = turn.conjugate();
        for (std::size_t i = 0; i < sums.size(); ++i) {
          sums[i] += back * way(j, at(targets_[j][i]), f);
        }
      }
      double change = 0;
      for (std::size_t i = 0; i < sums.size(); ++i) {
        change = std::max(change, (shape[i] - sums[i] / count).norm());
        shape[i] = sums[i] / count;
      }
      if (change < 1e-8) break;
    }
    // As the reference pose stands, as nearly as the shape allows.
    Mat3 sum = 1e-9 * Mat3::Identity();
    for (std::size_t i = 0; i < shape.size(); ++i) sum += reference[i] * shape[i].transpose();
    const Quat turn = nearest_rotation(sum, Quat::Identity());
    for (Vec3& offset : shape) offset = turn * offset;
    for (std::size_t f = 0; f < frames_; ++f) {
      Quat& here = turns_[j * frames_ + f];
      here = f % step == 0 ? here * turn.conjugate() : turns_[j * frames_ + f - f % step];
    }
  }

  void fit(std::size_t j) {
    parallel_for(frames_, kGrain, input_.jobs, [&](std::size_t begin, std::size_t end) {
      for (std::size_t f = begin; f < end; ++f) {
        Quat& turn = turns_[j * frames_ + f];
        turn = nearest_rotation(products(j, f, placed_[j * frames_ + f]), turn);
      }
    });
  }

  void point(std::size_t j) {
    const std::size_t target = at(targets_[j][0]);
    const int base = base_of(j);
    const bool has_length = shapes_[j][0].norm() > kNoLength;
    const Vec3 along = bone(j);
    const bool carried = has_length && base != parents_[j];
    std::vector<double> clear(carried ? frames_ : 0, 0);
    for (std::size_t f = 0; f < frames_; ++f) {
      const Quat above = turn_at(base, f);
      Quat& turn = turns_[j * frames_ + f];
      turn = above;
      const Vec3 to = measured_[target * frames_ + f] - placed_[j * frames_ + f];
      const double length = to.norm();
      if (!has_length || length < kNoLength) continue;
      const Vec3 from = above * along;
      Quat arc;
      arc.w() = 1 + from.dot(to) / length;
      arc.vec() = from.cross(to) / length;
      if (carried) clear[f] = smoother_step(arc.w());
      if (arc.w() < 0.1) arc = shortest_arc(from, to);
      turn = (arc * above).normalized();
    }
    if (!carried) return;
    // It turns slowly about itself, also where the arc from the base is large.
    const std::vector<Turn> steps = twists_of(j, along, base), none(frames_, Turn(1));
    const auto found = turns_over_time(none, steps, clear, input_.rate * input_.rate, 1e-5);
    for (std::size_t f = 0; f < frames_; ++f) twist(j, f, along, found[f]);
  }

  // What a joint and those below it say on where it is to go, and how it turns.
  struct Pull {
    Mat3 weight = Mat3::Zero();  // of a step, metres
    Vec3 step = Vec3::Zero();    // weighted
    // Of its rotation vector, and of both: from the children.
    Mat3 turn_weight = Mat3::Zero(), cross_weight = Mat3::Zero();
    Vec3 turn = Vec3::Zero();
  };

  double misfit(std::size_t f) const {
    double sum = 0;
    for (std::size_t j = 0; j < joints_; ++j) {
      sum += weights_[j] * (measured_[j * frames_ + f] - placed_[j * frames_ + f]).squaredNorm();
    }
    return sum;
  }

  // Joints to where their distances to the measured ones are least together, by Gauss and Newton.
  // Rotations are eliminated from the leaves to the root, so that a step takes time proportional to
  // the number of joints (Featherstone, "Rigid Body Dynamics Algorithms", 2008, chapter 7).
  void move_to_measured() {
    parallel_for(frames_, kGrain, input_.jobs, [&](std::size_t begin, std::size_t end) {
      std::vector<Pull> pulls;
      std::vector<Vec3> before(joints_);
      std::vector<Quat> turns_before(joints_);
      for (std::size_t f = begin; f < end; ++f) {
        double now = misfit(f);
        for (int i = 0; i < kMaxSteps && now > kNoMisfit; ++i) {
          for (std::size_t j = 0; j < joints_; ++j) {
            before[j] = placed_[j * frames_ + f];
            turns_before[j] = turns_[j * frames_ + f];
          }
          step_to_measured(f, kDamping * now / static_cast<double>(joints_), pulls);
          const double last = std::exchange(now, misfit(f));
          if (now < last) {
            if (now > 0.999 * last) break;
            continue;
          }
          for (std::size_t j = 0; j < joints_; ++j) {
            placed_[j * frames_ + f] = before[j];
            turns_[j * frames_ + f] = turns_before[j];
          }
          break;
        }
      }
    });
    measured_ = placed_;
  }

  // `damping`: square metres, of levers that are too short to show a rotation.
  void step_to_measured(std::size_t f, double damping, std::vector<Pull>& pulls) {
    pulls.assign(joints_, {});
    for (std::size_t j = joints_; j-- > 0;) {
      Pull& pull = pulls[j];
      pull.weight.diagonal().array() += weights_[j];
      pull.step += weights_[j] * (measured_[j * frames_ + f] - placed_[j * frames_ + f]);
      if (!children_[j].empty()) {
        // A turn about the only bone moves nothing: it is left out.
        pull.turn_weight.diagonal().array() += 1e-12 + damping + 1e-6 * pull.turn_weight.trace();
        const Mat3 inverse = pull.turn_weight.inverse();
        pull.turn = inverse * pull.turn;
        pull.step -= pull.cross_weight * pull.turn;
        pull.turn_weight = inverse * pull.cross_weight.transpose();
        pull.weight -= pull.cross_weight * pull.turn_weight;
      }
      if (parents_[j] < 0) continue;
      Pull& above = pulls[at(parents_[j])];
      const Vec3 bone = placed_[j * frames_ + f] - placed_[at(parents_[j]) * frames_ + f];
      Mat3 lever;  // times the rotation vector: how the joint moves
      lever << 0, bone.z(), -bone.y(), -bone.z(), 0, bone.x(), bone.y(), -bone.x(), 0;
      const Mat3 moved = pull.weight * lever;
      above.weight += pull.weight;
      above.step += pull.step;
      above.cross_weight += moved;
      above.turn_weight += lever.transpose() * moved;
      above.turn += bone.cross(pull.step);
    }
    for (std::size_t j = 0; j < joints_; ++j) {
      Vec3& place = placed_[j * frames_ + f];
      Pull& pull = pulls[j];
      if (parents_[j] < 0) pull.step = pull.weight.inverse() * pull.step;
      const Vec3 turn = pull.turn - pull.turn_weight * pull.step;
      for (const int child : children_[j]) {
        pulls[at(child)].step = pull.step + turn.cross(placed_[at(child) * frames_ + f] - place);
      }
      if (!children_[j].empty()) turn_by(turn, turns_[j * frames_ + f]);
      if (parents_[j] < 0) place += pull.step;
    }
    for (std::size_t j = 1; j < joints_; ++j) hang(j, f);
  }

  // Turns a joint with one target about its bone, `axis`.
  void twist(std::size_t j, std::size_t frame, const Vec3& axis, const Turn& by) {
    Quat& turn = turns_[j * frames_ + frame];
    const Turn half = half_of(by);
    Quat rotation;
    rotation.w() = half.real();
    rotation.vec() = half.imag() * axis;
    turn = (turn * rotation).normalized();
  }
  Vec3 bone(std::size_t j) const { return shapes_[j][0].stableNormalized(); }

  bool has_bone(int joint) const {
    return joint >= 0 && targets_[at(joint)].size() == 1 &&
           shapes_[at(joint)][0].norm() > kNoLength;
  }

  // A joint of which the children do not show the twist takes it from its parent.
  void follow(std::size_t j) {
    if (targets_[j].empty()) {
      std::ranges::copy(turns_of(at(parents_[j])), turns_of(j).begin());
    } else if (targets_[j].size() == 1 && !twisted_[j]) {
      point(j);
    }
  }

  // How far a joint has turned about its bone, from frame to frame, against another (< 0: none).
  std::vector<Turn> twists_of(std::size_t j, const Vec3& axis, int base) const {
    std::vector<Turn> turns(frames_, Turn(1));
    for (std::size_t f = 1; f < frames_; ++f) {
      const Quat step = turns_[j * frames_ + f - 1].conjugate() * turn_at(base, f - 1) *
                        turn_at(base, f).conjugate() * turns_[j * frames_ + f];
      const Turn half(step.w(), step.vec().dot(axis));
      const double size = std::norm(half);
      turns[f] = size > 0 ? turns[f - 1] * half * half / size : turns[f - 1];
    }
    return turns;
  }

  void twist_limb(Role upper_role, Role lower_role, Role end_role, const Vec3& forward) {
    const int upper = input_.roles.joint(upper_role), lower = input_.roles.joint(lower_role),
              end = input_.roles.joint(end_role);
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
    const Vec3 along_bone = bone(u), across = along_bone.cross(hinge);
    const std::vector<Turn> base = twists_of(u, along_bone, -1);
    std::vector<Turn> measured(frames_, Turn(1));
    std::vector<double> weights(frames_), clear(frames_);
    for (std::size_t f = 0; f < frames_; ++f) {
      const Vec3 along = way(u, at(lower), f), beyond = way(at(lower), at(end), f);
      const double size = along.norm() * beyond.norm();
      if (size < 1e-8) continue;
      const Vec3 normal = along.cross(beyond);
      const Vec3 local = turns_[u * frames_ + f].conjugate() * normal;
      const Turn turn(hinge.dot(local), across.dot(local));
      const double length = std::sqrt(std::norm(turn));
      if (length > 0) measured[f] = turn / length;
      weights[f] = normal.squaredNorm() / (size * size);
      // Where it is nearly straight, hinges that are a little aside decide its plane.
      weights[f] *= smoother_step(4 * std::sqrt(weights[f]));
      clear[f] = weights[f] * smoother_step(2 * std::sqrt(weights[f]) - 0.5);
    }
    // A limb that is nearly straight may be bent the other way: it follows frames that are clearly
    // bent.
    const double steps = 0.05 * input_.rate, smoothness = 0.003 * steps * steps;
    auto found = turns_over_time(measured, base, clear, smoothness, 1e-4);
    for (std::size_t f = 0; f < frames_; ++f) {
      if ((measured[f] * std::conj(found[f])).real() < 0) measured[f] = -measured[f];
    }
    found = turns_over_time(measured, base, weights, smoothness, 1e-5);
    for (std::size_t f = 0; f < frames_; ++f) twist(u, f, along_bone, found[f]);
    twisted_[u] = true;
  }

  void twist_limbs() {
    for (const ArmRoles& arm : kArmRoles) {
      twist_limb(arm.upper, arm.lower, arm.hand, Vec3::UnitZ());
    }
    for (const LegRoles& leg : kLegRoles) {
      twist_limb(leg.upper, leg.lower, leg.foot, -Vec3::UnitZ());
    }
  }

  // The share of the twist between the ends of a chain that a link and those above it take.
  double share_of(std::size_t joint, std::size_t place, std::size_t links) const {
    const Role role = joint < input_.roles.roles.size() ? input_.roles.roles[joint] : Role::none;
    for (const ArmRoles& arm : kArmRoles) {
      if (role == arm.collar || role == arm.upper || role == arm.lower) return 0;
    }
    for (const LegRoles& leg : kLegRoles) {
      if (role == leg.upper || role == leg.lower) return 0;
    }
    return static_cast<double>(place + 1) / static_cast<double>(links + 1);
  }

  void spread_twists() {
    for (std::size_t end = 0; end < joints_; ++end) {
      if (targets_[end].size() < 2) continue;
      std::vector<std::size_t> links;
      for (int j = parents_[end], below = static_cast<int>(end);
           has_bone(j) && targets_[at(j)][0] == below; below = j, j = parents_[at(j)]) {
        links.push_back(at(j));
      }
      // From a joint known in full to the next.
      if (links.empty() || parents_[links.back()] < 0) continue;
      std::ranges::reverse(links);
      double shares = 0;
      for (std::size_t i = 0; i < links.size(); ++i) shares += share_of(links[i], i, links.size());
      if (shares == 0) continue;
      std::vector<std::size_t> above;
      for (std::size_t j = links.back(); j > 0; j = at(parents_[j])) above.push_back(j);
      for (std::size_t i = above.size(); i-- > 0;) follow(above[i]);
      std::vector<double> angles(frames_);
      const Vec3 last = bone(links.back());
      for (std::size_t f = 0; f < frames_; ++f) {
        angles[f] = twist_about(
            last, turns_[links.back() * frames_ + f].conjugate() * turns_[end * frames_ + f]);
      }
      unwrap(angles);
      for (std::size_t i = 0; i < links.size(); ++i) {
        const double share = share_of(links[i], i, links.size());
        if (share == 0) continue;
        twisted_[links[i]] = true;
        const Vec3 axis = bone(links[i]);
        for (std::size_t f = 0; f < frames_; ++f) {
          twist(links[i], f, axis, std::polar(1.0, share * angles[f]));
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
        if (j == 0 && result_.root_at_body) continue;
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
    double lengths = 0;
    for (std::size_t j = 0; j < joints_ && frames_ > 0; ++j) {
      const double length = offsets_[j].norm();
      if (parents_[j] < 0 || (parents_[j] == 0 && result_.root_at_body)) continue;
      double squares = 0;
      for (std::size_t f = 0; f < frames_; ++f) {
        const Vec3 here =
            input_.positions[f * joints_ + j] - input_.positions[f * joints_ + at(parents_[j])];
        squares += (here.norm() - length) * (here.norm() - length);
      }
      result_.length_variation += std::sqrt(squares / static_cast<double>(frames_));
      lengths += length;
    }
    if (lengths > 0) result_.length_variation /= lengths;
  }

  const PositionsToPose& input_;
  const std::vector<int>& parents_;
  const std::vector<std::vector<int>> children_;
  const std::size_t joints_, frames_;
  std::vector<Vec3> measured_, placed_;  // [joints x frames]
  std::vector<Quat> turns_;              // [joints x frames] from the reference pose, in world axes
  std::vector<Vec3> offsets_;            // [joints] from the parent, in the reference pose
  std::vector<double> weights_;          // [joints] by noise
  std::vector<double> noise_;            // [joints]
  std::vector<std::vector<int>> targets_;
  std::vector<std::vector<Vec3>> shapes_;  // of the targets from the joint, in the reference pose
  std::vector<bool> twisted_;              // a twist of its own was found
  PoseFromPositions result_;
};

}  // namespace

PoseFromPositions from_positions(const PositionsToPose& input) {
  return Solver(input).solve();
}

}  // namespace krok
