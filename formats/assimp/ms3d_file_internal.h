#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

// What Assimp 5.2 reads wrong in MilkShape files, read from the bytes themselves. The format:
// M. Ciragan, "MilkShape 3D 1.8.5 File Format Specification".

namespace krok::assimp {

struct Ms3dInfluence {
  int joint = 0;
  float weight = 0;
};

struct Ms3dFile {
  std::vector<std::string> joints;
  // [groups][corners of its triangles]: that is how Assimp has meshes and vertices.
  std::vector<std::vector<std::vector<Ms3dInfluence>>> influences;
  std::size_t end_of_joints = 0;  // byte; what follows are comments and the vertices' weights
  std::size_t place_of_rate = 0;  // byte of the float that says the frames a second
  float rate = 0;
};

// Nothing where the file is not as the format has it; Assimp will say what is wrong.
std::optional<Ms3dFile> read_ms3d(std::span<const std::byte> bytes);

}  // namespace krok::assimp
