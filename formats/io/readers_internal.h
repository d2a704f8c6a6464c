#pragma once

#include "formats/io/formats.h"

// The functions of the table of formats.

namespace krok::io {

Result<Clip> read_anim(const InputFile& file, Inputs& inputs, const MotionOptions& options);

// That the first frame looks like a rest pose becomes a note.
void rest_frame_as_note(Diagnostics& found);

// With `stream`, frames are read when asked for, if format and file allow it.
Result<OpenedCapture> open_bvh(const InputFile& file, Inputs& inputs, const CaptureReading& reading,
                               bool stream);
Result<OpenedCapture> open_amc(const InputFile& file, Inputs& inputs, const CaptureReading& reading,
                               bool stream);
Result<OpenedCapture> open_asf(const InputFile& file, Inputs& inputs, const CaptureReading& reading,
                               bool stream);

Result<nodes::Scene> read_gltf(const InputFile& file, Inputs& inputs, bool with_materials);
// The one glTF scene in a ZIP archive. Codes: those of zip::Archive and gltf::read, zip-scene.
Result<nodes::Scene> read_zipped_gltf(const InputFile& file, Inputs& inputs, bool with_materials);
Result<nodes::Scene> read_through_assimp(const InputFile& file, Inputs& inputs,
                                         bool with_materials);

Result<Actor> read_model(const InputFile& file, Inputs& inputs);
Result<Actor> read_character(const InputFile& file, Inputs& inputs);
Result<Actor> read_camera(const InputFile& file, Inputs& inputs);

// The character of a scene. Without animations it has no motion.
Result<Actor> read_scene_actor(const Format& format, const InputFile& file, Inputs& inputs,
                               const ActorOptions& options);

}  // namespace krok::io
