#pragma once

#include "gait/pose_vector_internal.h"
#include "parametric/packed_examples.h"

// The mean of a library's examples, which tells what its steps have in common. Used by walk().

namespace krok::gait {

PoseVector mean_pose(const parametric::PackedExamples& packed, double generic);

// The generic time at which the stance foot is flat.
double middle_of_swing(const parametric::PackedExamples& packed,
                       const parametric::Library& library);

}  // namespace krok::gait
