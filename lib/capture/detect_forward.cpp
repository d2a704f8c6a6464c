#include <fmt/format.h>

#include <Eigen/Geometry>
#include <optional>

#include "capture/actor_internal.h"

namespace krok::actor {

namespace {

constexpr double kInLine = 0.8;  // cosine: within 37 degrees

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
