#pragma once

#include <assimp/IOStream.hpp>
#include <assimp/IOSystem.hpp>

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/result.h"
#include "formats/assimp/assimp_reader.h"
#include "formats/registry/registry.h"
#include "nodes/scene.h"

namespace krok::assimp {

// Assimp's view of the file system: a few named blocks of memory.

struct MemoryFile {
  std::string name;  // without a folder
  std::span<const std::byte> bytes;
};

// Files are found by base name, ignoring case and folder. Read-only.
class MemoryFiles : public Assimp::IOSystem {
 public:
  explicit MemoryFiles(std::vector<MemoryFile> files) : files_(std::move(files)) {}

  bool Exists(const char* path) const override;
  char getOsSeparator() const override { return '/'; }
  Assimp::IOStream* Open(const char* path, const char* mode) override;
  void Close(Assimp::IOStream* stream) override;
  bool CreateDirectory(const std::string&) override { return false; }
  bool ChangeDirectory(const std::string&) override { return false; }
  bool DeleteFile(const std::string&) override { return false; }

 private:
  const MemoryFile* find(const char* path) const;
  std::vector<MemoryFile> files_;
};

// Runs Assimp and the conversion in this process, without limits; read_file() calls it in the child
// process. The first file is the one to read, the others its companions; names have the extension
// of their kind.
Result<nodes::Scene> run_assimp(std::vector<MemoryFile> files, registry::Kind kind,
                                const ReadOptions& options);

// Modifies files to work around bugs of Assimp 5.2 that would otherwise go unnoticed.

// The text that Assimp reads instead, or an empty string if no change is needed. Code:
// assimp-refused for a faulty file that Assimp would accept.
Result<std::string> mend_input(registry::Kind kind, std::string_view text);

// UTF-16 text (by its byte-order mark) as UTF-8, up to what is not valid; empty if it is none.
// Assimp 5.2 leaves such text as it is.
std::string utf8_of(std::string_view text);

// The joints of an .md5mesh or .md5anim, one line each with name and parent; to check whether two
// files match.
std::string md5_joints(std::string_view text);

// Reads what Assimp 5.2 reads incorrectly from MilkShape files. Source: M. Ciragan, "MilkShape 3D
// 1.8.5 File Format Specification".

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
