#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "capture/capture.h"
#include "capture/rest_frame.h"
#include "core/result.h"
#include "math/types.h"

// Acclaim skeletons (ASF) and motions (AMC), the form in which the CMU collection was recorded. The
// format: M. Schafer, "Acclaim Skeleton File Definition V1.10", Acclaim, 1995, which describes the
// AMC as well; how Vicon BodyBuilder uses it: "Acclaim Format - ASF line Details" on CMU's pages.

namespace krok::acclaim {

// strictness normal: bones that a frame leaves out stay as they were, a frame that the end of the
// file cuts short is left out, gaps between frame numbers close; each is a warning. A line that
// cannot be read is an error. strict: all of these are errors. repair: lines that cannot be read
// are left out, gaps are filled by interpolation; each repair is listed.
//
// A given unit is that of the numbers as printed, whatever :units says. With metres, up +y and
// forward +z given, numbers pass through unconverted. Where no rate is given and the AMC says none,
// as few do, it is 120, the rate of most of the CMU collection.
struct ReadOptions : CaptureOptions {
  RestFrame rest_frame = RestFrame::keep;
};

// What a joint can do, as `dof` and `limits` have it.
struct DegreeOfFreedom {
  enum class Kind : unsigned char { translation, rotation, stretch };  // stretch: the bone's length
  Kind kind = Kind::rotation;
  int axis = 0;  // 0, 1, 2: x, y, z of the joint's `axes`; unused for stretch
  // Radians or metres; infinite where there is no limit. The motion is not clipped to them.
  double lower = 0;
  double upper = 0;
};

struct JointFreedom {
  Quat axes = Quat::Identity();  // the bone's local coordinate system in the reference pose
  // In the order of evaluation: the first is applied to a vector first.
  std::vector<DegreeOfFreedom> degrees;
};

// A joint of the clip stands at the beginning of its bone, where the bone turns, and has the bone's
// name; leaves end in a joint named <bone>_end. The root comes first, then the bones depth first in
// the order of :hierarchy. In the reference pose all orientations are the root's `orientation`, as
// a rule the identity: the frames that `axis` gives are the motion's, not the joints'.
struct Capture : krok::Capture {
  std::vector<JointFreedom> freedoms;  // [joints]
  std::string name;                    // of the skeleton
  std::string documentation;
  long long first_frame_number = 0;  // of the clip's first frame in the AMC; 0 without frames
  bool rest_frame_found = false;     // the first frame is a rest pose
  bool rest_frame_dropped = false;
};

// Reads a skeleton and a motion for it. Texts need not outlive the call; names are for messages.
// With an empty `amc_text` and an empty `amc_name` the clip is the skeleton without frames.
//
// A bone turns at its beginning, about axes that `axis` gives: with C their orientation and the
// values v1, v2, v3 of a `dof rx ry rz`, its rotation relative to its parent is
// C Rz(v3) Ry(v2) Rx(v1) C^-1. `tx ty tz` move its beginning along the axes of C, `l` is its
// length. The root's position and orientation in :root are put before its motion. World transforms
// are computed in doubles and stored as floats.
//
// Frames whose numbers go up by a constant step n > 1 are taken as every n-th of the recording: the
// rate is divided by n unless it was given.
//
// Codes of errors: acclaim-kind, acclaim-syntax, acclaim-number, acclaim-bone, acclaim-dof,
// acclaim-hierarchy, acclaim-unknown-bone, acclaim-values, acclaim-frame, acclaim-cut,
// acclaim-missing, acclaim-rate, acclaim-limit, direction-parallel. Of warnings and notes besides
// these: acclaim-keyword, acclaim-name, acclaim-limits, acclaim-root, acclaim-unit, acclaim-up,
// acclaim-forward, acclaim-repair, acclaim-rest-frame, acclaim-more, acclaim-far-rotation and
// acclaim-far-position (capture/far_values.h; errors where reading is strict).
Result<Capture> read(std::string_view asf_text, const std::string& asf_name,
                     std::string_view amc_text, const std::string& amc_name,
                     const ReadOptions& options = {});

}  // namespace krok::acclaim
