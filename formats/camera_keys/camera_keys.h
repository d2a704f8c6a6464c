#pragma once

#include <string_view>

#include "camera/keyed_camera.h"
#include "core/result.h"

// Keys of a camera as a text file that people write; formats/camera_keys/SPEC.md describes it.

namespace krok::camera_keys {

struct CameraKeyFile {
  KeyedCamera camera;
  double rate = 30;  // frames a second
};

// In metres and radians, whatever the file is written in; make_track() takes what this gives. A
// file of another program than a person's may hold anything; nothing that it holds is trusted.
// Codes, each with line and column: json-syntax, json-limit, camera-keys-structure,
// camera-keys-value, camera-keys-time.
Result<CameraKeyFile> read(std::string_view text);

}  // namespace krok::camera_keys
