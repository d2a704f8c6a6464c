#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "core/file.h"
#include "core/result.h"
#include "formats/registry/registry.h"

namespace krok::assimp {

// Opened companion files of a given file, with diagnostics.
struct Companions {
  struct Entry {
    std::string name;  // as Assimp will request it, without a folder
    InputFile file;
    std::string text;  // replaces the file's content for Assimp, unless empty

    std::span<const std::byte> bytes() const {
      return text.empty() ? file.bytes() : std::as_bytes(std::span(text));
    }
  };
  std::vector<Entry> files;
  Diagnostics diagnostics;
};

// MD5: the mesh of a motion, or the motion of a mesh. SMD: the list of motions and the motions.
// Assimp sees the given file as `file.<kind>`. Files outside the folder tree of `path` are left out
// with a warning, as are those larger than `most_bytes`.
Companions find_companions(const std::string& path, registry::Kind kind, std::string_view text,
                           std::uint64_t most_bytes);

}  // namespace krok::assimp
