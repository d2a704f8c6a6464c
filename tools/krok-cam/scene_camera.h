#pragma once

#include <optional>
#include <string>

#include "core/file.h"
#include "core/result.h"
#include "scene/camera_track.h"
#include "tools/cli/tool.h"

namespace krok::cli::cam {

// A camera of a glTF file in the animation that moves it most (nodes::camera_count), at the
// rate of the keys or at `rate`; one frame if no animation does. `wanted` as in choose_camera.
// Codes: cam-missing, import-camera, and those of reading and sampling.
Result<CameraTrack> read_scene_camera(const InputFile& file, const std::string& wanted,
                                      std::optional<double> rate, ToolContext& context);

}  // namespace krok::cli::cam
