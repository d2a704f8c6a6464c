#pragma once

#include <span>
#include <vector>

#include "pose/packed_pose.h"

// Weighted sums of poses: positions are added with their weights, rotations as quaternions, each in
// the hemisphere of the reference pose's rotation of its joint, and the sum brought to length 1.
// For weights that sum to 1 that is the mean of rotations of Markley and others (Averaging
// Quaternions, J. Guidance, Control, and Dynamics 30, 2007) up to the third power of their spread.
// Weights may be negative or sum to something else, which the positions show. A sum of rotations
// that vanishes (shorter than 1e-6) becomes the reference's.
//
// Agreement: what the functions give back is the smallest length that a joint's sum of rotations
// had before it was brought to 1. With weights >= 0 that sum to 1 it is 1 where all agree,
// cos(angle / 4) for two rotations `angle` apart at equal weights (0.92 at 90 degrees, 0.71 at
// 180), and near 0 where the mean means nothing.
//
// Nothing is allocated. The same bits on AVX2, AVX-512 and for the reference.

namespace krok {

// A clip at a time of its own (seconds, as sample_pose() takes it) with its weight.
struct BlendTerm {
  const PackedClip* clip = nullptr;
  double time = 0;
  float weight = 0;
};

// Samples all terms and blends them in one go. All clips have as many joints as `reference` and
// `pose` have room for. Without terms the reference's rotations and positions of zero. Returns the
// agreement. `pose` overlaps nothing else.
float blend_poses(std::span<const BlendTerm> terms, std::span<const PoseBlock> reference,
                  std::span<PoseBlock> pose);

// The scalar reference of blend_poses().
float blend_poses_reference(std::span<const BlendTerm> terms, std::span<const PoseBlock> reference,
                            std::span<PoseBlock> pose);

// The same step by step, for poses from elsewhere and for weights that differ from joint to joint:
// clear_sum(), add_to_sum() for each pose, finish_sum().
struct alignas(64) WeightBlock {
  float weight[PoseBlock::kLanes];
};
void clear_sum(std::span<PoseBlock> sum);
void add_to_sum(std::span<const PoseBlock> pose, float weight, std::span<const PoseBlock> reference,
                std::span<PoseBlock> sum);
// Each joint's weight is `weight` times its own, such as a mask with soft edges.
void add_to_sum(std::span<const PoseBlock> pose, float weight,
                std::span<const WeightBlock> joint_weights, std::span<const PoseBlock> reference,
                std::span<PoseBlock> sum);
// Brings the rotations to length 1; returns the agreement.
float finish_sum(std::span<const PoseBlock> reference, std::span<PoseBlock> sum);

// Weights of joints, packed; those of lanes without a joint are 1.
std::vector<WeightBlock> pack_weights(std::span<const float> joint_weights);

}  // namespace krok
