#pragma once

#include <cstdint>
#include <string>

#include "core/result.h"
#include "nodes/scene.h"

// Characters, motions and cameras from other programs' files, read by the Assimp library: FBX,
// COLLADA (.dae), Valve SMD, MilkShape MS3D, 3DS, ASE, Doom 3's MD5mesh and MD5anim.
//
// Assimp is not made for strangers' files: it runs in a child process with limits (see
// core/child_process.h) that can open nothing and sees no other bytes than those of the file and
// its companions. What comes back is checked as if it were a stranger's too.
//
// Codes of errors: those of InputFile; assimp-refused (Assimp says what is wrong with the file),
// assimp-crash, assimp-time, assimp-memory (it died of the file, or was stopped at a limit),
// assimp-result (it came back with nonsense), assimp-start (no child process could be started),
// assimp-kind (not one of these formats), assimp-empty (nothing that Krok uses is in it).
// Of notes and warnings: assimp-*, each with what to know about the file.

namespace krok::assimp {

struct ReadOptions {
  // Of formats that count frames without saying how fast they are (SMD); 30 is studiomdl's own.
  double frames_per_second = 30;
  double most_seconds = 120;
  // Memory that Assimp may take: this, and this many times the size of the file.
  std::uint64_t most_bytes = std::uint64_t{512} << 20;
  double most_expansion = 64;
  std::uint64_t most_file_bytes = std::uint64_t{1} << 31;  // Assimp counts bytes in 32 bits
  // Scene::materials too, as far as Assimp tells of them: colours, alpha, textures. Pictures are
  // those in the file (FBX) or files in its folder tree, looked for under the path that the file
  // names and under the base name alone. One that is not found, or is neither PNG nor JPEG, is left
  // out with a warning (assimp-picture).
  bool with_materials = false;
};

// What a scene is: nodes with the file's names, each of Assimp's meshes a primitive at its node
// with up to 8 influences a vertex (more: the largest are kept and it is said), bones as skins,
// animations with their keys at the file's own times (seconds). FBX's pivots are folded into their
// node. Texture coordinates are glTF's, v down. Tangents where the file has them (FBX, COLLADA),
// with glTF's side. Scene::space has what the file says, Scene::files the companions that were
// read.
//
// MD5: `x.md5mesh` comes with the motion `x.md5anim` beside it; a given `x.md5anim` with the mesh
// `x.md5mesh`, or with the only one in its folder whose joints are the same; without one it is a
// skeleton that moves. SMD: an SMD without triangles is a skeleton that moves; the motions that
// `x_animation.txt` names for `x.smd` come with it.
Result<nodes::Scene> read_file(const std::string& path, const ReadOptions& options = {});

}  // namespace krok::assimp
