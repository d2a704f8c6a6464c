#pragma once

#include <span>
#include <vector>

#include "motion/sample.h"
#include "parametric/example_sums.h"
#include "parametric/packed_examples.h"
#include "pose/packed_pose.h"

namespace krok::parametric {

// The blend of a library's examples with given weights: (1) its keytimes are the weighted sums of
// theirs, from 0; (2) a monotone cubic through them maps time to generic time; (3) each example is
// sampled at that generic time; (4) positions and (5) local rotations are summed with the weights,
// the root's relative to the stance footprint, rotations normalised and in the hemisphere of the
// examples' mean. Joints above the hips are restored as HipsRoot has it; a root that stands in the
// examples stands where it does in the reference pose. The result is then aligned to the stance
// foot: at the first keytime the blend's own footprint is at the origin, toes to +Z. The stance
// foot is not locked after that: between examples as different as level steps and stairs it skates
// by some centimetres.
class BlendedMotion {
 public:
  // Both must outlive the motion. `weights`: [examples]. Codes: parametric-weights if the count is
  // wrong, or they are not finite numbers that sum to 1 within 1e-6; parametric-interval if an
  // interval between keytimes would be shorter than shortest_interval().
  static Result<BlendedMotion> create(const Library& library, const PackedExamples& packed,
                                      std::span<const double> weights);

  // Makes poses from sums of the examples from now on, to ExampleSums::kMaxLeftOut, unless its
  // weights are farther from them. The example `apart` (-1: none) is sampled by itself, with
  // `weight` of its weight. Returns whether it does. `sums`, of the same examples, must outlive the
  // motion.
  bool use(const ExampleSums& sums, int apart = -1, double weight = 0);

  double duration() const { return keytimes_.back(); }               // seconds
  const std::vector<double>& keytimes() const { return keytimes_; }  // [keytimes], the first is 0

  // Generic time, see PackedExamples.
  double generic_at(double time) const;

  struct Scratch {
    std::vector<BlendTerm> terms;
    std::vector<PoseBlock> reference, apart;
  };
  Scratch make_scratch() const;

  // The pose at `time` seconds, clamped to the motion: joint_to_parent, the root's in the stance
  // foot's frame; `pose` has pose_blocks() of the joints. Returns the agreement of blend_poses().
  // Does not allocate; thread-safe with one scratch per thread.
  float pose(double time, std::span<PoseBlock> pose, Scratch& scratch) const;

  // Samples the motion to a clip at `rate` (frames per second), without provenance, with its keys.
  // LastFrame::kept stretches it by up to half a frame, so that the last keytime is at the last
  // frame; within ends up to a frame before it. 0 is the library's rate, with LastFrame::kept the
  // rate next to it at which the last frame is at the last keytime, so that the motion lasts
  // exactly as long as it should. Step keytimes get the names used in walks: left_strike for
  // swing_strike if the swing foot is the left one. Contacts are those common to all examples with
  // nonzero weight. Codes: clip-rate, clip-too-long.
  struct Made {
    Clip clip;
    MotionKeys keys;
    double agreement = 1;  // min over all frames
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
  float sum_examples(double generic, const GenericTimePoint& place, std::span<PoseBlock> pose,
                     Scratch& scratch) const;

  std::vector<double> weights_;
  std::vector<double> keytimes_, slopes_;
  const ExampleSums* sums_ = nullptr;  // see use()
  std::vector<float> coefficients_;
  int apart_ = -1;
  double apart_weight_ = 0;
  Transform set_;  // from the blended frame to the blend's own stance footprint
};

}  // namespace krok::parametric
