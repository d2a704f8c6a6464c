#pragma once

#include <assimp/IOStream.hpp>
#include <assimp/IOSystem.hpp>
#include <cstddef>
#include <span>
#include <string>
#include <vector>

// Assimp's view of the file system: a few named blocks of memory.

namespace krok::assimp {

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

}  // namespace krok::assimp
