#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/file.h"
#include "core/hash.h"
#include "core/result.h"
#include "formats/registry/registry.h"

// The frame that Krok's own binary formats share: a header, a table of named sections, sections
// aligned to 64 bytes, a checksum. formats/container/SPEC.md describes the bytes.
//
// Codes of errors: container-magic, container-version, container-truncated, container-size,
// container-checksum, container-flags, container-table, container-section, container-provenance.

namespace krok {

inline constexpr std::size_t kSectionAlignment = 64;

// What tells one format from another.
struct ContainerFormat {
  registry::Kind kind;
  registry::Magic magic;
  std::uint32_t version;      // what is written, and the newest that is read
  std::uint32_t known_flags;  // flags that a reader understands
};

// Bit 0 of the flags of all formats: orientations are stored as x, y, z, w.
inline constexpr std::uint32_t kFlagFourComponents = 1;

struct Section {
  std::span<const std::byte> bytes;
  std::uint64_t offset = 0;  // in the file
};

// A container whose header, checksum and section table hold. Views the bytes it was given.
class ContainerReader {
 public:
  static Result<ContainerReader> open(std::span<const std::byte> file,
                                      const ContainerFormat& format);

  std::uint32_t flags() const { return flags_; }

  // A section by its name; nothing or an Error (code container-section) where there is none.
  std::optional<Section> find(std::string_view name) const;
  Result<Section> section(std::string_view name) const;

  // A section that must hold exactly `count` elements of `element_size` bytes. An Error (code
  // container-section) with the section's place where it does not, whatever the count.
  Result<Section> section(std::string_view name, std::uint64_t count,
                          std::uint64_t element_size) const;

 private:
  struct Entry {
    std::string name;
    Section section;
  };
  std::uint32_t flags_ = 0;
  std::vector<Entry> entries_;
};

// Writes a container from its first byte to its last. Sections are appended as they come, so that
// their sizes need not be known beforehand; header and table are filled in by finish(). An output
// that cannot be rewritten (standard output, a pipe) gets the whole file at once in finish().
// Nothing may have been written to `file` before, and commit() is left to its owner.
class ContainerWriter {
 public:
  // Exactly `section_count` sections follow.
  ContainerWriter(OutputFile& file, const ContainerFormat& format, std::uint32_t flags,
                  std::size_t section_count);

  // Ends the section before and begins one of up to 8 ASCII characters.
  Status begin(std::string_view name);
  // Appends to the section begun last.
  Status append(std::span<const std::byte> bytes);
  // begin() and append().
  Status section(std::string_view name, std::span<const std::byte> bytes);
  Status finish();

 private:
  Status put(std::span<const std::byte> bytes);
  Status pad();
  std::vector<std::byte> head(std::uint64_t checksum) const;

  struct Entry {
    std::string name;
    std::uint64_t offset = 0, size = 0;
  };
  OutputFile& file_;
  const ContainerFormat format_;
  const std::uint32_t flags_;
  const std::size_t section_count_;
  const bool in_memory_;
  std::vector<std::byte> memory_;
  std::vector<Entry> entries_;
  std::uint64_t position_ = 0;
  Xxh3Stream checksum_;
};

}  // namespace krok
