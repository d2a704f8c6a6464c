#pragma once

#include <optional>
#include <string>
#include <vector>

#include "capture/conventions.h"
#include "core/result.h"
#include "math/transform.h"

// From what the user said and what the data show to the conversion into Krok's frame, with the
// words that tell the user. Readers of foreign formats share this.

namespace krok {

// A choice that a reader made for want of a word in the file, and why.
struct Choice {
  std::string choice;  // "120"
  std::string reason;  // a sentence without a full stop
  Confidence confidence = Confidence::guess;
};

// What the user says a file is written in; unset is worked out from the data.
struct GivenConventions {
  std::optional<Unit> unit;
  std::optional<Direction> up;
  std::optional<Direction> forward;
  bool complete() const { return unit && up && forward; }
};

// Puts what was given in the place of what was detected, for the reference pose too. Where a given
// axis lies along a detected one, the detected one gives way to a default with confidence `guess`.
void apply_given(const GivenConventions& given, Conventions& conventions);

// How transforms in a file's unit and axes become Krok's. The reference pose is turned by its own
// axes, and with it the joints' frames: an identity orientation in the file's reference pose stays
// one. In a frame positions turn by the motion's axes, and an orientation R of the file becomes
// turn R reference_turn^-1, so that what is bound to a joint in the reference pose follows it.
class Conversion {
 public:
  // An Error (code direction-parallel) if up and forward lie on one axis.
  static Result<Conversion> make(const Conventions& conventions);

  // joint_to_world of a frame, and of the reference pose. With metres, +Y and +Z nothing changes.
  Transform pose(const Transform& joint_to_world) const;
  Transform reference(const Transform& joint_to_world) const;

  // A rotation in the reference pose's axes: a limit's frame, a bone's axis.
  Quat reference_rotation(const Quat& rotation) const;
  double metres() const { return metres_; }

  // The axes of the reference pose to Krok's, a rotation with entries 0, 1 and -1.
  const Mat3& reference_axes() const { return reference_to_krok_; }

  // From the turned reference pose's axes to those of the frames, both Krok's; the identity,
  // exactly, where the file has one set of axes for both.
  const Transform& reference_to_motion() const { return reference_to_motion_; }

 private:
  double metres_ = 1.0;
  Mat3 to_krok_ = Mat3::Identity();  // entries 0, 1 and -1
  Mat3 reference_to_krok_ = Mat3::Identity();
  Quat turn_ = Quat::Identity();
  Quat reference_turn_ = Quat::Identity();
  Transform reference_to_motion_;
};

// A note for each convention that was not given, a warning with a hint where it is a guess. Codes:
// `code_prefix` with "-unit", "-up", "-forward".
void report_conventions(const Conventions& conventions, const GivenConventions& given,
                        const std::string& code_prefix, const std::string& file_name,
                        Diagnostics& diagnostics);

// The lines for Provenance::conversions; none for what needs no conversion.
std::vector<std::string> describe_conversions(const Conventions& conventions,
                                              const GivenConventions& given);

}  // namespace krok
