#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "core/result.h"

// Reads whole files and writes files atomically. Codes: file-missing, file-directory,
// file-unreadable, file-too-large, file-unwritable, file-exists.

namespace krok {

// The bytes of a file: memory-mapped if it is a large regular file, otherwise read into memory
// (small file, pipe, standard input). Views are valid as long as this object exists.
class InputFile {
 public:
  // Max bytes read from a pipe, a device or standard input.
  static constexpr std::uint64_t kStreamLimit = std::uint64_t{1} << 30;

  // "-" is standard input. A file larger than `limit` bytes is an error (code file-too-large);
  // streams are limited to kStreamLimit as well. An empty file is not an error.
  static Result<InputFile> open(const std::string& path,
                                std::uint64_t limit = std::uint64_t{64} << 30);

  InputFile(InputFile&&) noexcept;
  InputFile& operator=(InputFile&&) noexcept;
  ~InputFile();

  std::span<const std::byte> bytes() const;
  std::string_view text() const;
  const std::string& path() const { return path_; }

  // Which of the file's contents is meant, by name; empty: all, or what a reader takes by itself.
  const std::string& part() const { return part_; }
  void choose_part(std::string part) { part_ = std::move(part); }

  // The XXH3 checksum of the bytes. A mapped file is not held in memory as a whole.
  std::uint64_t checksum() const;

  // Releases the memory of a mapped file before `offset`. The bytes stay readable (they are paged
  // in again); meant for reading a long file front to back.
  void release_before(std::size_t offset) const;

 private:
  struct Content;
  InputFile(std::string path, std::unique_ptr<Content> content);
  std::string path_, part_;
  std::unique_ptr<Content> content_;
};

// An atomic output file: it appears complete or not at all. Bytes go to a temporary file in the
// folder of `path`; commit() flushes it to disk, which reports errors of delayed writes, and
// renames it, so that after a power failure either the old or the new file exists. Writeback starts
// early, which leaves little to wait for. If the object is destroyed before commit(), or a signal
// ends the program (see remove_temporaries_on_signals), the temporary file is removed and the
// existing file is kept. The result keeps the permissions of the file that it replaces; a symbolic
// link is kept and its target is replaced. "-" is standard output; a path that exists and is not a
// regular file (device, pipe) is written directly, since a rename would replace the device.
class OutputFile {
 public:
  struct Options {
    bool no_clobber = false;  // fail if the path exists (code file-exists)
    // Put a new file (one that replaces none) in place without waiting for the disk. For writing
    // many files: call store_files() once at the end. After a power failure, complete files must be
    // recognised by other means (a journal with checksums).
    bool stored_later = false;
  };

  static Result<OutputFile> create(const std::string& path, Options options);
  static Result<OutputFile> create(const std::string& path) { return create(path, Options()); }

  OutputFile(OutputFile&&) noexcept;
  OutputFile& operator=(OutputFile&&) noexcept;
  ~OutputFile();

  // Appends. The first failure is kept and returned by commit() too.
  Status write(std::span<const std::byte> bytes) { return write(std::span(&bytes, 1)); }
  Status write(std::string_view text) { return write(std::as_bytes(std::span(text))); }
  // Appends the parts in order. Large calls need the fewest copies.
  Status write(std::span<const std::span<const std::byte>> parts);

  // False for standard output, devices and pipes.
  bool can_overwrite() const;

  // Overwrites bytes already written, such as a header that is known last. An Error for standard
  // output, devices and pipes (code file-unwritable).
  Status overwrite(std::uint64_t offset, std::span<const std::byte> bytes);

  std::uint64_t size() const;

  // Ends writing: flushes to disk and frees the file descriptor, so that any number of files can
  // wait to be put in place. Nothing can be written afterwards.
  Status seal();

  // The path where the bytes of a sealed file can be read until it is put in place.
  const std::string& written_at() const;

  // Seals the file and puts it in place.
  Status commit();

  // Commits files that belong together: all of them appear or none. None is put in place before all
  // are sealed; if one fails, those before it are rolled back. Replaced files are restored too if
  // the file system can exchange names (Linux file systems can). Output to a stream cannot be
  // rolled back.
  static Status place_all(std::span<OutputFile> files);

 private:
  struct State;
  explicit OutputFile(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

// Waits until everything written to the file system of `folder` is on disk.
Status store_files(const std::string& folder);

// Writes `bytes` to `path` through an OutputFile.
Status write_file(const std::string& path, std::span<const std::byte> bytes,
                  OutputFile::Options options = {});
Status write_file(const std::string& path, std::string_view text, OutputFile::Options options = {});

// Installs signal handlers that remove the temporary files of all live OutputFiles and then end the
// program by the same signal: termination requests (SIGINT, SIGTERM, SIGHUP, ...), resource limits
// and crashes. Signals that are ignored (nohup) or already handled are left alone. SIGXFSZ is
// ignored, so that exceeding the file size limit becomes an Error (code file-unwritable). Programs
// call this once at start.
void remove_temporaries_on_signals();

// Removes temporary files in `folder` left by killed programs (SIGKILL, crash): those whose process
// ran on this machine and no longer exists. Other files, and a folder that cannot be read, are left
// alone.
void remove_temporaries_of_killed(const std::string& folder);

// `path` without its folder; the name recorded in provenance.
std::string base_name(const std::string& path);

// The extension of `path` in lower case with its dot, such as ".bvh"; empty if it has none.
std::string extension(const std::string& path);

// Removes the temporary files of all live OutputFiles (file.h), as the signal handlers do, for a
// program that is about to exit without unwinding. Threads that are about to create one are
// blocked. Does not allocate.
void remove_temporaries();

}  // namespace krok
