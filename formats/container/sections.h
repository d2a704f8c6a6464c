#pragma once

#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/bytes.h"
#include "formats/container/container.h"
#include "formats/container/packed_orientation.h"
#include "math/transform.h"
#include "scene/provenance.h"
#include "scene/skeleton.h"

// The sections that several of Krok's binary formats have in the same form: provenance, texts, the
// skeleton, and the record of a joint's position and orientation.

namespace krok {

// Joints of a skeleton in a file; influences of a model name them by 16 bits.
inline constexpr std::uint32_t kMaxFileJoints = 65535;

inline std::uint32_t orientation_flags(OrientationEncoding encoding) {
  return encoding == OrientationEncoding::xyzw ? kFlagFourComponents : 0;
}
inline OrientationEncoding orientation_encoding(const ContainerReader& container) {
  return (container.flags() & kFlagFourComponents) != 0 ? OrientationEncoding::xyzw
                                                        : OrientationEncoding::xyz;
}

// How a file that a reader has accepted stores its orientations.
OrientationEncoding stored_orientation(std::span<const std::byte> file);

// Bytes of a position with an orientation: 24 or 28.
constexpr std::size_t transform_size(OrientationEncoding encoding) {
  return (3 + static_cast<std::size_t>(float_count(encoding))) * sizeof(float);
}

// Stores a transform at `out`, which has transform_size() bytes; `read_transform` reads one from
// there. Alignment does not matter.
void write_transform(const Vec3f& position, const Quat& orientation, OrientationEncoding encoding,
                     std::byte* out);
void read_transform(const std::byte* in, OrientationEncoding encoding, Vec3f& position,
                    Quat& orientation);

// The same for many, stored one after the other; vectorised, the bytes are those of
// write_transform on every machine. Both spans have the same length.
void write_transforms(std::span<const Vec3f> positions, std::span<const Quatf> orientations,
                      OrientationEncoding encoding, std::byte* out);

// Section META: where the data came from, as JSON (schema krok.provenance/1). A file without it has
// an empty provenance. Codes: container-provenance.
Status write_provenance(const Provenance& provenance, ContainerWriter& container);
Result<Provenance> read_provenance(const ContainerReader& container);

// The JSON alone, for formats that are no containers. The same code.
Result<std::string> provenance_to_text(const Provenance& provenance);
Result<Provenance> provenance_from_text(std::string_view text);

// A section of exactly `count` elements that are plain numbers, such as floats, vectors and records
// of them, as the file has them.
template <typename T>
Status read_array(const ContainerReader& container, std::string_view name, std::uint64_t count,
                  std::vector<T>& values) {
  const auto section = container.section(name, count, sizeof(T));
  if (!section) return section.error();
  values.resize(count);
  if (count > 0) {
    std::memcpy(static_cast<void*>(values.data()), section->bytes.data(), section->bytes.size());
  }
  return {};
}

// A section of `count` texts, each in UTF-8 and ended by a zero byte.
Result<std::vector<std::string>> read_texts(const ContainerReader& container, std::string_view name,
                                            std::uint64_t count);
Status write_texts(std::string_view name, std::span<const std::string> texts,
                   ContainerWriter& container);

// Whether a file can hold the text: valid UTF-8 without zero bytes.
bool is_storable_text(std::string_view text);

// Sections JOINTS, NAMES and REFPOSE.
inline constexpr std::size_t kSkeletonSections = 3;
Status write_skeleton(const Skeleton& skeleton, OrientationEncoding encoding,
                      ContainerWriter& container);
// A skeleton for which check() holds; otherwise its Error with the place in the file.
Result<Skeleton> read_skeleton(const ContainerReader& container, std::uint32_t joint_count);

// What a writer refuses before it writes anything: no joints or too many, names that a file cannot
// hold (code skeleton-name, skeleton-shape), everything that check() refuses.
Status check_storable(const Skeleton& skeleton);

// `error` with the place of a section, where the section is there and the error has no place yet.
Error at_section(Error error, const ContainerReader& container, std::string_view section);

}  // namespace krok
