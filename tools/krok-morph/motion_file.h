#pragma once

#include <string>

#include "core/result.h"
#include "scene/mesh_motion.h"
#include "scene/model.h"
#include "scene/morph_set.h"
#include "tools/cli/output_set.h"
#include "tools/cli/tool.h"

namespace krok::cli::morph {

// Output format of an animated mesh, by extension.
enum class MotionFormat { glb, gltf, pc2, exr };

// An Error (code morph-format) for other extensions; `exr`: whether .exr is allowed.
Result<MotionFormat> motion_format(const std::string& path, bool exr);

// Adds the motion as baked shapes to the outputs: glTF or a PC2 point cache. An Error (code
// morph-clip-too-long) for glTF beyond the limits of viewers.
Status add_baked(const Model& model, const MeshMotion& motion, MotionFormat format,
                 OutputSet& outputs, ToolContext& context);

// Adds glTF with morph targets and weight keys, one per frame.
Status add_targets(const Model& model, const MorphSet& morphs, const MorphWeights& weights,
                   MotionFormat format, OutputSet& outputs, ToolContext& context);

}  // namespace krok::cli::morph
