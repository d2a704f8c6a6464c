#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "core/file.h"
#include "core/result.h"

// ZIP archives in memory, with libzip: scenes with their textures, as shops hand them out, and
// archives of arrays.

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

// The bytes of an archive of files, by path and content; the same for the same files, as all have
// the date of 1980-01-01. Code: zip-damaged if libzip fails.
Result<std::vector<std::byte>> pack(
    std::span<const std::pair<std::string, std::vector<std::byte>>> files);

// A file whose bytes are elsewhere, in parts that follow each other.
struct FileInParts {
  std::string name;
  std::vector<std::span<const std::byte>> parts;
};
// The same, written as it is packed. Errors are those of `file` as well.
Status pack(std::span<const FileInParts> files, OutputFile& file);

}  // namespace krok::zip
