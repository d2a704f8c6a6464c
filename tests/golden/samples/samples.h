#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "core/file.h"
#include "formats/container/packed_orientation.h"
#include "formats/steps/steps.h"
#include "scene/camera_track.h"
#include "scene/character.h"
#include "scene/clip.h"
#include "scene/material.h"
#include "scene/model.h"
#include "scene/stretch.h"

// Tiny scenes that use every feature of the formats, with values that are exact in floats or chosen
// to be awkward. The frozen files under tests/golden/v1 hold them.

namespace krok::samples {

// Three joints, the last an end site; a name in UTF-8 with a space; two frames, 29.97 a second; w
// positive, negative, zero and tiny; a provenance with every field.
Clip clip();

// Of clip(): its second joint is scaled, sheared and mirrored, the others are rigid.
Stretches stretches();

// Bound to the skeleton of clip(): four vertices with normals, texture coordinates and tangents,
// three influences each, two triangles in two parts.
Model model();

// The same without normals, texture coordinates and tangents, one influence a vertex, one part.
Model plain_model();

// With colours and three sets of texture coordinates.
Model coloured_model();

// Two frames, 25 a second.
CameraTrack camera();

// Two examples on the skeleton of clip(), one parameter, contacts, a report; weights by B-splines
// with one inserted point, chosen so that they are exact.
steps::StepsFile step_library();

// The same with three parameters, of a joint, a turn and a duration, and no weights or report.
steps::StepsFile unfitted_library();

// Every key, with textures that share a picture, and one with none.
std::vector<Material> materials();

// For model(), with every key.
Character character();

// A file of the frozen set: its name and how it is written.
struct Sample {
  std::string file_name;
  std::function<Status(OutputFile&)> write;
};
std::vector<Sample> all();    // that are binary
std::vector<Sample> texts();  // the others

// The bytes that `write` puts into a file.
std::vector<std::byte> bytes_of(const std::function<Status(OutputFile&)>& write);
std::vector<std::byte> bytes_of(const Clip& clip, OrientationEncoding encoding = {});
std::vector<std::byte> bytes_of(const Model& model, OrientationEncoding encoding = {});
std::vector<std::byte> bytes_of(const CameraTrack& camera, OrientationEncoding encoding = {});
std::vector<std::byte> bytes_of(const steps::StepsFile& steps, OrientationEncoding encoding = {});

// The same bytes with the file's size and checksum made right again, so that a reader gets past
// them to what a test has changed.
void repair_header(std::vector<std::byte>& file);

}  // namespace krok::samples
