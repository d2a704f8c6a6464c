#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "capture/conventions.h"

namespace krok {

namespace {

using Positions = std::span<const Vec3>;  // [joints]

// The signed axis nearest to a vector, and how near: the cosine of the angle between them.
struct NearestAxis {
  Direction direction = Direction::plus_y;
  double cosine = 0;
};

NearestAxis nearest_axis(const Vec3& v) {
  int axis = 0;
  const double largest = v.cwiseAbs().maxCoeff(&axis);
  const double length = v.stableNorm();
  if (!(length > 0) || !std::isfinite(length)) return {};
  return {static_cast<Direction>(2 * axis + (v[axis] < 0 ? 1 : 0)), largest / length};
}

Direction opposite(Direction d) {
  return static_cast<Direction>(static_cast<int>(d) ^ 1);
}

bool on_one_axis(Direction a, Direction b) {
  return static_cast<int>(a) / 2 == static_cast<int>(b) / 2;
}

// A direction at right angles to `up`, for want of evidence.
Direction default_forward(Direction up) {
  return on_one_axis(up, Direction::plus_z) ? Direction::minus_y : Direction::plus_z;
}

std::optional<Vec3> direction_between(const Vec3& from, const Vec3& to) {
  const Vec3 v = to - from;
  const double length = v.stableNorm();
  if (!(length > 0) || !std::isfinite(length)) return std::nullopt;
  return v / length;
}

// The joints that tell up from down and left from right; -1 where the figure has none.
struct Landmarks {
  int hips, head, left_foot, right_foot, left_toes, right_toes;
  int left_leg, right_leg, left_arm, right_arm;

  Landmarks(const Skeleton& skeleton, const RoleMap& roles)
      : hips(roles.joint(Role::hips)),
        head(roles.joint(Role::head)),
        left_foot(roles.joint(Role::left_foot)),
        right_foot(roles.joint(Role::right_foot)),
        left_toes(roles.joint(Role::left_toes)),
        right_toes(roles.joint(Role::right_toes)),
        left_leg(roles.joint(Role::left_upper_leg)),
        right_leg(roles.joint(Role::right_upper_leg)),
        left_arm(roles.joint(Role::left_upper_arm)),
        right_arm(roles.joint(Role::right_upper_arm)) {
    if (head < 0) head = roles.joint(Role::neck);
    if (left_toes < 0) left_toes = end_below(skeleton, left_foot);
    if (right_toes < 0) right_toes = end_below(skeleton, right_foot);
  }

  bool upright_known() const { return hips >= 0 && head >= 0 && left_foot >= 0 && right_foot >= 0; }

