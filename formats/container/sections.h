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

// Sections shared by several of Krok's binary formats: provenance, texts, skeleton, and the
// transform record (position and orientation).

namespace krok {

// Max joints of a skeleton in a file; a model's influences have 16-bit joint indices.
inline constexpr std::uint32_t kMaxFileJoints = 65535;

inline std::uint32_t orientation_flags(OrientationEncoding encoding) {
  return encoding == OrientationEncoding::xyzw ? kFlagFourComponents : 0;
}
inline OrientationEncoding orientation_encoding(const ContainerReader& container) {
  return (container.flags() & kFlagFourComponents) != 0 ? OrientationEncoding::xyzw
                                                        : OrientationEncoding::xyz;
}

// The orientation encoding of a valid file.
OrientationEncoding stored_orientation(std::span<const std::byte> file);

// Bytes per position and orientation: 24 or 28.
constexpr std::size_t transform_size(OrientationEncoding encoding) {
  return (3 + static_cast<std::size_t>(float_count(encoding))) * sizeof(float);
}

// Write and read a transform of transform_size() bytes. Alignment does not matter.
void write_transform(const Vec3f& position, const Quat& orientation, OrientationEncoding encoding,
                     std::byte* out);
void read_transform(const std::byte* in, OrientationEncoding encoding, Vec3f& position,
                    Quat& orientation);

// Writes an array of transforms with SIMD; the bytes are those of write_transform on every CPU.
// Both spans have the same length.
void write_transforms(std::span<const Vec3f> positions, std::span<const Quatf> orientations,
                      OrientationEncoding encoding, std::byte* out);

// Section META: the provenance as JSON (schema krok.provenance/1). Empty if the section is missing.
// Code: container-provenance.
Status write_provenance(const Provenance& provenance, ContainerWriter& container);
Result<Provenance> read_provenance(const ContainerReader& container);

// Only the JSON, for formats that are not containers. Code: container-provenance.
Result<std::string> provenance_to_text(const Provenance& provenance);
Result<Provenance> provenance_from_text(std::string_view text);

// A section of exactly `count` trivially copyable elements, such as floats, vectors and records of
// them.
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

// A section of `count` zero-terminated UTF-8 strings.
Result<std::vector<std::string>> read_texts(const ContainerReader& container, std::string_view name,
                                            std::uint64_t count);
Status write_texts(std::string_view name, std::span<const std::string> texts,
                   ContainerWriter& container);

// Whether the text is valid UTF-8 without zero bytes.
bool is_storable_text(std::string_view text);

// Sections JOINTS, NAMES and REFPOSE.
inline constexpr std::size_t kSkeletonSections = 3;
Status write_skeleton(const Skeleton& skeleton, OrientationEncoding encoding,
                      ContainerWriter& container);
// A skeleton that passes check(); otherwise an Error with the location in the file.
Result<Skeleton> read_skeleton(const ContainerReader& container, std::uint32_t joint_count);

// Whether the skeleton can be written. Codes: skeleton-shape for no or too many joints,
// skeleton-name for names that cannot be stored, and those of check().
Status check_storable(const Skeleton& skeleton);

// `error` with the offset of a section, if the section exists and the error has no location yet.
Error at_section(Error error, const ContainerReader& container, std::string_view section);

}  // namespace krok
