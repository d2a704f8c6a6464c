#pragma once

#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/file.h"
#include "core/result.h"
#include "scene/material.h"

// Materials as a text file that tools write and people edit, .material; SPEC.md describes it.

namespace krok::material {

// The file's materials, which pass check(); their pictures have paths and no bytes yet, and those
// of one path are one. Paths are relative, without a step up; whether a link leads out of the
// folder is for whoever opens them (core/path_inside.h). Codes, each with line and column:
// json-syntax, json-limit, material-structure, material-value, material-name, material-path.
Result<std::vector<Material>> read(std::string_view text);

// The file's text; each picture must have a path that read() takes. The same materials give the
// same bytes, and what was written reads back the same. Codes: those of check(), material-path.
Result<std::string> write(std::span<const Material> materials);

// Fills in the bytes of all pictures, each of which `open` is asked for once, in the order of the
// materials. Codes: those of `open` and of picture_facts, with the picture's file.
using OpenImage = std::function<Result<InputFile>(const std::string& path)>;
Status load_images(std::span<Material> materials, const OpenImage& open);

}  // namespace krok::material
