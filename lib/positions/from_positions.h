#pragma once

#include <span>
#include <vector>

#include "roles/roles.h"
#include "scene/clip.h"

// Rotations from joint positions alone, as pose estimation and generative models give them.
//
// - Bone lengths are constant, by least squares over the clip; so are the offsets of all children
//   of a joint that has several (generalised Procrustes analysis, Gower 1975).
// - A joint with children in several directions takes the rotation that fits them best (Kabsch
//   1976; Wahba 1965), from the root down, each bone towards where its child was measured.
// - A joint with one child takes its parent's rotation, turned by the smallest angle that points
//   its bone at the child; past joints without a role, such as the single hinges of a robot's hip,
//   that of the last joint before them, and slowly in time. The rest of the twist at the next joint
//   that is known in full is spread over such a chain, but not over arms and legs, whose hinges
//   decide.
// - Upper arms and upper legs are twisted so that elbow and knee bend about their hinges. Where the
//   limb is straight the twist is carried over from before and after, by least squares over time.
// - A joint without children keeps its rotation relative to its parent.
// - White noise shows in the bone lengths, which would otherwise not change. It is removed from all
//   joints together (filter/series_denoiser.h); positions without noise are not changed.
// - Joints are where the sum of their squared distances from these places is least, with bones of
//   constant length: a third of what is left of the noise is along the bones, and goes, too.

namespace krok {

struct PositionsToPose {
  // Names, parents and the reference pose, of which the directions of bones are taken, and the
  // orientations of joints. An offset of length 0 is measured: the mean in the parent's frame.
  Skeleton skeleton;
  RoleMap roles;                    // of limbs with hinges; others need none
  std::span<const Vec3> positions;  // [frames x joints], metres, +Y up, finite
  double rate = 30;                 // frames per second
  bool smooth = true;               // as far as there is noise
  int jobs = 0;                     // threads, as in parallel_for; does not affect the result
};

struct PoseFromPositions {
  // The skeleton has the bone lengths of the positions.
  Clip clip;
  double noise = 0;  // standard deviation of a coordinate, metres: root mean square of the joints
  bool smoothed = false;
  // Whether the root was elsewhere than the body, which moved away from it (as one at the origin):
  // it is at the place of its child then, and not counted below.
  bool root_at_body = false;
  // Distance of joints in the clip to `positions`, metres.
  double rms = 0, largest = 0;
  int largest_joint = 0, largest_frame = 0;
  // Sum of the bones' standard deviations over the sum of their lengths: 0 for a rigid body.
  double length_variation = 0;
};

// Same input, same result. Fewer than 5 frames are not smoothed. Positions in one place give the
// reference pose's rotations.
PoseFromPositions from_positions(const PositionsToPose& input);

// Fills places that are not finite, `positions`: [frames x joints], from the frames before and
// after: bones turn, and change their length, evenly. Parents come first. False if a joint has no
// place in any frame.
bool fill_gaps(std::span<const int> parents, std::span<Vec3> positions);

// Fills joints that are off their bones for up to a quarter of a second in the same way, and gaps:
// a bone is longer or shorter than usual by 5 cm and 8 standard deviations, and its joint is the
// one of its ends that is away from its own path. Returns how many frames of each joint.
std::vector<int> remove_glitches(std::span<const int> parents, double rate,
                                 std::span<Vec3> positions);

// The standard deviation of white noise in each coordinate of each joint, metres, by the second
// differences of bone lengths. `tracks`: [joints x frames]. 0 for fewer than 5 frames.
std::vector<double> noise_of(std::span<const int> parents, std::span<const Vec3> tracks);

// Removes that noise from the tracks of all joints together by filter::without_noise_in_parts(),
// between the frames at which a joint jumps to another place, as after a rest pose. Returns whether
// anything changed.
bool smooth_tracks(std::span<const double> noise, double rate, int jobs, std::span<Vec3> tracks);

}  // namespace krok
