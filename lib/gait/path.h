#pragma once

#include <optional>
#include <span>
#include <vector>

#include "core/result.h"
#include "math/transform.h"
#include "scene/clip.h"

// A way over the ground, from which footprints are planned.

namespace krok::gait {

struct PathPoint {
  double x = 0, z = 0;         // metres, world
  std::optional<double> time;  // seconds from the first frame
};

// Where a path is at some length, and which way it goes there.
struct PathPlace {
  double x = 0, z = 0;   // metres
  double heading = 0;    // radians about +Y as in Print; not wrapped, so that it is continuous
  double curvature = 0;  // change of heading, radians per metre
  std::optional<double> time;
};

// A polyline by arc length. It is followed exactly; its heading is that of the chord over
// `heading_window` metres (less near the ends), so that it is continuous at corners and where a
// polyline approximates a curve. Where the way turns back on itself, the heading turns the shorter
// way round. Times are linear between those given and only there.
class Path {
 public:
  // Codes: path-value for a point that is not finite or farther than 1e6 m from the origin;
  // path-short for a length of less than 5 cm; path-long for more than 1,000 km; path-times if
  // times do not rise.
  static Result<Path> create(std::span<const PathPoint> points, double heading_window = 0.3);

  double length() const { return length_; }  // metres
  // Clamped to the path.
  PathPlace at(double length) const;

 private:
  Path() = default;
  Vec2 point_at(double length, std::size_t& segment) const;
  void sample_headings(double window);

  std::vector<Vec2> points_;     // x, z; no two successive ones at the same place
  std::vector<double> lengths_;  // up to each point
  std::vector<double> times_;    // at timed_lengths_
  std::vector<double> timed_lengths_;
  double length_ = 0;
  double spacing_ = 0;            // of the samples
  std::vector<double> headings_;  // at i * spacing_, and the last at the end
};

// A way from (x, z) with a heading to each goal in turn: an arc of radius `radius` until the goal
// is straight ahead, then straight. The radius is less where the goal is nearer than that. Without
// times. A goal within a millimetre of where the way is already adds nothing.
std::vector<PathPoint> way_to_goals(double x, double z, double heading, std::span<const Vec2> goals,
                                    double radius = 0.8);

// The way of a joint, such as the hips, over the ground: its place in each frame, averaged
// twice over `window` seconds, about a stride, which takes out the sway of steps, and kept every 10
// cm. Without times.
std::vector<PathPoint> way_of(const Clip& clip, int joint, double window = 1.1);

}  // namespace krok::gait
