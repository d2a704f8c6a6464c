#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

// Reads what Assimp 5.2 reads incorrectly from MilkShape files. Source: M. Ciragan, "MilkShape 3D
// 1.8.5 File Format Specification".

namespace krok::assimp {

struct Ms3dInfluence {
  int joint = 0;
  float weight = 0;
};

struct Ms3dFile {
  std::vector<std::string> joints;
  // [groups][triangle corners][influences], matching Assimp's meshes and vertices.
  std::vector<std::vector<std::vector<Ms3dInfluence>>> influences;
  std::size_t end_of_joints = 0;  // byte offset; comments and vertex weights follow
  std::size_t place_of_rate = 0;  // byte offset of the frame rate
  float rate = 0;                 // frames per second
};

// nullopt if the file is invalid; Assimp then reports the error.
std::optional<Ms3dFile> read_ms3d(std::span<const std::byte> bytes);

}  // namespace krok::assimp
