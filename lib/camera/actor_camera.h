#pragma once

#include <optional>

#include "camera/actor_shape.h"
#include "core/result.h"
#include "roles/roles.h"
#include "scene/camera_track.h"
#include "scene/clip.h"

// A camera that keeps a figure in the picture: it follows a joint, goes round the figure, or stands
// still and shows the whole motion.

namespace krok {

// What an azimuth of 0 is before.
enum class AzimuthFrom : unsigned char {
  start,  // the way the figure faces in its first frame
  actor,  // the way it faces at each moment, smoothed
  world   // +Z
};

struct ActorCamera {
  // What is followed, a joint; -1 looks at the middle of the whole motion.
  int joint = -1;
  Framing framing = Framing::full;

  // From where it looks: 0 sees the figure's front, a quarter turn its left side.
  double azimuth = 0;    // radians about +Y
  double elevation = 0;  // radians, -pi/2 .. pi/2; pi/2 looks straight down
  AzimuthFrom azimuth_from = AzimuthFrom::start;
  double turning = 0;  // radians a second that the azimuth grows by; above 0 is counter-clockwise
                       // seen from above

  std::optional<double> distance;  // metres from what it looks at; worked out if not given

  double field_of_view = kPi / 4;  // vertical, radians, in (0, pi)
  double aspect = 16.0 / 9.0;      // width by height
  double margin = 0.08;            // of height and width, free at each edge; in [0, 0.45]

  // Seconds over which the path of the joint and the figure's facing are smoothed; smooth_both_ways
  // of camera/spring.h. 0 does not.
  double smoothing = 0.5;
  // Metres by which the joint may move without taking the camera along.
  double dead_zone = 0;
};

struct ActorShot {
  CameraTrack track;
  double distance = 0;       // metres, from what it looks at
  int frames_shown = 0;      // in which all that is framed is in the picture
  int frames_inside = 0;     // in which the camera is nearer to the body than kClearance
  int first_not_shown = -1;  // frames; -1 for none
  int first_inside = -1;
};

// What the camera keeps between itself and ground and body, metres, where it chooses its distance;
// the ground is at the lowest place of the feet.
inline constexpr double kClearance = 0.1;

// A frame for each of the clip's.
//
// It looks at a path: that of the joint, as the dead zone and the smoothing leave it, at a constant
// height above or below, so that what is framed is in the middle on average. Its distance from that
// path is one for the whole clip, the least at which all that is framed is in the picture in every
// frame, joints with the flesh about them and the margin included, and the camera is not within the
// body. Where it would be under the ground it is raised and looks up less. A camera that neither
// follows nor turns stands as near as it can with all frames in the picture, centred.
//
// With a distance given that distance is kept, and what leaves the picture is counted.
//
// Codes: camera-empty, camera-part, camera-value (options out of range), camera-frame (no distance
// up to 10 km shows all).
Result<ActorShot> film(const Clip& clip, const RoleMap& roles, const ActorCamera& camera);

}  // namespace krok
