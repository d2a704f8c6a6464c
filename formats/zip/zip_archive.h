#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/result.h"

// Reads ZIP archives from memory with libzip, as shops hand out scenes with their textures.

namespace krok::zip {

class Archive {
 public:
  // `bytes` must outlive the archive. Code: zip-damaged.
  static Result<Archive> open(std::span<const std::byte> bytes);

  Archive(Archive&&) noexcept;
  Archive& operator=(Archive&&) noexcept;
  ~Archive();

  // Paths of the files inside, without folders, in the archive's order; '/' separates.
  const std::vector<std::string>& names() const { return names_; }

  // The unpacked bytes of a file. Codes: file-missing, file-too-large (more than `most_bytes`, by
  // what the archive says or by what comes out), zip-damaged (also for encrypted files).
  Result<std::vector<std::byte>> read(const std::string& name, std::uint64_t most_bytes) const;

 private:
  struct Handle;
  explicit Archive(std::unique_ptr<Handle> handle);
  std::unique_ptr<Handle> handle_;
  std::vector<std::string> names_;
};

}  // namespace krok::zip
