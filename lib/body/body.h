#pragma once

#include <string>

#include "core/progress.h"
#include "core/result.h"
#include "scene/clip.h"
#include "scene/frame_source.h"
#include "scene/model.h"

namespace krok {

// About 1,200, 2,500, 10,000 and 40,000 vertices for a human body; a preview, for pictures the size
// of a thumb, has thick fingers and is made in a third of the time of low.
enum class BodyDetail { preview, low, medium, high };

// The pose that the body is built in, which becomes the model's reference pose. `automatic` is the
// skeleton's reference pose, with limbs that a body cannot be built around (folded, touching the
// trunk, crossing) rotated out of the way; if that pose is unusable (such as all bones along one
// axis), the frame of the clip that needs the least rotation.
enum class BodyPose { automatic, reference, frame };

struct BodyOptions {
  BodyDetail detail = BodyDetail::medium;
  BodyPose pose = BodyPose::automatic;
  int frame = 0;  // for BodyPose::frame
  int jobs = 0;   // threads, see parallel.h; does not affect the result
  Progress* progress = nullptr;
};

struct Body {
  // One part, "body", with material "body". The mesh is one closed, oriented 2-manifold without
  // handles (a topological sphere) or duplicated vertices; normals point outwards. Four influences
  // per vertex. Texture coordinates are in [0, 1]: u runs around a limb from front (0) to back (1),
  // mirrored left and right, so that no seam is needed; v is the distance from the root along the
  // bones, 0 at the root and 1 at the farthest tip.
  Model model;
  bool human = false;       // shaped by human proportions; otherwise by bone lengths
  double volume = 0;        // enclosed by the mesh, cubic metres
  double stature = 0;       // metres, see roles/body_frame.h; 0 unless human
  std::string pose;         // "reference", "reference, limbs turned aside", "frame 12", ...
  Diagnostics diagnostics;  // notes and warnings
};

// Builds a body around the clip's skeleton, which may have any shape and size, including a single
// joint, coincident joints and zero-length bones. A human (see find_roles) is shaped by published
// body measurements scaled to its bones (human_shape.h), any other skeleton by the lengths of its
// bones and of their descendants (general_shape.h).
//
// Codes: those of check(Clip); body-frame for a frame outside the clip; body-joints for more than
// 2,000 joints; body-size for a skeleton so large or small that
// coordinates overflow.
Result<Body> make_body(const Clip& clip, const BodyOptions& options = {});

// As above, without frames to choose from.
Result<Body> make_body(const Skeleton& skeleton, const BodyOptions& options = {});

// Bodies for takes that do not fit in memory.

// As of a clip with these frames, of which a few are read. Errors are those of the source, too.
Result<Body> make_body(const FrameSource& source, const BodyOptions& options = {});

}  // namespace krok
