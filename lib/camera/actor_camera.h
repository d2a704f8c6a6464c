#pragma once

#include <optional>
#include <span>
#include <vector>

#include "camera/framing.h"
#include "core/result.h"
#include "roles/roles.h"
#include "scene/camera_track.h"
#include "scene/clip.h"
#include "scene/frame_source.h"

// A camera that keeps a character framed: it follows a joint, orbits the character, or is static
// and shows the whole motion.

namespace krok {

// The part of the character to frame.

enum class Framing : unsigned char {
  full,   // the whole character
  upper,  // from the hips up, including the arms
  head,   // the head, or the neck if the head has no other joint
  joint   // one joint with its neighbours
};

// The character as balls around its joints, sized by its height. Ancestors of the hips that only
// position the character, props and helpers are ignored, unless there are no other joints.
struct ActorShape {
  std::vector<int> shown;     // joints that must be in the image; not empty
  std::vector<int> body;      // all joints the camera stays clear of
  std::vector<double> radii;  // [joints], metres
  std::vector<int> parents;   // [joints], for the bones; -1 for none
};

// `clip` gives the character's height if the reference pose has none; `joint` is that of
// Framing::joint. Codes: camera-empty (no joints or no frames), camera-part (no joint has the roles
// of that part).
Result<ActorShape> actor_shape(const Clip& clip, const RoleMap& roles, Framing framing,
                               int joint = 0);

// The balls of `joints` in one frame.
void balls_of(const ActorShape& shape, std::span<const int> joints,
              std::span<const Vec3f> positions, std::vector<Ball>& balls);

// Distance of a point from the surface of the body: the nearest of all bones, each with the radius
// of the smaller of its end balls. Negative inside.
double distance_to_body(const ActorShape& shape, std::span<const Vec3f> positions,
                        const Vec3& point);

// What azimuth 0 refers to.
enum class AzimuthFrom : unsigned char {
  start,  // the facing in the first frame
  actor,  // the facing in each frame, smoothed
  world   // +Z
};

struct ActorCamera {
  // The joint to follow; -1 looks at the middle of the whole motion.
  int joint = -1;
  Framing framing = Framing::full;

  // Direction to the camera: 0 sees the character's front, a quarter turn its left side.
  double azimuth = 0;    // radians about +Y
  double elevation = 0;  // radians, -pi/2 .. pi/2; pi/2 looks straight down
  AzimuthFrom azimuth_from = AzimuthFrom::start;
  double turning =
      0;  // radians per second added to the azimuth; positive is counter-clockwise from above

  std::optional<double> distance;  // metres from the point it looks at; computed if not given

  double field_of_view = kPi / 4;  // vertical, radians, in (0, pi)
  double aspect = 16.0 / 9.0;      // width / height
  double margin = 0.08;  // fraction of height and width kept free at each edge; in [0, 0.45]

  // Smoothing time in seconds for the joint's path and the facing; see smooth_both_ways in
  // camera/look_at.h. 0 disables smoothing. The facing is smoothed for longer where it turns faster
  // than 90 degrees a second, but for at most 20 s: a steady spin is followed.
  double smoothing = 0.5;
  // Metres that the joint may move before the camera follows.
  double dead_zone = 0;
};

struct ActorShot {
  CameraTrack track;
  double distance = 0;       // metres from the point it looks at
  int frames_shown = 0;      // frames in which everything to be framed is in the image
  int frames_inside = 0;     // frames in which the camera is closer to the body than kClearance
  int first_not_shown = -1;  // frame index; -1 for none
  int first_inside = -1;
};

// Min distance of the camera from ground and body in metres, if it chooses its distance; the ground
// is at the lowest position of the feet.
inline constexpr double kClearance = 0.1;

// One frame per frame of the clip.
//
// The camera looks at a path: the joint's path after dead zone and smoothing, at a constant height
// offset that centres the framed joints on average. Its distance from that path is constant over
// the clip: the shortest at which all framed joints, with their radii and the margin, are in the
// image in every frame and the camera is not inside the body. Where it would be below the ground,
// its elevation is increased. A camera that neither follows nor turns is placed as close as
// possible with all frames in the image, centred.
//
// A given distance is kept, and frames with joints outside the image are counted.
//
// Codes: camera-empty, camera-part, camera-value (options out of range), camera-frame (no distance
// up to 10 km shows everything).
Result<ActorShot> film(const Clip& clip, const RoleMap& roles, const ActorCamera& camera);
// The same of frames that are read on `jobs` threads, in two passes for a given distance, else
// three or more. Kept are about 150 bytes for each. Errors are those of the source, too.
Result<ActorShot> film(const FrameSource& source, const RoleMap& roles, const ActorCamera& camera,
                       int jobs);

}  // namespace krok
