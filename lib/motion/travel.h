#pragma once

#include <optional>
#include <span>
#include <vector>

#include "core/result.h"
#include "scene/clip.h"
#include "scene/frame_source.h"

namespace krok {

enum class Travel {
  all,   // the character stays at its position in the first frame
  trend  // removes only the straight line from the first frame's position to the last's; sway about
         // it is kept, and a loop stays a loop
};

// The motion without the horizontal travel of `carrier` (see carrying_joint). Heights and rotations
// are unchanged. Ancestors of the carrier that do not travel, such as a root that only places the
// character, are unchanged. So are clips of fewer than two frames.
Clip in_place(const Clip& clip, int carrier, Travel removed);
// The same of frames that are produced on demand, read once beforehand if there are joints above
// the carrier.
Result<FrameSource> in_place(const FrameSource& source, int carrier, Travel removed, int jobs);

// The opposite: the motion with `added` from its first frame on, whole poses moved and turned about
// the carrier's place in the first frame. Where in_place() removed the trend of a straight path, at
// its mean velocity, this gives the motion before. Provenance no longer has a removed root motion.
Clip carried_along(const Clip& clip, int carrier, const RootMotion& added);

// A motion in place carried along at the root motion that its provenance says was taken out of it;
// empty if none was. Feet stay on the ground in it, so it is the one in which steps are judged.
std::optional<Clip> travelling(const Clip& clip, int carrier);

// A step of a joint between two frames that nobody makes, as where takes were put together or a
// path goes back to its start: faster than 10 m/s and over 8 times the median step.
struct Jump {
  int frame = 0;        // after it
  double distance = 0;  // metres
};
std::vector<Jump> jumps_of(std::span<const Vec3f> track, double rate);
std::vector<Jump> jumps_of(const Clip& clip, int joint);

// The largest distance that a joint was moved, and the first joint and frame with it.
struct Displacement {
  double distance = 0;  // metres
  int joint = 0;
  int frame = 0;
};

// The largest distance between the positions of one of `joints` in two clips at the same frame.
// Both clips have the same joints and frame count. The second form looks at the frames [begin,
// end).
Displacement largest_displacement(const Clip& before, const Clip& after,
                                  std::span<const int> joints);
Displacement largest_displacement(const Clip& before, const Clip& after,
                                  std::span<const int> joints, int begin, int end);

// Moves, turns and scales a whole motion. Functions that compute a movement return a world_to_world
// transform, so that several can be combined; move_clip applies it. `carrier` is the result of
// carrying_joint(); clips without frames give the identity.

// Transforms every joint of every frame; the reference pose is unchanged.
void move_clip(const Transform& world_to_world, Clip& clip);

// Moves the character's position in the first frame to the origin; keeps height and heading.
Transform to_origin(const Clip& clip, int carrier);

// Turns by `angle` radians about the vertical through the character's position in the first frame.
Transform turned_about_start(const Clip& clip, int carrier, double angle);

// As above, so that the character faces `heading` (radians) in the first frame.
Transform facing_at_start(const Clip& clip, int carrier, double heading);

// Moves the lowest position of `joints` in any frame to y = 0.
Transform onto_ground(const Clip& clip, std::span<const int> joints);

// Scales the positions of all frames and of the reference pose about the origin. Code motion-scale
// unless the factor is positive and finite and the result fits in floats.
Status scale_clip(double factor, Clip& clip);

// Height from the lowest joint to the highest in the reference pose, metres.
double reference_height(const Skeleton& skeleton);

}  // namespace krok
