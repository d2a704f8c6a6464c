#include "formats/anim/anim.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <vector>

#include "core/parallel.h"
#include "formats/container/sections.h"

namespace krok::anim {

namespace {

constexpr ContainerFormat kFormat = {registry::Kind::anim, registry::kAnimMagic, 1,
                                     kFlagFourComponents};

struct Info {
  double rate;
  std::uint64_t frame_count;
  std::uint32_t joint_count;
  std::uint32_t reserved;
};
static_assert(sizeof(Info) == 24);

// Frames are encoded in blocks. A block and its input fit in the cache of a core; its size is a
// multiple of the group of frames that sources generate at once.
constexpr std::size_t kBlockBytes = std::size_t{1} << 17;
constexpr std::size_t kGroup = 16;

std::size_t frames_a_block(std::size_t frame_size) {
  return std::max<std::size_t>(kBlockBytes / frame_size / kGroup, 1) * kGroup;
}

// Buffers for one block.
struct Block {
  std::vector<Vec3f> positions;
  std::vector<Quatf> orientations;
  std::vector<std::byte> bytes;
};

Status write_frames(const FrameSource& source, const WriteOptions& options,
                    ContainerWriter& container) {
  const auto joints = static_cast<std::size_t>(source.joint_count());
  const auto frames = static_cast<std::size_t>(source.frame_count);
  const std::size_t frame_size = joints * transform_size(options.orientation);
  const std::size_t at_once = std::min(frames_a_block(frame_size), frames);
  std::vector<Block> blocks(slots_for(options.jobs));
  const auto make = [&](std::size_t item, std::size_t slot) {
    Block& block = blocks[slot];
    const std::size_t first = item * at_once;
    const std::size_t count = std::min(at_once, frames - first);
    block.positions.resize(at_once * joints);
    block.orientations.resize(at_once * joints);
    block.bytes.resize(count * frame_size);
    const auto positions = std::span(block.positions).first(count * joints);
    const auto orientations = std::span(block.orientations).first(count * joints);
    Status status =
        source.read(static_cast<int>(first), static_cast<int>(count), positions, orientations);
    if (status) write_transforms(positions, orientations, options.orientation, block.bytes.data());
    return status;
  };
  const auto take = [&](std::size_t item, std::size_t slot) {
    if (source.release) {
      source.release(static_cast<int>(std::min((item + 1) * at_once, frames)));
    }
    return container.append(blocks[slot].bytes);
  };
  if (Status status = container.begin("FRAMES"); !status) return status;
  if (frames == 0) return {};
  return make_in_order((frames + at_once - 1) / at_once, options.jobs, make, take);
}

// Adds the location to an error of check(Clip).
Error with_place(Error error, const Clip& clip, const ContainerReader& container) {
  if (error.frame >= 0) {
    const auto frames = container.find("FRAMES");
    const auto joint = clip.skeleton.find(error.joint);
    const auto record = error.frame * clip.joint_count() + joint;
    const auto size = static_cast<std::int64_t>(transform_size(orientation_encoding(container)));
    error.where.byte_offset = static_cast<std::int64_t>(frames->offset) + record * size;
    return error;
  }
  return at_section(std::move(error), container, "INFO");
}

}  // namespace

Status write(const Clip& clip, const WriteOptions& options, OutputFile& file) {
  if (Status status = check(clip); !status) return status;
  return write(
      frames_of(clip), [&] { return clip.provenance; }, options, file);
}

Status write(const FrameSource& source, const std::function<Provenance()>& provenance,
             const WriteOptions& options, OutputFile& file) {
  if (Status status = check_storable(source.skeleton); !status) return status;
  Clip head;
  head.skeleton = source.skeleton;
  head.rate = source.rate;
  if (Status status = check(head); !status) return status;
  const auto joints = static_cast<std::uint32_t>(source.joint_count());
  const Info info = {source.rate, static_cast<std::uint64_t>(source.frame_count), joints, 0};
  ContainerWriter container(file, kFormat, orientation_flags(options.orientation),
                            3 + kSkeletonSections);
  if (Status status = container.section("INFO", std::as_bytes(std::span(&info, 1))); !status) {
    return status;
  }
  if (Status status = write_skeleton(source.skeleton, options.orientation, container); !status) {
    return status;
  }
  if (Status status = write_frames(source, options, container); !status) return status;
  if (Status status = write_provenance(provenance(), container); !status) return status;
  return container.finish();
}

Result<Clip> read(std::span<const std::byte> file) {
  const auto container = ContainerReader::open(file, kFormat);
  if (!container) return container.error();
  const auto info_section = container->section("INFO", 1, sizeof(Info));
  if (!info_section) return info_section.error();
  const auto info = ByteReader(info_section->bytes).read<Info>();
  if (info.joint_count < 1 || info.joint_count > kMaxFileJoints ||
      info.frame_count > static_cast<std::uint64_t>(std::numeric_limits<int>::max())) {
    return at_section(
        Error("anim-shape",
              fmt::format("has {} joints and {} frames, expected 1 to {} joints and up to {} "
                          "frames",
                          info.joint_count, info.frame_count, kMaxFileJoints,
                          std::numeric_limits<int>::max()),
              "create the file again"),
        *container, "INFO");
  }
  const OrientationEncoding encoding = orientation_encoding(*container);
  const std::size_t size = transform_size(encoding);
  const std::uint64_t count = info.frame_count * info.joint_count;
  const auto frames = container->section("FRAMES", count, size);
  if (!frames) return frames.error();

  Clip clip;
  clip.rate = info.rate;
  auto skeleton = read_skeleton(*container, info.joint_count);
  if (!skeleton) return skeleton.error();
  clip.skeleton = *std::move(skeleton);
  auto provenance = read_provenance(*container);
  if (!provenance) return provenance.error();
  clip.provenance = *std::move(provenance);

  clip.positions.resize(count);
  clip.orientations.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    Quat orientation;
    read_transform(&frames->bytes[i * size], encoding, clip.positions[i], orientation);
    clip.orientations[i] = orientation.cast<float>();
  }
  if (Status status = check(clip); !status) {
    return with_place(std::move(status).error(), clip, *container);
  }
  return clip;
}

}  // namespace krok::anim
