#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "formats/registry/format_table.h"

// Identifies the format of a file from its first bytes and its name. Does not open or parse files.

namespace krok::registry {

// What formats are known, in the order of the table.
enum class Kind : unsigned char {
  unknown,
#define KROK_KIND(kind, ...) kind,
  KROK_FORMATS(KROK_KIND)
#undef KROK_KIND
};

// The first bytes of Krok's binary formats; formats/container has the rest of the header.
using Magic = std::array<char, 8>;
inline constexpr Magic kAnimMagic = {'K', 'R', 'O', 'K', 'A', 'N', 'I', 'M'};
inline constexpr Magic kModelMagic = {'K', 'R', 'O', 'K', 'M', 'O', 'D', 'L'};
inline constexpr Magic kCamMagic = {'K', 'R', 'O', 'K', 'C', 'A', 'M', 'R'};
inline constexpr Magic kStepsMagic = {'K', 'R', 'O', 'K', 'S', 'T', 'E', 'P'};

// All file extensions of a kind, with the dot: ".anim", ".kanim". None for Kind::unknown.
std::vector<std::string> endings_of(Kind kind);

// The first file extension of a kind, without the dot: "anim", "dae", "3ds" and so on; or
// "unknown".
std::string_view kind_name(Kind kind);

// Whether such files are read through Assimp: FBX, COLLADA, SMD, MS3D, 3DS, ASE, MD5.
bool is_read_through_assimp(Kind kind);

// The kind by content, independent of the name. Acclaim: by the first section, such as :version or
// :fully-specified, after comments. JSON: Krok files by the schema in the first 64 KiB, glTF by an
// "asset" key in the first or last 64 KiB. COLLADA: by the root element. SMD: by "version" and
// "nodes". MD5: by the version and the count keywords.
Kind kind_of_content(std::span<const std::byte> content);

// The kind by file extension, case-insensitive.
Kind kind_of_name(const std::string& path);

// The kind by content, or by name if the content is unknown.
Kind identify(const std::string& path, std::span<const std::byte> content);

inline constexpr std::string_view kUnknownText = "a text file of unknown kind";

// Describes a file by its content, for messages: "a BVH text file", "an empty file", "a PNG image",
// "a binary file of unknown kind". Includes some kinds that Krok does not read.
std::string_view describe_content(std::span<const std::byte> content);

// A hint for a file of kind `found` where kind `wanted` is expected: "import it with krok-import".
// Empty if there is none.
std::string advice(Kind found, Kind wanted);

}  // namespace krok::registry
