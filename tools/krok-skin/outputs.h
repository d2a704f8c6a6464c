#pragma once

#include "core/result.h"
#include "skin/skin.h"
#include "tools/cli/tool.h"
#include "tools/krok-skin/subject.h"

// The files that krok-skin writes. The output's extension determines the kind.

namespace krok::cli::skin {

// Checks that the output's format can hold this kind of output. Codes skin-format, skin-output.
Status check_output(As as, const std::string& output);

// One mesh, at a time in seconds.
Status write_pose(const Subject& subject, const SkinBinding& binding, double seconds,
                  ToolContext& context);

// The whole motion as an animated mesh; says how large it is if it is over 50 MB. Codes
// skin-no-frames, skin-clip-too-long.
Status write_baked(const Subject& subject, const SkinBinding& binding, pc2::Up up,
                   ToolContext& context);

// Joints, weights and the animations of all motions. False if the error is larger than --reduce
// allows.
Result<bool> write_rig(const Options& options, const Subject& subject, ToolContext& context);

// The same without the mesh.
Status write_motion(const Subject& subject, ToolContext& context);

// One file per frame, written in parallel; all appear or none. Returns their names for display:
// "walk_0000.glb to walk_0119.glb".
Result<std::string> write_frames(const Subject& subject, const SkinBinding& binding,
                                 ToolContext& context);

}  // namespace krok::cli::skin
