#pragma once

#include <cstddef>
#include <limits>
#include <span>
#include <string>
#include <string_view>

#include "core/result.h"
#include "math/transform.h"

// Numbers of a capture that are finite, yet beyond any sense: one wrong digit or a lost point in a
// file makes them, and a motion made of them would be wrong without a word.

namespace krok {

// Degrees. Turns of a spinning joint may go on without end: a dancer who turns once a second for
// three quarters of an hour comes to this, 2,778 turns. Beyond it, an exporter's single precision
// is coarser than a sixteenth of a degree, so that such a value is hardly a measured angle.
inline constexpr double kFarthestRotation = 1e6;

// How far from the origin a joint may be, in metres: 10,000 times the largest extent of the
// skeleton's reference pose over the axes, and of a metre where it is smaller. There a float's
// steps reach a thousandth of the skeleton's size, a millimetre or two of a person, and what is
// stored as floats begins to jerk. Never beyond what a float holds.
double farthest_position(std::span<const Transform> reference);

// Which frames have such values.
struct FarValues {
  static constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();
  std::size_t first_rotation = kNone;  // the first frame with a rotation
  std::size_t rotations = 0;           // how many frames have one
  std::size_t first_position = kNone;
  std::size_t positions = 0;

  bool any() const { return rotations + positions > 0; }
  void add_rotation(std::size_t frame);
  void add_position(std::size_t frame);
  void add(const FarValues& other);
};

// What is told of the first of them, without its place. `code` is the warning's, `channel` what the
// file calls the rotation, `degrees` positive, `position` in metres; `of_file`, which may be empty,
// what stands in the file, "Hips.Xposition is 1e9".
Error far_rotation(std::string code, std::string_view channel, double degrees, std::size_t frames);
Error far_position(std::string code, std::string_view joint, const Vec3& position,
                   std::size_t frames, const std::string& of_file = {});

}  // namespace krok
