#include "guided/mended_input.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>

#include "golden/samples/samples.h"

namespace krok::guided {

namespace {

constexpr std::size_t kHeader = 64, kEntry = 32, kAlignment = 64, kMaxSections = 64;
constexpr std::size_t kName = 8, kPackedHead = kName + 2;

template <typename Number>
void put(std::vector<std::byte>& bytes, std::size_t at, Number number) {
  std::memcpy(bytes.data() + at, &number, sizeof number);
}

template <typename Number>
Number get(std::span<const std::byte> bytes, std::size_t at) {
  Number number = 0;
  std::memcpy(&number, bytes.data() + at, sizeof number);
  return number;
}

struct Packed {
  std::span<const std::byte> name, bytes;
};

std::vector<Packed> sections_of(std::span<const std::byte> packed) {
  std::vector<Packed> sections;
  while (packed.size() >= kPackedHead && sections.size() < kMaxSections) {
    const std::size_t size =
        std::min<std::size_t>(get<std::uint16_t>(packed, kName), packed.size() - kPackedHead);
    sections.push_back({packed.first(kName), packed.subspan(kPackedHead, size)});
    packed = packed.subspan(kPackedHead + size);
  }
  return sections;
}

// The checksum of PNG, 13.1 and annex D of its specification.
std::uint32_t crc(std::span<const std::byte> bytes) {
  static const auto table = [] {
    std::array<std::uint32_t, 256> made{};
    for (std::uint32_t n = 0; n < 256; ++n) {
      made[n] = n;
      for (int k = 0; k < 8; ++k)
        made[n] = (made[n] >> 1) ^ ((made[n] & 1) != 0 ? 0xEDB88320u : 0u);
    }
    return made;
  }();
  std::uint32_t sum = 0xFFFFFFFFu;
  for (const std::byte byte : bytes) {
    sum = table[(sum ^ std::to_integer<std::uint32_t>(byte)) & 0xFFu] ^ (sum >> 8);
  }
  return ~sum;
}

}  // namespace

std::vector<std::byte> assembled(std::span<const std::byte> packed, std::string_view magic) {
  const auto sections = sections_of(packed.subspan(std::min<std::size_t>(packed.size(), 1)));
  std::vector<std::byte> file(kHeader + kEntry * sections.size());
  std::memcpy(file.data(), magic.data(), std::min<std::size_t>(magic.size(), 8));
  put(file, 8, std::uint32_t{1});
  put(file, 12, packed.empty() ? 0u : std::to_integer<std::uint32_t>(packed[0]) & 1u);
  put(file, 32, static_cast<std::uint32_t>(sections.size()));
  for (std::size_t i = 0; i < sections.size(); ++i) {
    file.resize((file.size() + kAlignment - 1) / kAlignment * kAlignment);
    std::ranges::copy(sections[i].name,
                      file.begin() + static_cast<std::ptrdiff_t>(kHeader + kEntry * i));
    put(file, kHeader + kEntry * i + 8, std::uint64_t{file.size()});
    put(file, kHeader + kEntry * i + 16, std::uint64_t{sections[i].bytes.size()});
    file.insert(file.end(), sections[i].bytes.begin(), sections[i].bytes.end());
  }
  samples::repair_header(file);
  return file;
}

std::vector<std::byte> taken_apart(std::span<const std::byte> container) {
  std::vector<std::byte> packed = {container[12]};
  const auto count = get<std::uint32_t>(container, 32);
  for (std::size_t i = 0; i < count; ++i) {
    const auto entry = container.subspan(kHeader + kEntry * i, kEntry);
    const auto offset = get<std::uint64_t>(entry, 8), size = get<std::uint64_t>(entry, 16);
    packed.insert(packed.end(), entry.begin(), entry.begin() + kName);
    packed.resize(packed.size() + 2);
    put(packed, packed.size() - 2, static_cast<std::uint16_t>(size));
    const auto bytes = container.subspan(offset, size);
    packed.insert(packed.end(), bytes.begin(), bytes.end());
  }
  return packed;
}

std::vector<std::byte> with_png_checksums(std::span<const std::byte> image) {
  std::vector<std::byte> png(image.begin(), image.end());
  constexpr std::size_t kSignature = 8, kAround = 12;  // length, type and checksum of a chunk
  for (std::size_t at = kSignature; png.size() >= kAround && at <= png.size() - kAround;) {
    std::uint32_t length = 0;
    for (std::size_t k = 0; k < 4; ++k) {
      length = (length << 8) | std::to_integer<std::uint32_t>(png[at + k]);
    }
    if (length > png.size() - at - kAround) break;
    const std::uint32_t sum = crc(std::span(png).subspan(at + 4, std::size_t{4} + length));
    for (std::size_t k = 0; k < 4; ++k) {
      png[at + 8 + length + k] = static_cast<std::byte>(sum >> (24 - 8 * k));
    }
    at += kAround + length;
  }
  return png;
}

}  // namespace krok::guided
