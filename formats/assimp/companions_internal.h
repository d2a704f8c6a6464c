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

// The other files of a folder that belong to a given one, opened; and what to say about them.
struct Companions {
  struct Entry {
    std::string name;  // as Assimp will ask for it, without a folder
    InputFile file;
    std::string text;  // what Assimp is given in place of the file's own, where not empty

    std::span<const std::byte> bytes() const {
      return text.empty() ? file.bytes() : std::as_bytes(std::span(text));
    }
  };
  std::vector<Entry> files;
  Diagnostics diagnostics;
};

// MD5: the mesh of a motion and the motion of a mesh. SMD: the list of motions and what it names.
// Assimp will know the given file as `file.<kind>`. Files lie in the folder of `path` or under it;
// others are left out with a warning, as are those of more than `most_bytes`.
Companions find_companions(const std::string& path, registry::Kind kind, std::string_view text,
                           std::uint64_t most_bytes);

}  // namespace krok::assimp
