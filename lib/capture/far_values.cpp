#include "capture/far_values.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "core/numbers.h"
#include "scene/farthest.h"

namespace krok {

namespace {

std::string frames_of(std::size_t frames) {
  return frames == 1 ? "no other frame is affected" : fmt::format("{} frames are affected", frames);
}

}  // namespace

double farthest_position(std::span<const Transform> reference) {
  constexpr double kTimesTheSize = 1e4;
  constexpr auto kMax = static_cast<double>(kFarthest);
  Eigen::AlignedBox3d box;
  for (const Transform& joint : reference) box.extend(joint.position);
  const double size = box.isEmpty() ? 0.0 : box.sizes().maxCoeff();
  if (!std::isfinite(size)) return kMax;
  return std::min(kMax, kTimesTheSize * std::max(size, 1.0));
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
                   std::size_t frames, const std::string& of_file) {
  const auto size = static_cast<float>(position.cwiseAbs().maxCoeff());
  const double step = static_cast<double>(std::nextafter(size, INFINITY)) - size;
  const std::string steps = step < 1 ? readable(1000 * step, 3) + " mm" : readable(step, 3) + " m";
  return {std::move(code),
          fmt::format("{} is {} m from the origin{}, where floats are {} apart and smaller "
                      "movements are lost; {}",
                      joint, readable(position.norm(), 4),
                      of_file.empty() ? "" : " (" + of_file + ")", steps, frames_of(frames)),
          "check the value and the unit; if the capture is that far away, move it to the origin"};
}

}  // namespace krok
