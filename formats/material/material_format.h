#pragma once

#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/file.h"
#include "core/result.h"
#include "scene/material.h"

// Reads and writes .material files, a text format that can be edited by hand; see SPEC.md.

namespace krok::material {

// The file's materials, which pass check(). Images have paths but no bytes yet; images with the
// same path are shared. Paths are relative, without "..". Whoever opens them must check for links
// that leave the folder (core/path_inside.h). Codes, each with line and column:
// json-syntax, json-limit, material-structure, material-value, material-name, material-path.
Result<std::vector<Material>> read(std::string_view text);

// The file's text; each image must have a path that read() accepts. Output is deterministic and
// reads back the same. Codes: those of check(), material-path.
Result<std::string> write(std::span<const Material> materials);

// Fills in the bytes of all images. Calls `open` once per image, in the order of the materials.
// Codes: those of `open` and of image_info, with the image's file.
using OpenImage = std::function<Result<InputFile>(const std::string& path)>;
Status load_images(std::span<Material> materials, const OpenImage& open);

// The JSON Schema of such files.
std::string schema();

}  // namespace krok::material
