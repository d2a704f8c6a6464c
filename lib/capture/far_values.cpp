#include "capture/far_values.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <vector>

#include "core/numbers.h"
#include "scene/skeleton.h"

namespace krok {

namespace {

std::string frames_of(std::size_t frames) {
  return frames == 1 ? "no other frame is affected" : fmt::format("{} frames are affected", frames);
}

// The largest extent along an axis, 1 m at least.
double size_of(std::span<const Transform> reference) {
  Eigen::AlignedBox3d box;
  for (const Transform& joint : reference) box.extend(joint.position);
  const double size = box.isEmpty() ? 0.0 : box.sizes().maxCoeff();
  return std::isfinite(size) ? std::max(size, 1.0) : size;
}

}  // namespace

double farthest_position(std::span<const Transform> reference) {
  constexpr double kTimesTheSize = 1e4;
  constexpr auto kMax = static_cast<double>(kFarthest);
  const double size = size_of(reference);
  return std::isfinite(size) ? std::min(kMax, kTimesTheSize * size) : kMax;
}

double usual_distance(std::span<const Vec3> samples, std::size_t joints) {
  std::vector<double> distances;
  for (std::size_t i = 0; joints > 0 && i + joints <= samples.size(); i += joints) {
    double farthest = 0;
    for (const Vec3& p : samples.subspan(i, joints)) farthest = std::max(farthest, p.squaredNorm());
    if (std::isfinite(farthest)) distances.push_back(std::sqrt(farthest));
  }
  if (distances.empty()) return INFINITY;
  const auto found = distances.begin() + static_cast<std::ptrdiff_t>(3 * distances.size() / 4);
  std::nth_element(distances.begin(), found, distances.end());
  return *found;
}

double farthest_position(std::span<const Transform> reference, double usual_distance) {
  const double usual = 10 * usual_distance + 100 * size_of(reference);
  const double any = farthest_position(reference);
  return usual < any ? usual : any;
}

void FarValues::add_rotation(std::size_t frame) {
  first_rotation = std::min(first_rotation, frame);
  ++rotations;
}

void FarValues::add_position(std::size_t frame) {
  first_position = std::min(first_position, frame);
  ++positions;
}

void FarValues::add(const FarValues& other) {
  first_rotation = std::min(first_rotation, other.first_rotation);
  first_position = std::min(first_position, other.first_position);
  rotations += other.rotations;
  positions += other.positions;
}

Error far_rotation(std::string code, std::string_view channel, double degrees, std::size_t frames) {
  return {std::move(code),
          fmt::format("{} rotates by {} degrees, {} full turns, which is implausible; {}", channel,
                      readable(degrees), readable(std::floor(degrees / 360.0)), frames_of(frames)),
          "check the value; it is read modulo 360 degrees"};
}

Error far_position(std::string code, std::string_view joint, const Vec3& position,
                   std::size_t frames, const std::string& of_file,
                   std::optional<double> usual_distance) {
  const auto size = static_cast<float>(position.cwiseAbs().maxCoeff());
  const double step = static_cast<double>(std::nextafter(size, INFINITY)) - size;
  const std::string steps = step < 1 ? readable(1000 * step, 3) + " mm" : readable(step, 3) + " m";
  const std::string place =
      fmt::format("{} is {} m from the origin{}", joint, readable(position.norm(), 4),
                  of_file.empty() ? "" : " (" + of_file + ")");
  if (usual_distance) {
    return {std::move(code),
            fmt::format("{}, but the character keeps within {} m for most of the time; {}", place,
                        readable(*usual_distance, 3), frames_of(frames)),
            "check these frames; krok-edit --from and --to cut them away"};
  }
  return {std::move(code),
          fmt::format("{}, where floats are {} apart and smaller movements are lost; {}", place,
                      steps, frames_of(frames)),
          "check the value and the unit; if the capture is that far away, move it to the origin"};
}

}  // namespace krok
