#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <string>
#include <string_view>

// Which of the formats a file is in, from its first bytes and its name. Opens and parses nothing.

namespace krok::registry {

enum class Kind : unsigned char {
  unknown,
  // Krok's own
  anim,
  model,
  cam,
  steps,
  material,
  character,
  // captures
  bvh,
  asf,
  amc,
  pc2,  // a point cache
  // scenes: glTF, and what formats/assimp reads
  glb,
  gltf,
  fbx,
  collada,
  smd,
  ms3d,
  max_3ds,  // .3ds
  ase,
  md5mesh,
  md5anim,
};

// The first bytes of Krok's own binary formats; what follows them is in formats/container.
using Magic = std::array<char, 8>;
inline constexpr Magic kAnimMagic = {'K', 'R', 'O', 'K', 'A', 'N', 'I', 'M'};
inline constexpr Magic kModelMagic = {'K', 'R', 'O', 'K', 'M', 'O', 'D', 'L'};
inline constexpr Magic kCamMagic = {'K', 'R', 'O', 'K', 'C', 'A', 'M', 'R'};
inline constexpr Magic kStepsMagic = {'K', 'R', 'O', 'K', 'S', 'T', 'E', 'P'};

// The extension that files of this kind have, without its dot: "anim", "dae", "3ds" and so on;
// "unknown".
std::string_view kind_name(Kind kind);

// Whether such files are read through Assimp: FBX, COLLADA, SMD, MS3D, 3DS, ASE, MD5.
bool is_read_through_assimp(Kind kind);

// What the bytes show, whatever the file is called. Acclaim's files are known by their first
// section, such as :version or :fully-specified, after comments. Texts that begin with a brace:
// Krok's own by the schema in their first 64 KiB, glTF's by an "asset" key in the first or last
// 64 KiB. COLLADA by its root element, SMD by its version and nodes, MD5 by its version and what it
// counts.
Kind kind_of_content(std::span<const std::byte> content);

// What the name promises, by its extension in any case.
Kind kind_of_name(const std::string& path);

// The content's kind, or the name's where the content shows none.
Kind identify(const std::string& path, std::span<const std::byte> content);

inline constexpr std::string_view kUnknownText = "a text file of unknown kind";

// What a file seems to be, for a message: "a BVH text file", "an empty file", "a PNG picture",
// "a file of unknown kind". Knows some kinds that Krok does not read.
std::string_view describe_content(std::span<const std::byte> content);

// What to do with a file of this kind that was given where a file of kind `wanted` is expected:
// "import it with krok-import". Empty where nothing is known.
std::string advice(Kind found, Kind wanted);

}  // namespace krok::registry
