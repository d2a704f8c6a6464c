#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "capture/conventions.h"
#include "core/result.h"
#include "math/transform.h"
#include "scene/skeleton.h"

// Combines given and detected conventions into the conversion to Krok's frame, and reports them.
// Shared by the readers of foreign formats.

namespace krok {

// A choice made by a reader because the file does not specify it, and why.
struct Choice {
  std::string choice;  // "120"
  std::string reason;  // a sentence without a full stop
  Confidence confidence = Confidence::guess;
};

// Conventions given by the user; those not set are detected from the data.
struct GivenConventions {
  std::optional<Unit> unit;
  std::optional<Direction> up;
  std::optional<Direction> forward;
  // Of the reference pose, where they differ; needs `up` and `forward`.
  std::optional<Direction> reference_up, reference_forward;
  // Axes that are not the user's but those of other takes: why, a sentence without a full stop.
  std::string axes_reason;
  Confidence axes_confidence = Confidence::certain, forward_confidence = Confidence::certain;
  bool axes_given(const std::optional<Direction>& axis) const {
    return axis.has_value() && axes_reason.empty();
  }
  bool complete() const { return unit && up && forward; }
};

// Overrides detected conventions by given ones, for the reference pose too. A detected axis
// parallel to a given one is replaced by a default with confidence `guess`.
void apply_given(const GivenConventions& given, Conventions& conventions);

// Converts transforms from a file's unit and axes to Krok's. The reference pose is rotated by its
// own axes, together with the joint frames: an identity orientation in the file's reference pose
// stays the identity. In a frame of the motion, positions are rotated by the motion's axes, and a
// file orientation R becomes turn R reference_turn^-1, so that whatever is bound to a joint in the
// reference pose follows it.
class Conversion {
 public:
  // An Error (code direction-parallel) if up and forward are parallel.
  static Result<Conversion> make(const Conventions& conventions);

  // joint_to_world of a frame, and of the reference pose. The identity for metres, +Y up, +Z
  // forward.
  Transform pose(const Transform& joint_to_world) const;
  Transform reference(const Transform& joint_to_world) const;

  // A rotation given in the reference pose's axes, such as a joint limit's frame or a bone's axes.
  Quat reference_rotation(const Quat& rotation) const;
  double metres() const { return metres_; }

  // From the reference pose's axes to Krok's: a rotation matrix with entries 0, 1 and -1.
  const Mat3& reference_axes() const { return reference_to_krok_; }

  // From the converted reference pose to the converted frames; exactly the identity if the file
  // uses the same axes for both.
  const Transform& reference_to_motion() const { return reference_to_motion_; }

 private:
  double metres_ = 1.0;
  Mat3 to_krok_ = Mat3::Identity();  // entries 0, 1 and -1
  Mat3 reference_to_krok_ = Mat3::Identity();
  Quat turn_ = Quat::Identity();
  Quat reference_turn_ = Quat::Identity();
  Transform reference_to_motion_;
};

// Adds a note for each convention that was not given; for guesses a warning with a hint. Codes:
// `code_prefix` with "-unit", "-up", "-forward".
void report_conventions(const Conventions& conventions, const GivenConventions& given,
                        const std::string& code_prefix, const std::string& file_name,
                        Diagnostics& diagnostics);

// Lines for Provenance::conversions; empty if no conversion is needed.
std::vector<std::string> describe_conversions(const Conventions& conventions,
                                              const GivenConventions& given);

// Detects the program that wrote a capture from its joint names and number formatting. Informative
// only: reading does not depend on it.

struct Exporter {
  std::string name;    // "iPi Mocap Studio, own names"
  std::string reason;  // a sentence without a full stop
  Confidence confidence = Confidence::guess;
  // Axes of all its files, where they are known and their skeletons do not show them.
  std::optional<Direction> up = {}, forward = {};
};

// Axes of a recognised exporter's files, in place of what one take seems to show: those detected
// with certainty, and from the reference pose, stay.
void apply_exporter(const Exporter& exporter, Conventions& conventions);

// Properties of a text file other than its skeleton.
struct ExporterTraits {
  std::string_view frame_time;  // as printed, without blanks; empty if there is none
  bool rows_begin_with_tab = false;
  bool starts_unturned = false;  // all rotations of the first frame are zero
};

// The exporter whose characteristic joint names are all present: `certain` if the names are nearly
// unique to it, `likely` if other programs use them too; empty if none matches. Comparison ignores
// case and namespaces.
std::optional<Exporter> recognise_exporter(const Skeleton& skeleton, const ExporterTraits& traits);

}  // namespace krok
