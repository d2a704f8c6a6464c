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
  std::string name = "camera";   // of the node and of the camera; a number is added where it stands
  std::optional<double> aspect;  // width by height, > 0; without it viewers take their window's
  double near_plane = 0.05;      // metres, > 0; there is no far plane
  // Of several animations in the file, which the camera moves in; the first if not said.
  std::optional<int> animation;
};

struct WithCamera {
  std::vector<std::byte> bytes;    // a GLB
  std::vector<std::string> files;  // that were read besides
  Diagnostics diagnostics;
};

// A glTF file with a camera more: a node at the root of the scene that is shown, with a key at the
// time of each frame in the animation that the file has, or in one of its own where it has none. A
// track of one frame is a camera that stands still. Where there are several animations and none was
// asked for, a warning says which it is (code gltf-animations). All else stays as it is, but for
// buffers and images, which become one buffer, as pack_glb does it.
//
// Core glTF has no lens that changes over time: viewers show the first frame's. Where the track's
// changes, a warning says so (code gltf-lens), and the values stand in the camera's extras, where
// read() finds them: {"fieldsOfView": {"rate": 30, "values": [radians, ...]}}.
//
// Codes: those of read(); those of check(CameraTrack); camera-shape for a track without frames;
// gltf-animation for an animation that does not exist; gltf-times, gltf-too-large, gltf-value
// (options out of range).
Result<WithCamera> add_camera(std::span<const std::byte> gltf, const CameraTrack& track,
                              const CameraOptions& options, const ReadOptions& reading);

// A GLB with nothing but the camera. In both the track's provenance stands in the camera's extras.
Result<WithCamera> camera_alone(const CameraTrack& track, const CameraOptions& options);

}  // namespace krok::gltf
