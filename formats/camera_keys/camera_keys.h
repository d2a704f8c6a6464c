#pragma once

#include <string>
#include <string_view>

#include "camera/keyed_camera.h"
#include "core/result.h"

// Reader for camera keys (JSON, hand-written); see formats/camera_keys/SPEC.md.

namespace krok::camera_keys {

struct CameraKeyFile {
  KeyedCamera camera;
  double rate = 30;  // frames per second
};

// The result is in metres and radians, whatever the units of the file, and valid for make_track().
// Safe for untrusted input. Codes, each with line and column: json-syntax, json-limit,
// camera-keys-structure, camera-keys-value, camera-keys-time.
Result<CameraKeyFile> read(std::string_view text);

// The JSON Schema of such files.
std::string schema();

}  // namespace krok::camera_keys
