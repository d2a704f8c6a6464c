#include <fmt/format.h>
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "capture/actor_internal.h"
#include "capture/conventions.h"

namespace krok::actor {

namespace {

struct UnitCandidate {
  const char* name;
  double rarity;  // penalty, added to |ln(height / usual height)|
};
constexpr std::array kUnitCandidates = {UnitCandidate{"m", 0.0},   UnitCandidate{"cm", 0.0},
                                        UnitCandidate{"mm", 0.05}, UnitCandidate{"in", 0.1},
                                        UnitCandidate{"cmu", 0.1}, UnitCandidate{"dm", 0.15},
                                        UnitCandidate{"ft", 0.15}};

Unit unit_named(const char* name) {
  return *parse_unit(name);
}

// Whether a captured subject can have that size.
bool is_sensible(double metres) {
  return metres >= 0.01 && metres <= 1000.0;
}

void detect_unit_of_actor(const Stature& stature, bool cmu_names, Conventions& found) {
  const double height = stature.metres;
  constexpr double kUsualHeight = 1.72;
  constexpr double kDoubtful = 0.26;  // proportions are no person's, so their lengths show no unit
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
  // Where segments disagree, so do the units that they would give.
  const double doubt = std::min(stature.uncertainty / height, 1.0);
  const double margin = second - best;
  // A height that only a rare unit explains may come from any scale.
  const bool usual = found.unit.name == "m" || found.unit.name == "cm" || found.unit.name == "mm";
  if (usual && metres >= 1.45 && metres <= 2.1 && margin > 0.3 + doubt) {
    found.unit_confidence = Confidence::certain;
  } else if (metres >= 1.25 && metres <= 2.4 && margin > 0.3 && (usual || doubt < kDoubtful)) {
    found.unit_confidence = Confidence::likely;
  }
  if (!is_sensible(metres)) {
    found.unit_reason = fmt::format(
        "the character would be {:.3g} m tall; no common unit gives a plausible height", metres);
    return;
  }
  found.unit_reason = fmt::format("bone lengths fit a person {:.2f} m tall, within {:.2f} m",
                                  metres, stature.uncertainty * found.unit.metres);
  if (found.unit.name == "cmu" && cmu_names && metres > 1.2 && metres < 2.2) {
    found.unit_confidence = Confidence::certain;
    found.unit_reason += ", with the joint names of the CMU collection";
  }
  if (found.unit_confidence == Confidence::guess) {
    found.unit_reason += "; no common unit is a clear match";
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

// Helper joints that are nearly unique to the CMU collection's skeletons.
bool has_cmu_names(const Skeleton& skeleton) {
  const bool lower_back = skeleton.find("LowerBack") >= 0 || skeleton.find("lowerback") >= 0;
  return lower_back && (skeleton.find("LHipJoint") >= 0 || skeleton.find("lhipjoint") >= 0);
}

}  // namespace

void detect_unit(const Evidence& evidence, Conventions& found) {
  if (const auto stature = stature_of(evidence)) {
    return detect_unit_of_actor(*stature, has_cmu_names(evidence.skeleton), found);
  }
  const double extent = largest_extent(evidence);
  constexpr double kLargest = 10.0;  // metres
  for (const char* name : {"m", "cm", "mm"}) {
    found.unit = unit_named(name);
    if (extent * found.unit.metres <= kLargest) break;
  }
  const double metres = extent * found.unit.metres;
  if (!(extent > 0)) {
    found.unit_reason = "all joints coincide, so the size is unknown";
  } else if (!is_sensible(metres)) {
    found.unit_reason = fmt::format(
        "no legs or arms to measure, and none of m, cm and mm gives a plausible size; in {} it "
        "would be {:.3g} m",
        found.unit.name, metres);
  } else {
    found.unit_reason =
        fmt::format("no legs or arms to measure; a size of {:.3g} m is assumed plausible", metres);
  }
}

namespace {

constexpr double kInLine = 0.8;  // cosine: within 37 degrees
constexpr double kAside = 0.82;  // cosine: over 35 degrees; a character set down diagonally

// The default: perpendicular to `up`.
Direction default_forward(Direction up) {
  return on_one_axis(up, Direction::plus_z) ? Direction::minus_y : Direction::plus_z;
}

// Detects forward in the reference pose if its trunk is along the motion's up axis.
bool detect_forward_in_reference(const Evidence& evidence, Conventions& found) {
  const auto& marks = evidence.marks;
  if (marks.hips < 0 || marks.head < 0) return false;
  const auto trunk =
      direction_between(at(evidence.reference, marks.hips), at(evidence.reference, marks.head));
  if (!trunk || trunk->dot(direction_vector(found.up)) < kInLine) return false;
  const auto forward = facing(evidence.reference, marks, found.up);
  if (!forward) return false;
  const NearestAxis axis = nearest_axis(*forward);
  found.forward = axis.direction;
  found.forward_reason =
      fmt::format("the reference pose faces {}, judging by its left and right side",
                  signed_name(axis.direction));
  found.forward_confidence = axis.cosine > 0.9 ? Confidence::likely : Confidence::guess;
  if (axis.cosine < kAside) {
    found.forward_reason += fmt::format(", but {:.0f} degrees aside, and so does all that faces",
                                        std::acos(axis.cosine) / kRadiansPerDegree);
    return true;
  }
  if (!evidence.reference_stands) return true;  // legs bent: toes are no evidence
  const auto toes = toes_direction(evidence.reference, marks, found.up);
  if (!toes) return true;
  const double along = toes->dot(direction_vector(axis.direction));
  if (along > 0.5) {
    found.forward_confidence = axis.cosine > 0.9 ? Confidence::certain : Confidence::likely;
    found.forward_reason += ", and the toes point that way";
  } else {
    found.forward_confidence = Confidence::guess;
    found.forward_reason += ", but the toes do not point that way: left and right may be swapped";
  }
  return true;
}

// Three children of the hips: both upper legs and the first joint of the spine.
struct Pelvis {
  int hips = -1, left_leg = -1, right_leg = -1, spine = -1;

  explicit Pelvis(const Evidence& evidence) {
    const auto& parents = evidence.skeleton.parents;
    const auto parent = [&](int joint) { return parents[static_cast<std::size_t>(joint)]; };
    const Landmarks& marks = evidence.marks;
    hips = marks.hips;
    if (hips < 0 || marks.left_leg < 0 || marks.right_leg < 0 || marks.head < 0) return;
    if (parent(marks.left_leg) != hips || parent(marks.right_leg) != hips) return;
    int above = marks.head;
    while (above >= 0 && parent(above) != hips) above = parent(above);
    left_leg = marks.left_leg;
    right_leg = marks.right_leg;
    spine = above;
  }

  bool known() const { return spine >= 0; }

  // Whether the spine begins clearly above the hips, so that it shows which way is up.
  bool is_tall(Positions pose) const {
    const Vec3 left = at(pose, left_leg) - at(pose, right_leg);
    const Vec3 middle = 0.5 * (at(pose, left_leg) + at(pose, right_leg));
    return (at(pose, spine) - middle).cross(left).norm() > 0.3 * left.squaredNorm();
  }

  // Axes of the pelvis in a pose, as columns: left, perpendicular to it towards the spine, forward.
  std::optional<Mat3> frame(Positions pose) const {
    const Vec3 left = at(pose, left_leg) - at(pose, right_leg);
    const Vec3 middle = 0.5 * (at(pose, left_leg) + at(pose, right_leg));
    const Vec3 spine_at = at(pose, spine) - middle;
    const Vec3 up = spine_at - spine_at.dot(left) / left.squaredNorm() * left;
    if (!left.allFinite() || !up.allFinite() || !(up.norm() > 0.05 * left.norm())) return {};
    Mat3 axes;
    axes.col(0) = left.normalized();
    axes.col(1) = up.normalized();
    axes.col(2) = axes.col(0).cross(axes.col(1));
    return axes;
  }
};

// Detects forward by the pelvis of a reference pose whose other parts are not upright.
bool detect_forward_by_pelvis(const Evidence& evidence, Conventions& found) {
  const Pelvis pelvis(evidence);
  const auto frame = pelvis.known() ? pelvis.frame(evidence.reference) : std::nullopt;
  const Vec3 vertical = direction_vector(found.up);
  if (!frame || frame->col(1).dot(vertical) < kInLine) return false;
  const NearestAxis axis = nearest_axis(frame->col(0).cross(vertical));
  if (axis.cosine < kInLine) return false;
  found.forward = axis.direction;
  found.forward_confidence = Confidence::likely;
  found.forward_reason =
      fmt::format("the pelvis of the reference pose faces {}", signed_name(axis.direction));
  return true;
}

// The up axis of the pelvis as the motion has it on average: that of the reference pose is not
// known where spine and hips begin at one height.
std::optional<NearestAxis> upright_pelvis(const Evidence& evidence, const Pelvis& pelvis,
                                          const Mat3& reference, Direction vertical) {
  Vec3 up = Vec3::Zero();
  for (std::size_t i = 0; i < evidence.sample_count; ++i) {
    const auto turned = pelvis.frame(evidence.sample(i));
    if (turned) up += reference * (turned->transpose() * direction_vector(vertical));
  }
  const NearestAxis upright = nearest_axis(up);
  if (upright.cosine < kInLine || !(up.norm() > 0.5 * static_cast<double>(evidence.sample_count)))
    return std::nullopt;
  return upright;
}

// For a reference pose that is not upright (such as rigs with all bones along one axis): those of
// its pelvis.
void detect_reference_axes_by_pelvis(const Evidence& evidence, Conventions& found) {
  const Pelvis pelvis(evidence);
  if (!pelvis.known()) return;
  const auto reference = pelvis.frame(evidence.reference);
  if (!reference) return;
  NearestAxis upright = nearest_axis(reference->col(1));
  if (upright.cosine < kInLine || !pelvis.is_tall(evidence.reference)) {
    const auto moved = upright_pelvis(evidence, pelvis, *reference, found.up);
    if (!moved) return;
    upright = *moved;
  }
  const Vec3 left = reference->col(0);
  const NearestAxis ahead = nearest_axis(left.cross(direction_vector(upright.direction)));
  if (ahead.cosine < kInLine) return;
  found.reference_up = upright.direction;
  found.reference_forward = ahead.direction;
}

}  // namespace

void detect_forward(const Evidence& evidence, Conventions& found) {
  found.forward = default_forward(found.up);
  if (detect_forward_in_reference(evidence, found)) return;
  if (detect_forward_by_pelvis(evidence, found)) return;
  // Where the character faces in a motion says nothing: takes of one session would be turned
  // against each other.
  found.forward_reason =
      fmt::format("{}; {} is the default",
                  evidence.marks.sides_known() ? "the facing of the reference pose is unclear"
                                               : "no left and right side to derive it from",
                  signed_name(found.forward));
}

// Detects the axes of a reference pose whose up axis differs from the motion's or that is not
// upright.
void detect_reference_axes(const Evidence& evidence, Conventions& found) {
  found.reference_up = found.up;
  found.reference_forward = found.forward;
  const auto& stands = evidence.reference_stands;
  if (!stands) return detect_reference_axes_by_pelvis(evidence, found);
  if (stands->direction == found.up) return;
  const auto forward = facing(evidence.reference, evidence.marks, stands->direction);
  if (!forward) return;
  found.reference_up = stands->direction;
  found.reference_forward = nearest_axis(*forward).direction;
}

}  // namespace krok::actor

namespace krok {

Conventions detect_conventions(const Skeleton& skeleton, const RoleMap& roles,
                               std::span<const Vec3> sample_positions) {
  const actor::Evidence evidence(skeleton, roles, sample_positions);
  Conventions found;
  actor::detect_up(evidence, found);
  actor::detect_forward(evidence, found);
  actor::detect_reference_axes(evidence, found);
  actor::detect_unit(evidence, found);
  return found;
}

}  // namespace krok
