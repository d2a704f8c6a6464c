#pragma once

#include <type_traits>

#include "formats/cam/cam.h"
#include "formats/io/formats.h"
#include "formats/model/model_format.h"

// The functions of the table of formats.

namespace krok::io {

// What the reader of a format makes of the bytes of a file, or of its text and name.
template <auto read>
auto content_of(const InputFile& file) {
  const auto call = [&] {
    if constexpr (std::is_invocable_v<decltype(read), std::string_view, const std::string&>) {
      return read(file.text(), file.path());
    } else {
      return read(file.bytes());
    }
  };
  auto content = call();
  if (!content) content = std::move(content.error()).in_file(file.path());
  return content;
}

// For readers of a Clip.
template <auto read>
Result<Clip> motion_of(const InputFile& file, Inputs& /*inputs*/,
                       const MotionOptions& /*options*/) {
  return content_of<read>(file);
}

// For readers of a Model or a CameraTrack.
template <auto read>
Result<Actor> actor_of(const InputFile& file, Inputs& /*inputs*/) {
  auto content = content_of<read>(file);
  if (!content) return content.error();
  Actor actor;
  if constexpr (std::is_same_v<decltype(content), Result<CameraTrack>>) {
    actor.cameras.push_back({"", *std::move(content)});
  } else {
    actor.model = *std::move(content);
  }
  return actor;
}

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

// Arrays of numpy. `reading.skeleton`: the name of a published order of joints, or a file: a list
// of columns (JSON), a model of SMPL, any motion. Codes: those of npy::read(), npy-skeleton.
Result<OpenedCapture> open_arrays(const InputFile& file, Inputs& inputs,
                                  const CaptureReading& reading, bool stream);
// An Error for choices that only BVH has.
Status check_bvh_choices(const CaptureReading& reading);

Result<nodes::Scene> read_gltf(const InputFile& file, Inputs& inputs, bool with_materials);
// The one glTF scene in a ZIP archive. Codes: those of zip::Archive and gltf::read, zip-scene.
Result<nodes::Scene> read_zipped_gltf(const InputFile& file, Inputs& inputs, bool with_materials);
Result<nodes::Scene> read_through_assimp(const InputFile& file, Inputs& inputs,
                                         bool with_materials);

Result<Actor> read_character(const InputFile& file, Inputs& inputs);

// The character of a scene. Without animations it has no motion.
Result<Actor> read_scene_actor(const Format& format, const InputFile& file, Inputs& inputs,
                               const ActorOptions& options);

}  // namespace krok::io
