#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/result.h"
#include "formats/gltf/gltf_reader.h"
#include "scene/camera_track.h"

namespace krok::gltf {

struct CameraOptions {
  std::string name = "camera";   // of camera and node; the node's gets a suffix if it is taken
  std::optional<double> aspect;  // width / height, > 0; if not set, viewers use their window's
  double near_plane = 0.05;      // metres, > 0; the far plane is at infinity
  // Name of the animation that gets the camera's keys, or its number from 0; empty: the first.
  std::string animation;
};

struct WithCamera {
  std::vector<std::byte> bytes;    // a GLB
  std::vector<std::string> files;  // other files that were read
  Diagnostics diagnostics;
};

// Adds a camera to a glTF file: a root node of the default scene, with one key per frame in the
// file's animation, or in a new one if it has none. A track of one frame gives a static camera. If
// there are several animations and none is chosen, a warning names the one used (code
// gltf-animations). The rest of the file is unchanged, except that pack_glb merges buffers and
// images into one buffer.
//
// Core glTF cannot animate the field of view: viewers show the first frame's. If the track's
// changes, there is a warning (code gltf-lens), and the values are stored in the camera's extras,
// where read() finds them: {"fieldsOfView": {"rate": 30, "values": [radians, ...]}}.
//
// Codes: those of read(); those of check(CameraTrack); camera-shape for a track without frames;
// gltf-animation for an animation that does not exist; gltf-times, gltf-too-large, gltf-value
// (options out of range).
Result<WithCamera> add_camera(std::span<const std::byte> gltf, const CameraTrack& track,
                              const CameraOptions& options, const ReadOptions& reading);

// A GLB with only the camera. Both functions store the track's provenance in the camera's extras.
Result<WithCamera> camera_alone(const CameraTrack& track, const CameraOptions& options);

}  // namespace krok::gltf
