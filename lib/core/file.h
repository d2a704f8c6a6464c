#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "core/result.h"

// Whole files in, atomic files out. Codes: file-missing, file-directory, file-unreadable,
// file-too-large, file-unwritable, file-exists.

namespace krok {

// The bytes of a file, memory-mapped where the system can (a regular file), read into memory
// otherwise (a pipe, standard input). The view lives as long as this object.
class InputFile {
 public:
  // The most that is read from a pipe, a device or standard input.
  static constexpr std::uint64_t kStreamLimit = std::uint64_t{1} << 30;

  // "-" is standard input. A file of more than `limit` bytes is refused (code file-too-large), a
  // stream at kStreamLimit too.
  // An empty file is no error here.
  static Result<InputFile> open(const std::string& path,
                                std::uint64_t limit = std::uint64_t{64} << 30);

  InputFile(InputFile&&) noexcept;
  InputFile& operator=(InputFile&&) noexcept;
  ~InputFile();

  std::span<const std::byte> bytes() const;
  std::string_view text() const;
  const std::string& path() const { return path_; }

  // The XXH3 checksum of the bytes, without holding all of a mapped file in memory at once.
  std::uint64_t checksum() const;

  // Gives the memory of a mapped file's bytes before `offset` back to the system. They can still be
  // read, which brings them in anew; so this is for who reads a long file from front to back.
  void release_before(std::size_t offset) const;

 private:
  struct Content;
  InputFile(std::string path, std::unique_ptr<Content> content);
  std::string path_;
  std::unique_ptr<Content> content_;
};

// A file that appears whole or not at all. Bytes go to a temporary file in the folder of `path`;
// commit() waits until all of them are on the disk, where errors of a delayed write show, and
// renames it; so that after a power cut, too, either the old file stands or the new one. The disk
// is told to begin while more is written, which leaves little to wait for. If the object dies
// before commit(), or the program ends by a signal (see remove_temporaries_on_signals), the
// temporary file is removed and what stood at `path` still stands. The result keeps the permissions
// of the file that it replaces; a symbolic link stays, what it points to is replaced. "-" is
// standard output; a path that exists and is no regular file (a device, a pipe) is written
// directly, for a rename would replace the device.
class OutputFile {
 public:
  struct Options {
    bool no_clobber = false;  // refuse a path that exists (code file-exists)
    // A file that replaces none is put in place without waiting for the disk. For whoever writes
    // many: store_files() waits once, and a way to tell which are whole (a journal with checksums)
    // is needed after a power cut.
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
  // Appends these one behind the other. Many bytes in one call are copied least.
  Status write(std::span<const std::span<const std::byte>> parts);

  // Whether overwrite() works here: not for standard output, devices or pipes.
  bool can_overwrite() const;

  // Overwrites bytes already written, to fill in a header last. Not for standard output, devices
  // or pipes (code file-unwritable).
  Status overwrite(std::uint64_t offset, std::span<const std::byte> bytes);

  std::uint64_t size() const;

  // Ends writing: brings what was written to the disk and lets go of the system's file, so that any
  // number of files may wait to be put in place. Nothing can be written any more.
  Status seal();

  // Where the bytes of a sealed file are until it is put in place.
  const std::string& written_at() const;

  // Seals the file and puts it in place.
  Status commit();

  // The same for files that belong together: none is put in place before all of them are safe, and
  // if one of them cannot be, those before it are taken back, so that all appear or none. What was
  // replaced comes back too where the file system can exchange names (those of Linux can). What
  // went to a stream cannot be taken back.
  static Status place_all(std::span<OutputFile> files);

 private:
  struct State;
  explicit OutputFile(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

// Waits until all that was written to the file system of `folder` is on its disk.
Status store_files(const std::string& folder);

// Writes all of `bytes` to `path` by an OutputFile.
Status write_file(const std::string& path, std::span<const std::byte> bytes,
                  OutputFile::Options options = {});
Status write_file(const std::string& path, std::string_view text, OutputFile::Options options = {});

// Installs handlers that remove the temporary files of all living OutputFiles when a signal ends
// the program, and end it by the same signal: those that ask it to end (SIGINT, SIGTERM, SIGHUP,
// ...), limits of time, and faults of its own. Signals that the program was started to ignore
// (nohup), or that someone handles already, are left so. SIGXFSZ is ignored: a file that grows too
// large is then an Error (code file-unwritable). For programs, called once at their start.
void remove_temporaries_on_signals();

// Removes the temporary files in `folder` that programs left there which were killed (SIGKILL, a
// crash) before they could: those whose process ran on this machine and is no more. Others', and a
// folder that cannot be read, are left alone.
void remove_temporaries_of_killed(const std::string& folder);

// `path` without its folder; the base name that provenance records.
std::string base_name(const std::string& path);

// The extension of `path` in lower case with its dot, ".bvh"; empty if it has none.
std::string extension(const std::string& path);

}  // namespace krok
