#pragma once

#include <cstddef>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "core/result.h"
#include "math/transform.h"

// Detects values of a capture that are finite but implausible, such as from a wrong digit or a
// missing decimal point, so that they are reported.

namespace krok {

// Max plausible rotation in degrees. Unwrapped angles accumulate: one turn per second for 46
// minutes reaches this value, 2,778 turns. Beyond it single precision is no finer than 1/16 degree,
// so such a value is hardly a measured angle.
inline constexpr double kFarthestRotation = 1e6;

// Max plausible distance of a joint from the origin in metres: 10,000 times the largest extent
// along an axis of the skeleton's reference pose, or 1 m if that is smaller. At that distance the
// spacing of floats is about a thousandth of the skeleton's size, 1 to 2 mm for a person, and
// motion stored as floats starts to jitter. At most kFarthest.
double farthest_position(std::span<const Transform> reference);

// How far from the origin the joints are at most in three quarters of the sample frames, shape
// [samples x joints]; infinite without samples.
double usual_distance(std::span<const Vec3> samples, std::size_t joints);

// The same limit for a motion that keeps within that distance for most of its time: at most 10
// times the distance and 100 times the size. A root beyond it for some frames is a fault of the
// capture.
double farthest_position(std::span<const Transform> reference, double usual_distance);

// Frames with such values.
struct FarValues {
  static constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();
  std::size_t first_rotation = kNone;  // first frame with such a rotation
  std::size_t rotations = 0;           // number of frames with one
  std::size_t first_position = kNone;
  std::size_t positions = 0;

  bool any() const { return rotations + positions > 0; }
  void add_rotation(std::size_t frame);
  void add_position(std::size_t frame);
  void add(const FarValues& other);
};

// The warning about the first such value; the caller adds the location. `channel`: the rotation's
// name in the file. `degrees`: positive. `frames`: number of frames with such values. `position`:
// in metres. `of_file`: the value as in the file, "Hips.Xposition is 1e9"; may be empty.
// `usual_distance`: given if the position is only far in comparison with other frames.
Error far_rotation(std::string code, std::string_view channel, double degrees, std::size_t frames);
Error far_position(std::string code, std::string_view joint, const Vec3& position,
                   std::size_t frames, const std::string& of_file = {},
                   std::optional<double> usual_distance = {});

}  // namespace krok