 private:
  static int end_below(const Skeleton& skeleton, int joint) {
    for (std::size_t j = 0; joint >= 0 && j < skeleton.parents.size(); ++j) {
      if (skeleton.parents[j] == joint && skeleton.end_sites[j] != 0) return static_cast<int>(j);
    }
    return -1;
  }
};

const Vec3& at(Positions pose, int joint) {
  return pose[static_cast<std::size_t>(joint)];
}

Vec3 middle_of_feet(Positions pose, const Landmarks& marks) {
  return 0.5 * (at(pose, marks.left_foot) + at(pose, marks.right_foot));
}

// From the feet to the head.
std::optional<Vec3> body_axis(Positions pose, const Landmarks& marks) {
  return direction_between(middle_of_feet(pose, marks), at(pose, marks.head));
}

// From the right side to the left, by hips and shoulders.
std::optional<Vec3> side_axis(Positions pose, const Landmarks& marks) {
  Vec3 sum = Vec3::Zero();
  const auto add = [&](int right, int left) {
    if (right < 0 || left < 0) return;
    if (const auto side = direction_between(at(pose, right), at(pose, left))) sum += *side;
  };
  add(marks.right_leg, marks.left_leg);
  add(marks.right_arm, marks.left_arm);
  return direction_between(Vec3::Zero(), sum);
}

// Where the figure faces, at right angles to `up`.
std::optional<Vec3> facing(Positions pose, const Landmarks& marks, Direction up) {
  const auto side = side_axis(pose, marks);
  if (!side) return std::nullopt;
  const Vec3 forward = side->cross(direction_vector(up));
  if (!(forward.norm() > 0.2)) return std::nullopt;  // the figure lies on its side
  return forward.normalized();
}

// Where the toes point, at right angles to `up`; nothing where they point down or there are none.
std::optional<Vec3> toes_direction(Positions pose, const Landmarks& marks, Direction up) {
  Vec3 sum = Vec3::Zero();
  const Vec3 vertical = direction_vector(up);
  const auto add = [&](int foot, int toes) {
    if (foot < 0 || toes < 0) return;
    const auto along = direction_between(at(pose, foot), at(pose, toes));
    if (along) sum += *along - along->dot(vertical) * vertical;
  };
  add(marks.left_foot, marks.left_toes);
  add(marks.right_foot, marks.right_toes);
  if (!sum.allFinite() || sum.norm() < 0.2) return std::nullopt;
  return sum.normalized();
}

// How the reference pose stands: the axis of trunk and legs together, or nothing where they fold
// (zero rotations are no natural pose in some rigs).
std::optional<NearestAxis> standing_axis(Positions pose, const Landmarks& marks) {
  if (!marks.upright_known()) return std::nullopt;
  const auto trunk = direction_between(at(pose, marks.hips), at(pose, marks.head));
  const auto legs = direction_between(middle_of_feet(pose, marks), at(pose, marks.hips));
  if (!trunk || !legs || trunk->dot(*legs) < 0.7) return std::nullopt;
  const NearestAxis axis = nearest_axis(*trunk + *legs);
  if (axis.cosine < 0.85) return std::nullopt;
  return axis;
}

struct Evidence {
  const Skeleton& skeleton;
  const RoleMap& roles;
  Landmarks marks;
  std::vector<Vec3> reference;    // [joints]
  std::span<const Vec3> samples;  // [samples x joints]
  std::size_t sample_count = 0;
  std::optional<NearestAxis> reference_stands;

  Evidence(const Skeleton& s, const RoleMap& r, std::span<const Vec3> sample_positions)
      : skeleton(s), roles(r), marks(s, r), samples(sample_positions) {
    for (const Transform& transform : s.reference) reference.push_back(transform.position);
    if (!reference.empty()) sample_count = samples.size() / reference.size();
    reference_stands = standing_axis(reference, marks);
  }

  Positions sample(std::size_t index) const {
    return samples.subspan(index * reference.size(), reference.size());
  }
};

// In how many samples the body stands along each axis.
struct UpVotes {
  std::array<int, 6> votes{};
  int valid = 0;
  Vec3 sum = Vec3::Zero();

  explicit UpVotes(const Evidence& evidence) {
    constexpr double kUpright = 0.8;  // within 37 degrees
    for (std::size_t i = 0; i < evidence.sample_count; ++i) {
      const auto axis = body_axis(evidence.sample(i), evidence.marks);
      if (!axis) continue;
      ++valid;
      sum += *axis;
      const NearestAxis nearest = nearest_axis(*axis);
      if (nearest.cosine >= kUpright) ++votes[static_cast<std::size_t>(nearest.direction)];
    }
  }

