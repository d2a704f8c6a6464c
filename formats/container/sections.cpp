#include "formats/container/sections.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

namespace krok {

namespace {

// Bytes of the UTF-8 character at the start of `text`; 0 if it is invalid. Rejects overlong forms,
// surrogates and values above U+10FFFF (RFC 3629).
std::size_t utf8_length(std::string_view text) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const unsigned char lead = byte(0);
  if (lead < 0x80) return 1;
  const std::size_t length = lead >= 0xF0 ? 4 : lead >= 0xE0 ? 3 : 2;
  if (lead < 0xC2 || lead > 0xF4 || text.size() < length) return 0;
  for (std::size_t i = 1; i < length; ++i) {
    if ((byte(i) & 0xC0) != 0x80) return 0;
  }
  if (lead == 0xE0 && byte(1) < 0xA0) return 0;
  if (lead == 0xED && byte(1) > 0x9F) return 0;
  if (lead == 0xF0 && byte(1) < 0x90) return 0;
  if (lead == 0xF4 && byte(1) > 0x8F) return 0;
  return length;
}

struct JointRecord {
  std::int32_t parent;
  std::uint32_t flags;
};
static_assert(sizeof(JointRecord) == 8);
constexpr std::uint32_t kJointIsEndSite = 1;

}  // namespace

OrientationEncoding stored_orientation(std::span<const std::byte> file) {
  ByteReader header(file);
  header.seek(12);
  const bool four = (header.read<std::uint32_t>() & kFlagFourComponents) != 0;
  return four ? OrientationEncoding::xyzw : OrientationEncoding::xyz;
}

void write_transform(const Vec3f& position, const Quat& orientation, OrientationEncoding encoding,
                     std::byte* out) {
  std::memcpy(out, position.data(), 3 * sizeof(float));
  if (encoding == OrientationEncoding::xyz) {
    const auto packed = pack_orientation(orientation);
    std::memcpy(out + 3 * sizeof(float), packed.data(), sizeof packed);
  } else {
    const Vec4f all = orientation.coeffs().cast<float>();
    std::memcpy(out + 3 * sizeof(float), all.data(), 4 * sizeof(float));
  }
}

void read_transform(const std::byte* in, OrientationEncoding encoding, Vec3f& position,
                    Quat& orientation) {
  std::memcpy(position.data(), in, 3 * sizeof(float));
  if (encoding == OrientationEncoding::xyz) {
    std::array<float, 3> packed;
    std::memcpy(packed.data(), in + 3 * sizeof(float), sizeof packed);
    orientation = unpack_orientation(packed);
  } else {
    Vec4f all;
    std::memcpy(all.data(), in + 3 * sizeof(float), 4 * sizeof(float));
    orientation.coeffs() = all.cast<double>();
  }
}

bool is_storable_text(std::string_view text) {
  while (!text.empty()) {
    const std::size_t length = text[0] == '\0' ? 0 : utf8_length(text);
    if (length == 0) return false;
    text.remove_prefix(length);
  }
  return true;
}

Result<std::vector<std::string>> read_texts(const ContainerReader& container, std::string_view name,
                                            std::uint64_t count) {
  const auto section = container.section(name);
  if (!section) return section.error();
  const auto fail = [&](std::size_t at, std::string message) {
    return Error("container-section", fmt::format("section {} {}", name, message),
                 "create the file again")
        .at_byte(static_cast<std::int64_t>(section->offset + at));
  };
  const auto& bytes = section->bytes;
  const auto ends =
      static_cast<std::uint64_t>(std::count(bytes.begin(), bytes.end(), std::byte{0}));
  if (ends != count || (!bytes.empty() && bytes.back() != std::byte{0})) {
    return fail(0, fmt::format("has {} texts, expected {}", ends, count));
  }
  std::vector<std::string> texts;
  texts.reserve(count);
  ByteReader reader(bytes);
  for (std::uint64_t i = 0; i < count; ++i) {
    const std::size_t start = reader.position();
    const auto end =
        std::find(bytes.begin() + static_cast<std::ptrdiff_t>(start), bytes.end(), std::byte{0});
    const auto length = static_cast<std::size_t>(end - bytes.begin()) - start;
    const std::string_view text = reader.take_text(length);
    reader.take(1);
    if (!is_storable_text(text)) return fail(start, fmt::format("has invalid UTF-8 in text {}", i));
    texts.emplace_back(text);
  }
  return texts;
}

