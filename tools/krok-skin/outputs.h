#pragma once

#include "core/result.h"
#include "skin/skin.h"
#include "tools/common/tool.h"
#include "tools/krok-skin/subject.h"

// The files that krok-skin writes. The kind is told by the name of the output.

namespace krok::skinning {

// Whether a file of this name can hold what is wanted. Codes skin-format, skin-output.
Status check_output(As as, const std::string& output);

// One mesh, at a moment in seconds.
Status write_pose(const Subject& subject, const SkinBinding& binding, double seconds,
                  ToolContext& context);

// The whole motion as a mesh that changes. Codes skin-no-frames, skin-clip-too-long.
Status write_clip(const Subject& subject, const SkinBinding& binding, pc2::Up up,
                  ToolContext& context);

// Joints, weights and tracks.
Status write_rig(const Subject& subject, ToolContext& context);

// A file a frame, several at a time; all of them appear or none. Gives their names for people:
// "walk_0000.glb to walk_0119.glb".
Result<std::string> write_frames(const Subject& subject, const SkinBinding& binding,
                                 ToolContext& context);

}  // namespace krok::skinning
