#pragma once

#include <cstdint>
#include <string>

#include "core/child_process.h"
#include "core/result.h"
#include "nodes/scene.h"

// Imports characters, motions and cameras with the Assimp library: FBX, COLLADA (.dae), Valve SMD,
// MilkShape MS3D, 3DS, ASE, Doom 3's MD5mesh and MD5anim.
//
// Assimp is not safe for untrusted files. It runs in a sandboxed child process with limits (see
// core/child_process.h), which cannot open files and sees only the bytes of the file and its
// companions. Its result is not trusted either.
//
// Error codes: those of InputFile; assimp-refused (Assimp rejects the file), assimp-crash,
// assimp-time, assimp-memory (Assimp crashed or was stopped at a limit), assimp-result (invalid
// result), assimp-start (the child process could not be started), assimp-kind (not one of these
// formats), assimp-version (an FBX older than 7.1), assimp-empty (nothing that Krok uses). Notes
// and warnings have codes assimp-*.

namespace krok::assimp {

struct ReadOptions {
  // For formats that do not store the frame rate (SMD); 30 is the default of studiomdl.
  double frames_per_second = 30;
  // Assimp's limits: so much, and so much for each MiB or byte of the file and its companions.
  double most_seconds = 15, seconds_per_mebibyte = 5;
  std::uint64_t most_bytes = std::uint64_t{256} << 20;
  double most_expansion = 64;
  GivenLimits limits = {};                                 // instead of these
  std::uint64_t most_file_bytes = std::uint64_t{1} << 31;  // Assimp counts bytes in 32 bits
  // Also read Scene::materials, as far as Assimp provides them: colours, alpha, textures. Images
  // are embedded (FBX) or in the file's folder tree, found by the path in the file or by base name.
  // One that is not found, or is neither PNG nor JPEG, is left out with a warning (assimp-picture).
  bool with_materials = false;
};

// The scene has nodes with the file's names; each of Assimp's meshes as a primitive at its node,
// with up to 8 influences per vertex (if there are more, the largest are kept, with a warning);
// bones as skins; animations with keys at the file's times (seconds). FBX pivots are baked into
// their node. Texture coordinates follow glTF (v down), as does the sign of tangents, which are
// present if the file has them (FBX, COLLADA). Scene::space is what the file specifies,
// Scene::files lists the companions that were read.
//
// MD5: `x.md5mesh` is read with the motion `x.md5anim` from the same folder; `x.md5anim` with the
// mesh `x.md5mesh`, or with the only mesh in its folder that has the same joints, otherwise as an
// animated skeleton. SMD: without triangles it is an animated skeleton; `x.smd` is read with the
// motions listed in `x_animation.txt`.
Result<nodes::Scene> read_file(const std::string& path, const ReadOptions& options = {});

}  // namespace krok::assimp
