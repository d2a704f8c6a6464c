#include "contacts/slide_speed.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "contacts/sole_points.h"

namespace krok {

double slide_speed(const Clip& clip, const RoleMap& roles) {
  const Feet feet = find_feet(clip, roles);
  std::vector<std::vector<Vec3>> tracks;
  for (const auto& points : feet.points) {
    for (const SolePoint& point : points) {
      tracks.push_back(track_of(clip, point, feet.leg_length));
    }
  }
  if (tracks.empty() || clip.frame_count() < 2) return 0;
  double way = 0;
  for (std::size_t f = 1; f < tracks.front().size(); ++f) {
    double least = std::numeric_limits<double>::infinity();
    for (const auto& track : tracks) {
      const Vec3 moved = track[f] - track[f - 1];
      least = std::min(least, std::hypot(moved.x(), moved.z()));
    }
    way += least;
  }
  return way / clip.duration();
}

}  // namespace krok