  Direction winner() const {
    return static_cast<Direction>(std::max_element(votes.begin(), votes.end()) - votes.begin());
  }
  double share(Direction d) const {
    return valid == 0 ? 0 : static_cast<double>(votes[static_cast<std::size_t>(d)]) / valid;
  }
};

std::string signed_name(Direction d) {
  const std::string_view name = direction_name(d);
  return name.starts_with('-') ? std::string(name) : "+" + std::string(name);
}

void detect_up_without_motion(const Evidence& evidence, Conventions& found) {
  if (evidence.reference_stands) {
    found.up = evidence.reference_stands->direction;
    found.up_confidence =
        evidence.reference_stands->cosine > 0.95 ? Confidence::certain : Confidence::likely;
    found.up_reason = fmt::format("the reference pose stands along {}", signed_name(found.up));
    return;
  }
  const auto axis = body_axis(evidence.reference, evidence.marks);
  if (!axis) {
    found.up_reason = "the figure has no size to tell up from down by; +y is the default";
    return;
  }
  found.up = nearest_axis(*axis).direction;
  found.up_reason = fmt::format(
      "in the reference pose, which does not stand, the head is furthest "
      "from the feet along {}",
      signed_name(found.up));
}

void detect_up(const Evidence& evidence, Conventions& found) {
  if (!evidence.marks.upright_known()) {
    found.up_reason = "without a head and two feet up cannot be told from down; +y is the default";
    return;
  }
  const UpVotes votes(evidence);
  if (votes.valid == 0) return detect_up_without_motion(evidence, found);
  const auto& reference = evidence.reference_stands;
  const Direction winner = votes.winner();
  const double share = votes.share(winner);
  const int percent = static_cast<int>(std::lround(100 * share));
  const bool agrees = reference && reference->direction == winner;
  if (share >= 0.5 && !(reference && reference->direction == opposite(winner))) {
    found.up = winner;
    found.up_confidence = agrees || share >= 0.8 ? Confidence::certain : Confidence::likely;
    found.up_reason =
        fmt::format("the head is above the feet along {} in {}% of the frames looked at",
                    signed_name(winner), percent);
    if (agrees) {
      found.up_reason += ", and the reference pose stands so too";
    } else if (reference) {
      found.up_reason += fmt::format("; the reference pose stands along {}, the motion decides",
                                     signed_name(reference->direction));
      if (found.up_confidence == Confidence::certain && share < 0.95) {
        found.up_confidence = Confidence::likely;
      }
    }
    return;
  }
  if (reference) {
    found.up = reference->direction;
    found.up_confidence = Confidence::likely;
    found.up_reason = fmt::format(
        "the reference pose stands along {}; the motion is upright along "
        "it in {}% of the frames looked at only",
        signed_name(found.up), static_cast<int>(std::lround(100 * votes.share(found.up))));
    return;
  }
  found.up = nearest_axis(votes.sum).direction;
  found.up_reason = fmt::format(
      "on average the head is furthest from the feet along {}, though the "
      "figure seldom stands",
      signed_name(found.up));
}

// Forward from the reference pose, if its trunk points up as the motion's does.
bool detect_forward_in_reference(const Evidence& evidence, Conventions& found) {
  const auto& marks = evidence.marks;
  if (marks.hips < 0 || marks.head < 0) return false;
  const auto trunk =
      direction_between(at(evidence.reference, marks.hips), at(evidence.reference, marks.head));
  if (!trunk || trunk->dot(direction_vector(found.up)) < 0.8) return false;
  const auto forward = facing(evidence.reference, marks, found.up);
  if (!forward) return false;
  const NearestAxis axis = nearest_axis(*forward);
  found.forward = axis.direction;
  found.forward_reason = fmt::format("by its left and right side the reference pose faces {}",
                                     signed_name(axis.direction));
  found.forward_confidence = axis.cosine > 0.9 ? Confidence::likely : Confidence::guess;
  if (!evidence.reference_stands) return true;  // the legs are folded, the toes tell nothing
  const auto toes = toes_direction(evidence.reference, marks, found.up);
  if (!toes) return true;
  const double along = toes->dot(direction_vector(axis.direction));
  if (along > 0.5) {
    found.forward_confidence = axis.cosine > 0.9 ? Confidence::certain : Confidence::likely;
    found.forward_reason += ", and the toes point there";
  } else {
    found.forward_confidence = Confidence::guess;
    found.forward_reason += ", but the toes do not point there: left and right may be exchanged";
  }
  return true;
}

void detect_forward(const Evidence& evidence, Conventions& found) {
  found.forward = default_forward(found.up);
  if (detect_forward_in_reference(evidence, found)) return;
  for (std::size_t i = 0; i < evidence.sample_count; ++i) {
    const auto forward = facing(evidence.sample(i), evidence.marks, found.up);
    if (!forward) continue;
    const NearestAxis axis = nearest_axis(*forward);
    found.forward = axis.direction;
    found.forward_confidence = axis.cosine > 0.9 ? Confidence::likely : Confidence::guess;
    found.forward_reason = fmt::format(
        "the reference pose does not stand as the motion does; the "
        "figure faces {} in the first frame",
        signed_name(axis.direction));
    return;
  }
  found.forward_reason = fmt::format("no left and right side that tells; {} is the default",
                                     signed_name(found.forward));
}

// The axes of a reference pose that stands, but otherwise than the motion.
void detect_reference_axes(const Evidence& evidence, Conventions& found) {
  found.reference_up = found.up;
  found.reference_forward = found.forward;
  const auto& stands = evidence.reference_stands;
  if (!stands || stands->direction == found.up) return;
  const auto forward = facing(evidence.reference, evidence.marks, stands->direction);
  if (!forward) return;
  found.reference_up = stands->direction;
  found.reference_forward = nearest_axis(*forward).direction;
}

// The sum of the bones' lengths from `top` down the tree to `joint`; 0 where one is missing.
double path_length(const Evidence& evidence, Positions pose, int top, int joint) {
  double length = 0;
  if (top < 0) return 0;
  while (joint >= 0 && joint != top) {
    const int parent = evidence.skeleton.parents[static_cast<std::size_t>(joint)];
    if (parent >= 0) length += (at(pose, joint) - at(pose, parent)).norm();
    joint = parent;
  }
  return joint == top && std::isfinite(length) ? length : 0;
}

// How tall the figure is in the file's unit, from the lengths of its bones, so that the pose does
// not matter; 0 where legs, arms and spine are missing. Shares of the height after Winter,
// Biomechanics and Motor Control of Human Movement (leg to the ankle 0.49, arm to the wrist 0.33);
// the spine from the hips to the joint of the head is about 0.37.
double height_in(const Evidence& evidence, Positions pose) {
  constexpr double kLeg = 0.49;
  constexpr double kArm = 0.33;
  constexpr double kSpine = 0.37;
  const auto& marks = evidence.marks;
  const auto mean = [](double a, double b) {
    return a > 0 && b > 0 ? 0.5 * (a + b) : std::max(a, b);
  };
  const double leg = mean(path_length(evidence, pose, marks.left_leg, marks.left_foot),
                          path_length(evidence, pose, marks.right_leg, marks.right_foot));
  const double spine = path_length(evidence, pose, marks.hips, evidence.roles.joint(Role::head));
  const double arm =
      mean(path_length(evidence, pose, marks.left_arm, evidence.roles.joint(Role::left_hand)),
           path_length(evidence, pose, marks.right_arm, evidence.roles.joint(Role::right_hand)));
  if (leg > 0 && spine > 0) return (leg + spine) / (kLeg + kSpine);
  if (leg > 0) return leg / kLeg;
  if (arm > 0) return arm / kArm;
  return 0;
}

struct UnitCandidate {
  const char* name;
  double rarity;  // added to the distance from an adult's height, in natural logarithms
};
constexpr std::array kUnitCandidates = {UnitCandidate{"m", 0.0},   UnitCandidate{"cm", 0.0},
                                        UnitCandidate{"mm", 0.05}, UnitCandidate{"in", 0.1},
                                        UnitCandidate{"cmu", 0.1}, UnitCandidate{"dm", 0.15},
                                        UnitCandidate{"ft", 0.15}};

Unit unit_named(const char* name) {
  return *parse_unit(name);
}

// Whether a captured figure may be as large as that.
bool is_sensible(double metres) {
  return metres >= 0.01 && metres <= 1000.0;
}

void detect_unit_of_figure(double height, bool cmu_names, Conventions& found) {
  constexpr double kUsualHeight = 1.72;
  double best = INFINITY;
  double second = INFINITY;
  for (const UnitCandidate& candidate : kUnitCandidates) {
    const Unit unit = unit_named(candidate.name);
    const double score = std::abs(std::log(height * unit.metres / kUsualHeight)) + candidate.rarity;
    if (score < best) {
      second = best;
      best = score;
      found.unit = unit;
    } else {
      second = std::min(second, score);
    }
  }
  const double metres = height * found.unit.metres;
  const bool clear = second - best > 0.3;
  if (metres >= 1.45 && metres <= 2.1 && clear) {
    found.unit_confidence = Confidence::certain;
  } else if (metres >= 1.25 && metres <= 2.4 && clear) {
    found.unit_confidence = Confidence::likely;
  }
  if (!is_sensible(metres)) {
    found.unit_reason = fmt::format(
        "the figure would be {:.3g} m tall, and no common unit brings it near a usual height",
        metres);
    return;
  }
  found.unit_reason = fmt::format("the bones are those of a figure about {:.2f} m tall", metres);
  if (found.unit.name == "cmu" && cmu_names && metres > 1.2 && metres < 2.2) {
    found.unit_confidence = Confidence::certain;
    found.unit_reason += ", with the joint names of the CMU collection";
  }
  if (found.unit_confidence == Confidence::guess) {
    found.unit_reason += "; no common unit makes it a usual height";
  }
}

// The largest extent over the axes of the reference pose and of each sample.
double largest_extent(const Evidence& evidence) {
  const auto extent = [](Positions pose) {
    Eigen::AlignedBox3d box;
    for (const Vec3& p : pose) {
      if (p.allFinite()) box.extend(p);
    }
    return box.isEmpty() ? 0.0 : box.sizes().maxCoeff();
  };
  double largest = extent(evidence.reference);
  for (std::size_t i = 0; i < evidence.sample_count; ++i) {
    largest = std::max(largest, extent(evidence.sample(i)));
  }
  return largest;
}

// The helper joints that the CMU collection's skeletons have and hardly any other.
bool has_cmu_names(const Skeleton& skeleton) {
  const bool lower_back = skeleton.find("LowerBack") >= 0 || skeleton.find("lowerback") >= 0;
  return lower_back && (skeleton.find("LHipJoint") >= 0 || skeleton.find("lhipjoint") >= 0);
}

void detect_unit(const Evidence& evidence, Conventions& found) {
  double height = height_in(evidence, evidence.reference);
  if (!(height > 0) && evidence.sample_count > 0) height = height_in(evidence, evidence.sample(0));
  if (height > 0) return detect_unit_of_figure(height, has_cmu_names(evidence.skeleton), found);
  const double extent = largest_extent(evidence);
  constexpr double kLargest = 10.0;  // metres
  for (const char* name : {"m", "cm", "mm"}) {
    found.unit = unit_named(name);
    if (extent * found.unit.metres <= kLargest) break;
  }
  const double metres = extent * found.unit.metres;
  if (!(extent > 0)) {
    found.unit_reason = "all joints stand at one place, which shows no size to go by";
  } else if (!is_sensible(metres)) {
    found.unit_reason = fmt::format(
        "no legs or arms to go by, and in none of m, cm and mm is the size a sensible one; in {} "
        "it is {:.3g} m",
        found.unit.name, metres);
  } else {
    found.unit_reason =
        fmt::format("no legs or arms to go by; a size of {:.3g} m is taken as sensible", metres);
  }
}

}  // namespace

Conventions detect_conventions(const Skeleton& skeleton, const RoleMap& roles,
                               std::span<const Vec3> sample_positions) {
  const Evidence evidence(skeleton, roles, sample_positions);
  Conventions found;
  detect_up(evidence, found);
  detect_forward(evidence, found);
  detect_reference_axes(evidence, found);
  detect_unit(evidence, found);
  return found;
}

}  // namespace krok
