#pragma once

#include <span>

#include "pose/packed_pose.h"

// Weighted pose blending. Positions are summed with their weights, and rotations as quaternions,
// each in the hemisphere of the joint's rotation in the reference pose; the sum is normalised. For
// weights that sum to 1 this is the quaternion mean of Markley and others (Averaging Quaternions,
// J. Guidance, Control, and Dynamics 30, 2007) up to the third power of the spread. Weights may be
// negative or have another sum, which scales the positions. A vanishing sum of rotations (shorter
// than 1e-6) becomes the reference's rotation.
//
// Agreement: the functions return the smallest length of a joint's quaternion sum before
// normalisation. With weights >= 0 that sum to 1 it is 1 if all rotations agree, cos(angle / 4) for
// two rotations `angle` apart at equal weights (0.92 at 90 degrees, 0.71 at 180), and near 0 if the
// mean is meaningless.
//
// Nothing is allocated. AVX2, AVX-512 and the scalar reference give the same bits.

namespace krok {

// A clip with its sample time (seconds, as in sample_pose()) and its weight.
struct BlendTerm {
  const PackedClip* clip = nullptr;
  double time = 0;
  float weight = 0;
};

// Samples and blends all terms in one pass. All clips have as many joints as `reference` and
// `pose`. Without terms: the reference's rotations and zero positions. Returns the agreement.
// `pose` must not overlap anything else.
float blend_poses(std::span<const BlendTerm> terms, std::span<const PoseBlock> reference,
                  std::span<PoseBlock> pose);

// The scalar reference of blend_poses().
float blend_poses_reference(std::span<const BlendTerm> terms, std::span<const PoseBlock> reference,
                            std::span<PoseBlock> pose);

// The same in steps, for poses from other sources: clear_sum(), add_to_sum() for each pose,
// finish_sum().
void clear_sum(std::span<PoseBlock> sum);
void add_to_sum(std::span<const PoseBlock> pose, float weight, std::span<const PoseBlock> reference,
                std::span<PoseBlock> sum);
// Normalises the rotations; returns the agreement.
float finish_sum(std::span<const PoseBlock> reference, std::span<PoseBlock> sum);

}  // namespace krok
