#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "formats/io/inputs.h"
#include "formats/io/open_capture.h"
#include "formats/io/open_character.h"
#include "formats/io/open_motion.h"
#include "formats/registry/registry.h"
#include "nodes/scene.h"
#include "scene/clip.h"

// What can be read and how: the rows of formats/registry/format_table.h, and what a program adds.
// open_motion(), open_scene() and open_actor() choose by it.

namespace krok::io {

struct Format {
  registry::Kind kind = registry::Kind::unknown;

  // For formats without a kind in formats/registry: the ending, in lower case without a dot, and
  // whether a file's bytes are such. A known kind goes before. For motions: tools ask by kind
  // whether a file is a scene or a model.
  std::string_view ending = {};
  bool (*recognises)(std::span<const std::byte> content) = nullptr;

  // Null for what the format cannot hold. The file is open already and of this kind.
  Result<Clip> (*read_motion)(const InputFile& file, Inputs& inputs,
                              const MotionOptions& options) = nullptr;
  // For captures instead of read_motion, where there are conventions to find (krok-import --unit
  // and so on). With `stream`, frames are read when asked for, if format and file allow it.
  Result<OpenedCapture> (*open_capture)(const InputFile& file, Inputs& inputs,
                                        const CaptureReading& reading, bool stream) = nullptr;
  Result<nodes::Scene> (*read_scene)(const InputFile& file, Inputs& inputs,
                                     bool with_materials) = nullptr;
  Result<Actor> (*read_actor)(const InputFile& file, Inputs& inputs) = nullptr;

  // A skeleton or mesh that is read with the motion beside it, and is none itself.
  bool companion = false;

  bool reads_motion() const {
    return !companion &&
           (read_motion != nullptr || open_capture != nullptr || read_scene != nullptr);
  }
};

std::span<const Format> formats();

// Adds a row for a program's own format, with an ending. Not while files are being opened.
void add_format(const Format& format);

// The row of a kind; one without any function for kinds that are not in the table.
const Format& format_of(registry::Kind kind);

// The format of an open file, by its content, else by its name.
const Format& format_of(const InputFile& file);

// Whether the file holds a motion alone: false for scenes, which open_motion() reads as well, and
// for a skeleton without a motion.
bool is_motion(const InputFile& file);

// The endings of the formats for which `wanted` is true, with the dot.
std::vector<std::string> endings(bool (*wanted)(const Format& format));

// ".anim", ".bvh" and so on: what tools that read motions look for in folders.
std::vector<std::string> motion_endings();
// The same without Krok's own: what krok-import looks for.
std::vector<std::string> foreign_motion_endings();

}  // namespace krok::io