Status write_texts(std::string_view name, std::span<const std::string> texts,
                   ContainerWriter& container) {
  ByteWriter writer;
  for (const std::string& text : texts) {
    writer.append_text(text);
    writer.write('\0');
  }
  return container.section(name, writer.bytes());
}

Status check_storable(const Skeleton& skeleton) {
  if (Status status = check(skeleton); !status) return status;
  if (skeleton.names.size() > kMaxFileJoints) {
    return Error("skeleton-shape",
                 fmt::format("{} joints, the limit is {}", skeleton.names.size(), kMaxFileJoints));
  }
  for (std::size_t i = 0; i < skeleton.names.size(); ++i) {
    if (!skeleton.reference[i].position.cast<float>().allFinite()) {
      return Error("skeleton-value", fmt::format("the reference position of joint {} is too large",
                                                 skeleton.names[i]));
    }
    if (is_storable_text(skeleton.names[i])) continue;
    return Error("skeleton-name",
                 fmt::format("the name of joint {} is not valid UTF-8 or has a zero byte", i),
                 "rename the joint");
  }
  return {};
}

Status write_skeleton(const Skeleton& skeleton, OrientationEncoding encoding,
                      ContainerWriter& container) {
  const std::size_t count = skeleton.names.size();
  ByteWriter joints;
  for (std::size_t i = 0; i < count; ++i) {
    joints.write(JointRecord{skeleton.parents[i], skeleton.end_sites[i] ? kJointIsEndSite : 0});
  }
  if (Status status = container.section("JOINTS", joints.bytes()); !status) return status;
  if (Status status = write_texts("NAMES", skeleton.names, container); !status) return status;
  const std::size_t size = transform_size(encoding);
  std::vector<std::byte> pose(count * size);
  for (std::size_t i = 0; i < count; ++i) {
    const Transform& joint = skeleton.reference[i];
    write_transform(joint.position.cast<float>(), joint.orientation, encoding, &pose[i * size]);
  }
  return container.section("REFPOSE", pose);
}

Result<Skeleton> read_skeleton(const ContainerReader& container, std::uint32_t joint_count) {
  const auto joints = container.section("JOINTS", joint_count, sizeof(JointRecord));
  if (!joints) return joints.error();
  const OrientationEncoding encoding = orientation_encoding(container);
  const std::size_t size = transform_size(encoding);
  const auto pose = container.section("REFPOSE", joint_count, size);
  if (!pose) return pose.error();
  auto names = read_texts(container, "NAMES", joint_count);
  if (!names) return names.error();

  Skeleton skeleton;
  skeleton.names = *std::move(names);
  ByteReader reader(joints->bytes);
  for (std::uint32_t i = 0; i < joint_count; ++i) {
    const std::size_t place = joints->offset + reader.position();
    const auto record = reader.read<JointRecord>();
    if ((record.flags & ~kJointIsEndSite) != 0) {
      return Error("container-section",
                   fmt::format("joint {} has unknown flags {:#x}", i, record.flags),
                   "use a newer Krok")
          .at_byte(static_cast<std::int64_t>(place + 4));
    }
    skeleton.parents.push_back(record.parent);
    skeleton.end_sites.push_back(static_cast<std::uint8_t>(record.flags & kJointIsEndSite));
    Vec3f position;
    Transform joint;
    read_transform(pose->bytes.data() + i * size, encoding, position, joint.orientation);
    joint.position = position.cast<double>();
    skeleton.reference.push_back(joint);
  }
  if (Status status = check(skeleton); !status) {
    const std::string& code = status.error().code;
    return at_section(status.error(), container,
                      code == "skeleton-name"    ? "NAMES"
                      : code == "skeleton-value" ? "REFPOSE"
                                                 : "JOINTS");
  }
  return skeleton;
}

Error at_section(Error error, const ContainerReader& container, std::string_view section) {
  const auto found = container.find(section);
  if (found && error.where.byte_offset < 0) {
    error.where.byte_offset = static_cast<std::int64_t>(found->offset);
  }
  return error;
}

}  // namespace krok
