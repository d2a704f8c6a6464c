#pragma once

#include <span>

#include "body/human_actor.h"
#include "body/implicit.h"

namespace krok::body {

// A human body around a skeleton that stands upright on its feet, facing +Z with its left at +X
// (see human_pose.h). `pose` is joint_to_world, [joints].
//
// Proportions: segment lengths and heights over stature after Drillis and Contini (1966) as given
// by Winter; breadths, depths and girths over stature rounded from the means of ANSUR II (Gordon et
// al. 2014, men 1.756 m, women 1.629 m), between the two and slightly leaner. Girths become
// ellipses of that circumference.
Shape human_shape(const Skeleton& skeleton, const HumanActor& actor,
                  std::span<const Transform> pose);

}  // namespace krok::body
