#pragma once

#include "formats/io/formats.h"

// The functions of the table of formats.

namespace krok::io {

Result<Clip> read_anim(const InputFile& file, Inputs& inputs, const MotionOptions& options);

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

Result<ShownModel> read_model(const InputFile& file, Inputs& inputs);
Result<ShownModel> read_character(const InputFile& file, Inputs& inputs);

}  // namespace krok::io
