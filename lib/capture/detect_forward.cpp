#include <fmt/format.h>

#include "capture/figure_internal.h"

namespace krok::figure {

namespace {

// A direction at right angles to `up`, for want of evidence.
Direction default_forward(Direction up) {
  return on_one_axis(up, Direction::plus_z) ? Direction::minus_y : Direction::plus_z;
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

}  // namespace

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

}  // namespace krok::figure
