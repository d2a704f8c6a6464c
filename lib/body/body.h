#pragma once

#include <string>

#include "core/progress.h"
#include "core/result.h"
#include "scene/clip.h"
#include "scene/model.h"

namespace krok {

// Roughly 2,500, 10,000 and 40,000 vertices for a human figure.
enum class BodyDetail { low, medium, high };

// In which pose the body is built; it becomes the model's reference pose. `automatic` is the
// skeleton's reference pose, with limbs that a body cannot be built around (folded, hanging against
// the trunk, crossing) turned aside; where that pose is no pose at all (all bones along one axis),
// the frame of the clip that needs the least of that.
enum class BodyPose { automatic, reference, frame };

struct BodyOptions {
  BodyDetail detail = BodyDetail::medium;
  BodyPose pose = BodyPose::automatic;
  int frame = 0;  // for BodyPose::frame
  int jobs = 0;   // threads, see parallel.h; the result does not depend on it
  Progress* progress = nullptr;
};

struct Body {
  // One part, "body", of material "body". The mesh is one closed, oriented 2-manifold without
  // handles (a topological sphere) or duplicated vertices; normals point out. Four influences a
  // vertex. Texture coordinates lie in [0, 1]: u runs around a limb from its front (0) to its back
  // (1), the same on the left and on the right, so that no seam is needed; v is the distance from
  // the root along the bones, 0 at the root and 1 at the farthest tip.
  Model model;
  bool human = false;       // shaped by human proportions; otherwise by the lengths of the bones
  double volume = 0;        // cubic metres enclosed by the mesh
  double stature = 0;       // metres, estimated from the bones; 0 unless human
  std::string pose;         // "reference", "reference, limbs turned aside", "frame 12", ...
  Diagnostics diagnostics;  // notes and warnings
};

// Builds a body around the clip's skeleton, which may have any shape and size: no joint but one,
// all joints in one point, bones of no length. A human (see find_roles) is shaped by published body
// measurements scaled to its bones (human_shape.h), any other figure by the lengths of its bones
// and of what hangs on them (general_shape.h).
//
// Codes: those of check(Clip); body-frame for a frame that the clip does not have; body-joints for
// more joints than a model's influences can name (65,536); body-size for a figure so large or small
// that its coordinates overflow.
Result<Body> make_body(const Clip& clip, const BodyOptions& options = {});

// The same without frames to choose from.
Result<Body> make_body(const Skeleton& skeleton, const BodyOptions& options = {});

}  // namespace krok
