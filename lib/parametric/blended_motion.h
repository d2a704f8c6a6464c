#pragma once

#include <span>
#include <vector>

#include "motion/retime.h"
#include "parametric/packed_examples.h"
#include "pose/blend_pose.h"

namespace krok::parametric {

// The motion that weights make of a library's examples: (1) its keytimes are the weighted sums of
// theirs, counted from 0; (2) a monotone cubic through them gives the generic time at a moment; (3)
// each example is sampled at that generic time; (4) places and (5) rotations relative to the parent
// are summed with their weights, the root's as seen from the stance footprint, rotations in the
// hemisphere of the examples' mean and brought to length 1. The sum is then set on the stance foot:
// at the first keytime the blend's own footprint is at the origin, its toes to +Z. After that
// nothing holds the stance foot: between examples as different as level steps and stairs it wanders
// by some centimetres.
class BlendedMotion {
 public:
  // Both must outlive the motion, which keeps references to them. `weights`: [examples]. Codes:
  // parametric-weights where there are not as many, or they are no numbers that sum to 1 within
  // 1e-6; parametric-interval where an interval between keytimes would last less than
  // shortest_interval().
  static Result<BlendedMotion> create(const Library& library, const PackedExamples& packed,
                                      std::span<const double> weights);

  double duration() const { return keytimes_.back(); }               // seconds
  const std::vector<double>& keytimes() const { return keytimes_; }  // [keytimes], the first is 0

  // Generic time as PackedExamples has it.
  double generic_at(double time) const;

  struct Scratch {
    std::vector<BlendTerm> terms;
    std::vector<PoseBlock> reference;
  };
  Scratch make_scratch() const;

  // The pose at `time` seconds, clamped to the motion: joint_to_parent, the root's in the stance
  // foot's frame; `pose` has pose_blocks() of the joints. Gives the agreement that blend_poses()
  // gives. Allocates nothing; several threads may call it, each with a scratch of its own.
  float pose(double time, std::span<PoseBlock> pose, Scratch& scratch) const;

  // The motion as a clip at that rate (frames a second; 0: the library's), without provenance, and
  // its keys. LastFrame::kept stretches it by up to half a frame, so that the last keytime is the
  // last frame's; within ends up to a frame before it. Keytimes of steps have the names that they
  // have in walks: left_strike for swing_strike where the swing foot is the left one. Contacts are
  // those that all examples with a weight have. Code: clip-rate, clip-too-long.
  struct Made {
    Clip clip;
    MotionKeys keys;
    double agreement = 1;  // the least of all frames
  };
  Result<Made> make(double rate = 0, LastFrame last = LastFrame::kept) const;

 private:
  BlendedMotion(const Library& library, const PackedExamples& packed)
      : library_(library), packed_(packed) {}

  void set_on_stance_foot();
  double generic_of(const double* times, const double* slopes, double time) const;
  MotionKeys keys(double stretch, double duration) const;
  std::vector<Contact> contacts() const;

  const Library& library_;
  const PackedExamples& packed_;
  std::vector<double> weights_;
  std::vector<double> keytimes_, slopes_;
  Transform set_;  // from the sum's frame to the blend's own stance foot
};

}  // namespace krok::parametric
