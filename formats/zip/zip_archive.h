#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
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

  // Gives the next bytes of a file, as many as are asked for; asked for none, checks that the file
  // ends there and has its checksum. Valid as long as the archive is; all streams of an archive are
  // used by one thread at a time. Codes file-missing, file-too-large, by what the archive says, and
  // zip-damaged.
  using Stream = std::function<Status(std::span<std::byte> bytes)>;
  Result<Stream> stream(const std::string& name, std::uint64_t most_bytes) const;

 private:
  struct Handle;
  explicit Archive(std::unique_ptr<Handle> handle);
  std::unique_ptr<Handle> handle_;
  std::vector<std::string> names_;
};

// A file whose bytes are made as they are packed.
struct FileToPack {
  std::string name;
  std::uint64_t size = 0;
  std::function<Status(std::span<std::byte> bytes)> read;  // gives the next bytes, as many
};

// The bytes of an archive of files; the same for the same files, as all have the date of
// 1980-01-01. Errors are those of reading, and zip-damaged if libzip fails.
Result<std::vector<std::byte>> pack(std::span<const FileToPack> files);
// The same, written as it is packed. Errors are those of `file` as well.
Status pack(std::span<const FileToPack> files, OutputFile& file);

}  // namespace krok::zip
