#pragma once

#include <array>
#include <functional>
#include <span>
#include <vector>

#include "roles/roles.h"
#include "scene/clip.h"

// Sole points: the points of a foot that touch the ground, for any joints of a foot.

namespace krok {

enum class FootSide : unsigned char { left, right };
enum class FootPart : unsigned char { heel, ball, tip };

// "left", "right"; "heel", "ball", "tip".
const char* name_of(FootSide side);
const char* name_of(FootPart part);

// A point fixed to a joint.
struct SolePoint {
  FootSide side = FootSide::left;
  FootPart part = FootPart::heel;
  int joint = 0;
  Vec3 offset = Vec3::Zero();  // metres, in the joint's frame
  // Whether no joint marks the point, so that it is placed by typical foot proportions.
  bool estimated = false;
};

struct Feet {
  double leg_length = 0;  // metres, hip to knee to ankle, the mean of both; 0: no legs
  std::array<std::vector<SolePoint>, 2> points;  // [FootSide], heel before ball before tip
};

// The sole points of a skeleton. The heel is placed behind and below the ankle, and a tip without
// an end site ahead of the ball, after Drillis and Contini's foot (Winter, "Biomechanics and Motor
// Control of Human Movement"): ankle 0.039 of the stature above the sole and 0.036 ahead of the
// heel, which is 0.079 and 0.073 of the leg. Ankles that are over 0.16 of the leg above the toes,
// as in boots on short legs, are as high as in a reference pose on the ground at y = 0. The down
// direction in the foot's frame is taken from the frames in which the foot is still, because
// reference poses may point the toes anywhere; if there are none, from the frames in which it is
// lowest, and for clips of fewer than five frames from the reference pose. Frames that repeat the
// one before do not count. A foot that is only an end site has one point, at the ankle.
Feet find_feet(const Clip& clip, const RoleMap& roles);

// Which way the ground below a point faces: a unit vector, world. Without a function: upwards.
using UpOfGround = std::function<Vec3(const Vec3& point)>;

// The same for a motion on a ground that is not level, on which the soles of feet that stand face
// as it does.
Feet find_feet(const Clip& clip, const RoleMap& roles, const UpOfGround& up);

// Whether a point jumps from the first frame, as from a rest pose before the capture: by over three
// times the larger of the next two steps plus a tenth of a leg. False for fewer than four places.
bool jumps_at_start(std::span<const Vec3> track, double leg_length);

// Position of a point in each frame, shape [frames]. A first frame from which it jumps is replaced
// by linear extrapolation from the next two frames.
std::vector<Vec3> track_of(const Clip& clip, const SolePoint& point, double leg_length);

// Foot skate as a speed, metres per second: in each frame the horizontal speed of the slowest sole
// point of both feet, averaged over the clip. In walking and standing one foot is always down, so
// this is 0 without foot skate, independent of contact detection. Not meaningful for runs and
// jumps, which have flight phases. 0 for fewer than two frames, and if the roles include no foot.
double slide_speed(const Clip& clip, const RoleMap& roles);

}  // namespace krok
