#include "formats/container/container.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cassert>

#include "core/bytes.h"

namespace krok {

namespace {

constexpr std::size_t kHeaderSize = 64;
constexpr std::size_t kEntrySize = 32;
constexpr std::size_t kNameSize = 8;
constexpr std::size_t kChecksumOffset = 24;
constexpr std::uint32_t kMaxSections = 64;

std::string extension_of(const ContainerFormat& format) {
  return fmt::format(".{}", registry::kind_name(format.kind));
}

Error wrong_magic(std::span<const std::byte> file, const ContainerFormat& format) {
  return Error("container-magic",
               fmt::format("is {}, not a {} file", registry::describe_content(file),
                           extension_of(format)),
               registry::advice(registry::kind_of_content(file), format.kind))
      .at_byte(0);
}

Error truncated(std::string message) {
  return Error("container-truncated", std::move(message),
               "the file is truncated; copy or create it again");
}

// Hashes everything after the section table, then header and table (with zeros for the checksum),
// which a writer knows last.
std::uint64_t checksum_of(std::span<const std::byte> file, std::size_t head_size,
                          const std::function<void(std::size_t)>& release) {
  constexpr std::size_t kAtOnce = std::size_t{8} << 20;
  Xxh3Stream stream;
  for (std::size_t begin = head_size; begin < file.size(); begin += kAtOnce) {
    stream.update(file.subspan(begin, std::min(kAtOnce, file.size() - begin)));
    if (release) release(std::min(begin + kAtOnce, file.size()));
  }
  std::vector<std::byte> head(file.begin(), file.begin() + static_cast<std::ptrdiff_t>(head_size));
  std::fill_n(head.begin() + kChecksumOffset, sizeof(std::uint64_t), std::byte{0});
  stream.update(head);
  return stream.digest();
}

struct Header {
  std::uint32_t flags = 0;
  std::uint32_t section_count = 0;
  std::size_t head_size() const { return kHeaderSize + section_count * kEntrySize; }
};

Result<Header> read_header(std::span<const std::byte> file, const ContainerFormat& format,
                           const std::function<void(std::size_t)>& release) {
  ByteReader reader(file);
  const std::string_view magic = reader.take_text(format.magic.size());
  if (magic != std::string_view(format.magic.data(), format.magic.size())) {
    return wrong_magic(file, format);
  }
  if (file.size() < kHeaderSize) {
    return truncated(
        fmt::format("has {} bytes, less than the header of {}", file.size(), kHeaderSize));
  }
  const auto version = reader.read<std::uint32_t>();
  Header header;
  header.flags = reader.read<std::uint32_t>();
  const auto size = reader.read<std::uint64_t>();
  const auto stored_checksum = reader.read<std::uint64_t>();
  header.section_count = reader.read<std::uint32_t>();
  if (version > format.version) {
    return Error("container-version",
                 fmt::format("is a {} file of version {}; this program reads up to version {}",
                             extension_of(format), version, format.version),
                 "use a newer Krok")
        .at_byte(8);
  }
  if (version == 0) {
    return Error("container-version", "has version 0, which does not exist",
                 "create the file again")
        .at_byte(8);
  }
  if (file.size() < size) {
    return truncated(fmt::format("has {} bytes, expected {}", file.size(), size)).at_byte(16);
  }
  if (file.size() > size) {
    return Error("container-size", fmt::format("has {} bytes, expected {}", file.size(), size),
                 "data was appended to the file; create it again")
        .at_byte(16);
  }
  if (header.section_count > kMaxSections || header.head_size() > file.size()) {
    return Error("container-table", fmt::format("has too many sections ({})", header.section_count),
                 "the file is damaged; copy or create it again")
        .at_byte(32);
  }
  const std::uint64_t checksum = checksum_of(file, header.head_size(), release);
  if (checksum != stored_checksum) {
    return Error("container-checksum",
                 fmt::format("is damaged: its checksum is {}, expected {}", hex(checksum),
                             hex(stored_checksum)),
                 "copy or create it again")
        .at_byte(kChecksumOffset);
  }
  if ((header.flags & ~format.known_flags) != 0) {
    return Error("container-flags",
                 fmt::format("has flags {:#x}, of which {:#x} are unknown", header.flags,
                             header.flags & ~format.known_flags),
                 "use a newer Krok")
        .at_byte(12);
  }
  return header;
}

}  // namespace

Result<ContainerReader> ContainerReader::open(std::span<const std::byte> file,
                                              const ContainerFormat& format,
                                              const std::function<void(std::size_t)>& release) {
  const auto header = read_header(file, format, release);
  if (!header) return header.error();
  ContainerReader container;
  container.flags_ = header->flags;

  ByteReader table(file);
  table.seek(kHeaderSize);
  std::uint64_t free_from = header->head_size();
  for (std::uint32_t i = 0; i < header->section_count; ++i) {
    const auto place = static_cast<std::int64_t>(table.position());
    const auto fail = [place](std::string message) {
      return Error("container-table", std::move(message), "create the file again").at_byte(place);
    };
    const std::string_view padded = table.take_text(kNameSize);
    const std::string_view name = padded.substr(0, padded.find('\0'));
    const auto offset = table.read<std::uint64_t>();
    const auto size = table.read<std::uint64_t>();
    table.read<std::uint64_t>();  // reserved
    if (name.empty() ||
        std::any_of(name.begin(), name.end(), [](char c) { return c <= ' ' || c >= 127; })) {
      return fail(fmt::format("the name of section {} is not ASCII", i));
    }
    if (container.find(name)) return fail(fmt::format("section {} appears twice", name));
    if (offset % kSectionAlignment != 0) {
      return fail(fmt::format("section {} begins at byte {}, which is not a multiple of {}", name,
                              offset, kSectionAlignment));
    }
    if (offset < free_from) {
      return fail(
          fmt::format("section {} begins at byte {} and overlaps what is before it", name, offset));
    }
    if (offset > file.size() || size > file.size() - offset) {
      return fail(
          fmt::format("section {} ({} bytes at byte {}) exceeds the file", name, size, offset));
    }
    free_from = offset + size;
    container.entries_.push_back({std::string(name), {file.subspan(offset, size), offset}});
  }
  return container;
}

std::optional<Section> ContainerReader::find(std::string_view name) const {
  for (const Entry& entry : entries_) {
    if (entry.name == name) return entry.section;
  }
  return std::nullopt;
}

Result<Section> ContainerReader::section(std::string_view name) const {
  if (const auto found = find(name)) return *found;
  return Error("container-section", fmt::format("has no section {}", name),
               "create the file again");
}

Result<Section> ContainerReader::section(std::string_view name, std::uint64_t count,
                                         std::uint64_t element_size) const {
  const auto found = section(name);
  if (!found) return found;
  const std::uint64_t size = found->bytes.size();
  // Division first: count times element_size may overflow.
  if (size % element_size != 0 || size / element_size != count) {
    return Error("container-section",
                 fmt::format("section {} has {} bytes, expected {} elements of {} bytes", name,
                             size, count, element_size),
                 "create the file again")
        .at_byte(static_cast<std::int64_t>(found->offset));
  }
  return found;
}

ContainerWriter::ContainerWriter(OutputFile& file, const ContainerFormat& format,
                                 std::uint32_t flags, std::size_t section_count)
    : file_(file),
      format_(format),
      flags_(flags),
      section_count_(section_count),
      in_memory_(!file.can_overwrite()) {
  assert(file.size() == 0 && section_count <= kMaxSections);
}

Status ContainerWriter::put(std::span<const std::byte> bytes) {
  position_ += bytes.size();
  if (!in_memory_) return file_.write(bytes);
  memory_.insert(memory_.end(), bytes.begin(), bytes.end());
  return {};
}

Status ContainerWriter::pad() {
  constexpr std::array<std::byte, kSectionAlignment> kZeros{};
  const std::size_t over = position_ % kSectionAlignment;
  if (over == 0) return {};
  const auto zeros = std::span(kZeros).first(kSectionAlignment - over);
  checksum_.update(zeros);
  return put(zeros);
}

Status ContainerWriter::begin(std::string_view name) {
  assert(!name.empty() && name.size() <= kNameSize && entries_.size() < section_count_);
  if (entries_.empty()) {
    // Header and table are added to the checksum in finish().
    if (Status status = put(head(0)); !status) return status;
  }
  if (Status status = pad(); !status) return status;
  entries_.push_back({std::string(name), position_, 0});
  return {};
}

Status ContainerWriter::append(std::span<const std::byte> bytes) {
  assert(!entries_.empty());
  entries_.back().size += bytes.size();
  checksum_.update(bytes);
  return put(bytes);
}

Status ContainerWriter::section(std::string_view name, std::span<const std::byte> bytes) {
  if (Status status = begin(name); !status) return status;
  return append(bytes);
}

std::vector<std::byte> ContainerWriter::head(std::uint64_t checksum) const {
  ByteWriter writer;
  writer.append_text({format_.magic.data(), format_.magic.size()});
  writer.write(format_.version);
  writer.write(flags_);
  writer.write(position_);
  writer.write(checksum);
  writer.write(static_cast<std::uint32_t>(section_count_));
  writer.align(kHeaderSize);
  for (const Entry& entry : entries_) {
    writer.append_text(entry.name);
    writer.align(kNameSize);
    writer.write(entry.offset);
    writer.write(entry.size);
    writer.write(std::uint64_t{0});
  }
  writer.buffer().resize(kHeaderSize + section_count_ * kEntrySize, std::byte{0});
  return std::move(writer.buffer());
}

Status ContainerWriter::finish() {
  assert(entries_.size() == section_count_);
  checksum_.update(head(0));
  const auto filled = head(checksum_.digest());
  if (!in_memory_) return file_.overwrite(0, filled);
  std::copy(filled.begin(), filled.end(), memory_.begin());
  const Status status = file_.write(memory_);
  memory_ = {};
  return status;
}

}  // namespace krok
