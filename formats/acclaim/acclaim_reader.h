#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "capture/capture.h"
#include "capture/rest_frame.h"
#include "core/result.h"
#include "math/transform.h"

// Reader for Acclaim skeletons (ASF) and motions (AMC), the formats of the CMU motion capture
// database. Format: M. Schafer, "Acclaim Skeleton File Definition V1.10", Acclaim, 1995, which also
// describes AMC; Vicon BodyBuilder's use of it: "Acclaim Format - ASF line Details" on CMU's pages.

namespace krok::acclaim {

// strictness normal: bones missing in a frame keep their last values, a truncated last frame is
// dropped, gaps between frame numbers are closed; each is a warning. An invalid line is an error.
// strict: all of these are errors. repair: invalid lines are skipped, gaps are filled by
// interpolation; each repair is listed.
//
// A given unit applies to the numbers as printed and overrides :units. With metres, up +y and
// forward +z, numbers are not converted. If no rate is given and the AMC has none (few do), it is
// 120 fps, the rate of most of the CMU database.
struct ReadOptions : CaptureOptions {
  RestFrame rest_frame = RestFrame::keep;
};

// A degree of freedom of a joint, from `dof` and `limits`.
struct DegreeOfFreedom {
  enum class Kind : unsigned char { translation, rotation, stretch };  // stretch: the bone's length
  Kind kind = Kind::rotation;
  int axis = 0;  // 0, 1, 2: x, y, z of the joint's `axes`; unused for stretch
  // Radians or metres; infinite if there is no limit. The motion is not clamped to them.
  double lower = 0;
  double upper = 0;
};

struct JointFreedom {
  Quat axes = Quat::Identity();  // the bone's local coordinate system in the reference pose
  // In the order of evaluation: the first is applied to a vector first.
  std::vector<DegreeOfFreedom> degrees;
};

// Each bone becomes a joint at its start, where the bone rotates, with the bone's name; each leaf
// also gets an end joint named <bone>_end. The root comes first, then the bones depth first in the
// order of :hierarchy. In the reference pose all orientations are the root's `orientation`, usually
// the identity: `axis` gives the axes of the motion channels, not the joint frames.
struct Capture : krok::Capture {
  std::vector<JointFreedom> freedoms;  // [joints]
  std::string name;                    // of the skeleton
  std::string documentation;
  long long first_frame_number = 0;  // of the clip's first frame in the AMC; 0 without frames
  bool rest_frame_found = false;     // the first frame is a rest pose
  bool rest_frame_dropped = false;
};

// Reads a skeleton and a motion for it. Texts need not outlive the call; names are for messages.
// With an empty `amc_text` and an empty `amc_name` the clip has the skeleton and no frames.
//
// A bone rotates at its start, about the axes given by `axis`: with C their orientation and the
// values v1, v2, v3 of a `dof rx ry rz`, its rotation relative to its parent is
// C Rz(v3) Ry(v2) Rx(v1) C^-1. `tx ty tz` move its start along the axes of C, `l` is its length.
// The position and orientation in :root are applied as parent transform of the root's motion. World
// transforms are computed in doubles and stored as floats.
//
// If frame numbers increase by a constant step n > 1, the file has every n-th frame of the
// recording: the rate is divided by n unless it was given.
//
// Codes of errors: acclaim-kind, acclaim-syntax, acclaim-number, acclaim-bone, acclaim-dof,
// acclaim-hierarchy, acclaim-unknown-bone, acclaim-values, acclaim-frame, acclaim-cut,
// acclaim-missing, acclaim-rate, acclaim-limit, direction-parallel. Of warnings and notes besides
// these: acclaim-keyword, acclaim-name, acclaim-limits, acclaim-root, acclaim-unit, acclaim-up,
// acclaim-forward, acclaim-repair, acclaim-rest-frame, acclaim-more, acclaim-far-rotation and
// acclaim-far-position (capture/far_values.h; errors if strict).
Result<Capture> read(std::string_view asf_text, const std::string& asf_name,
                     std::string_view amc_text, const std::string& amc_name,
                     const ReadOptions& options = {});

// The skeleton file of a motion, and why it was chosen.
struct FoundSkeleton {
  std::string path;
  std::string reason;    // "the motion's name begins with its name"
  bool by_name = false;  // not because it is the only one
};

// Searches the folder of the motion `amc_path` for its skeleton, a file with extension .asf
// (case-insensitive): the longest name that equals or begins the motion's name (01.asf for
// 01_01.amc, as in the CMU database), or else the only one in the folder. An Error (code
// acclaim-skeleton) if there is none or the choice is ambiguous.
Result<FoundSkeleton> find_skeleton(const std::string& amc_path);

}  // namespace krok::acclaim
