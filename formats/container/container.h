#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/file.h"
#include "core/hash.h"
#include "core/result.h"
#include "formats/registry/registry.h"

// The container of Krok's binary formats: a header, a table of named sections, sections aligned to
// 64 bytes, a checksum. formats/container/SPEC.md specifies the layout.
//
// Error codes: container-magic, container-version, container-truncated, container-size,
// container-checksum, container-flags, container-table, container-section, container-provenance.

namespace krok {

inline constexpr std::size_t kSectionAlignment = 64;

// Identifies a format.
struct ContainerFormat {
  registry::Kind kind;
  registry::Magic magic;
  std::uint32_t version;      // written, and the newest that is read
  std::uint32_t known_flags;  // flags that the reader supports
};

// Bit 0 of the flags in all formats: orientations are stored as x, y, z, w.
inline constexpr std::uint32_t kFlagFourComponents = 1;

struct Section {
  std::span<const std::byte> bytes;
  std::uint64_t offset = 0;  // in the file
};

// A container with a valid header, checksum and section table. Views the bytes it was given.
class ContainerReader {
 public:
  // `release`, which may be empty, is called with increasing offsets before which the bytes have
  // been hashed, so that memory of a mapped file can be released.
  static Result<ContainerReader> open(std::span<const std::byte> file,
                                      const ContainerFormat& format,
                                      const std::function<void(std::size_t)>& release = {});

  std::uint32_t flags() const { return flags_; }

  // A section by name; nullopt or an Error (code container-section) if there is none.
  std::optional<Section> find(std::string_view name) const;
  Result<Section> section(std::string_view name) const;

  // A section with exactly `count` elements of `element_size` bytes; otherwise an Error (code
  // container-section) with the section's offset. Safe for any count.
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

// Writes a container. Sections are streamed, so their sizes need not be known in advance; finish()
// fills in header and table. An output that cannot be rewritten (standard output, a pipe) gets the
// whole file in finish(). `file` must be empty; its owner calls commit().
class ContainerWriter {
 public:
  // Exactly `section_count` sections follow.
  ContainerWriter(OutputFile& file, const ContainerFormat& format, std::uint32_t flags,
                  std::size_t section_count);

  // Ends the previous section and begins a new one; its name has up to 8 ASCII characters.
  Status begin(std::string_view name);
  // Appends to the current section.
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
