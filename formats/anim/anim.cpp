#include "formats/anim/anim.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <memory>
#include <vector>

#include "core/parallel.h"
#include "formats/container/sections.h"

namespace krok::anim {

namespace {

// Bit 1 of the flags: joints are stretched. A flag, so that a reader that knows of none refuses the
// file instead of showing another motion.
constexpr std::uint32_t kFlagStretched = 2;

constexpr ContainerFormat kFormat = {registry::Kind::anim, registry::kAnimMagic, 1,
                                     kFlagFourComponents | kFlagStretched};

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

// The joints that are stretched in some frame, increasing.
std::vector<std::uint32_t> stretched_joints(std::span<const Stretch> stretches,
                                            std::size_t joints) {
  std::vector<char> stretched(joints, 0);
  for (std::size_t i = 0; i < stretches.size(); ++i) {
    if (!(stretches[i] == Stretch())) stretched[i % joints] = 1;
  }
  std::vector<std::uint32_t> found;
  for (std::size_t j = 0; j < joints; ++j) {
    if (stretched[j] != 0) found.push_back(static_cast<std::uint32_t>(j));
  }
  return found;
}

Status write_stretches(std::span<const Stretch> stretches, std::size_t joints,
                       std::span<const std::uint32_t> stretched, ContainerWriter& container) {
  static_assert(sizeof(Stretch) == 24);
  if (Status status = container.section("SJOINTS", std::as_bytes(stretched)); !status) {
    return status;
  }
  if (Status status = container.begin("STRETCH"); !status) return status;
  std::vector<Stretch> row(stretched.size());
  for (std::size_t first = 0; first < stretches.size(); first += joints) {
    for (std::size_t k = 0; k < row.size(); ++k) row[k] = stretches[first + stretched[k]];
    if (Status status = container.append(std::as_bytes(std::span(row))); !status) return status;
  }
  return {};
}

Result<Stretches> read_stretches(const ContainerReader& container, const Info& info) {
  const auto listed = container.section("SJOINTS");
  if (!listed) return listed.error();
  std::vector<std::uint32_t> stretched;
  const std::uint64_t count = listed->bytes.size() / sizeof(std::uint32_t);
  if (Status status = read_array(container, "SJOINTS", count, stretched); !status) {
    return status.error();
  }
  for (std::size_t k = 0; k < stretched.size(); ++k) {
    if (stretched[k] < info.joint_count && (k == 0 || stretched[k] > stretched[k - 1])) continue;
    return at_section(Error("anim-shape", "the stretched joints are not listed in order"),
                      container, "SJOINTS");
  }
  Stretches stored;
  if (Status status = read_array(container, "STRETCH", info.frame_count * count, stored); !status) {
    return status.error();
  }
  Stretches stretches(stored.empty() ? 0 : info.frame_count * info.joint_count);
  for (std::size_t i = 0; i < stored.size(); ++i) {
    stretches[i / count * info.joint_count + stretched[i % count]] = stored[i];
  }
  return stretches;
}

}  // namespace

Status write(const Clip& clip, const WriteOptions& options, OutputFile& file) {
  if (Status status = check(clip); !status) return status;
  if (Status status = check(options.stretches, clip); !status) return status;
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
  const std::span stretches = options.stretches;
  if (!stretches.empty() && stretches.size() != info.frame_count * joints) {
    return Error("stretch-shape", fmt::format("{} stretches for {} frames of {} joints",
                                              stretches.size(), info.frame_count, joints));
  }
  const auto stretched = stretched_joints(stretches, joints);
  const std::uint32_t flags = stretched.empty() ? 0 : kFlagStretched;
  ContainerWriter container(file, kFormat, orientation_flags(options.orientation) | flags,
                            3 + kSkeletonSections + (stretched.empty() ? 0 : 2));
  if (Status status = container.section("INFO", std::as_bytes(std::span(&info, 1))); !status) {
    return status;
  }
  if (Status status = write_skeleton(source.skeleton, options.orientation, container); !status) {
    return status;
  }
  if (Status status = write_frames(source, options, container); !status) return status;
  if (!stretched.empty()) {
    Status status = write_stretches(stretches, joints, stretched, container);
    if (!status) return status;
  }
  if (Status status = write_provenance(provenance(), container); !status) return status;
  return container.finish();
}

namespace {

// An open file. Copies share the container.
struct Parts {
  std::shared_ptr<const ContainerReader> container;
  Info info;
  std::span<const std::byte> frames;
  OrientationEncoding encoding;
  Opened opened;
};

// Decodes and checks the frames [first, first + count).
Status read_frames(const Parts& parts, const Skeleton& skeleton, int first,
                   std::span<Vec3f> positions, std::span<Quatf> orientations) {
  const std::size_t size = transform_size(parts.encoding);
  const std::size_t joints = skeleton.names.size();
  const std::size_t begin = static_cast<std::size_t>(first) * joints;
  for (std::size_t i = 0; i < positions.size(); ++i) {
    Quat orientation;
    read_transform(&parts.frames[(begin + i) * size], parts.encoding, positions[i], orientation);
    orientations[i] = orientation.cast<float>();
  }
  Status status = check_values(skeleton, first, positions, orientations);
  if (status) return status;
  Error error = std::move(status).error();
  const auto record = error.frame * static_cast<std::int64_t>(joints) + skeleton.find(error.joint);
  const auto section = parts.container->find("FRAMES");
  error.where.byte_offset =
      static_cast<std::int64_t>(section->offset) + record * static_cast<std::int64_t>(size);
  return error;
}

Result<Parts> open_parts(std::span<const std::byte> file,
                         const std::function<void(std::size_t)>& release = {}) {
  auto container = ContainerReader::open(file, kFormat, release);
  if (!container) return container.error();
  Parts parts;
  parts.container = std::make_shared<const ContainerReader>(*std::move(container));
  const auto info_section = parts.container->section("INFO", 1, sizeof(Info));
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
        *parts.container, "INFO");
  }
  parts.info = info;
  parts.opened.stretched = (parts.container->flags() & kFlagStretched) != 0;
  parts.encoding = orientation_encoding(*parts.container);
  const auto frames = parts.container->section("FRAMES", info.frame_count * info.joint_count,
                                               transform_size(parts.encoding));
  if (!frames) return frames.error();
  parts.frames = frames->bytes;
  FrameSource& source = parts.opened.frames;
  source.rate = info.rate;
  source.frame_count = static_cast<int>(info.frame_count);
  auto skeleton = read_skeleton(*parts.container, info.joint_count);
  if (!skeleton) return skeleton.error();
  source.skeleton = *std::move(skeleton);
  auto provenance = read_provenance(*parts.container);
  if (!provenance) return provenance.error();
  parts.opened.provenance = *std::move(provenance);
  Clip head;
  head.skeleton = source.skeleton;
  head.rate = source.rate;
  if (Status status = check(head); !status) {
    return at_section(std::move(status).error(), *parts.container, "INFO");
  }
  return parts;
}

}  // namespace

Result<Opened> open(std::span<const std::byte> file, std::function<void(std::size_t)> release) {
  auto parts = open_parts(file, release);
  if (!parts) return parts.error();
  Opened opened = parts->opened;
  if (release) {
    const std::size_t begin = parts->container->find("FRAMES")->offset;
    const std::size_t of_frame = parts->info.joint_count * transform_size(parts->encoding);
    opened.frames.release = [=, release = std::move(release)](int frame) {
      release(begin + static_cast<std::size_t>(frame) * of_frame);
    };
    // All was read for the checksum; from the start, as it may have been released before.
    opened.frames.release(0);
    opened.frames.release(opened.frames.frame_count);
  }
  opened.frames.read = [parts = *std::move(parts)](int first, int, std::span<Vec3f> positions,
                                                   std::span<Quatf> orientations) {
    return read_frames(parts, parts.opened.frames.skeleton, first, positions, orientations);
  };
  return opened;
}

Result<Clip> read(std::span<const std::byte> file, Stretches* stretches) {
  auto parts = open_parts(file);
  if (!parts) return parts.error();
  const bool is_stretched = parts->opened.stretched;
  if (is_stretched && stretches == nullptr) {
    return Error("anim-stretch", "its joints change scale, which is not supported here");
  }
  FrameSource& source = parts->opened.frames;
  Clip clip;
  clip.rate = source.rate;
  clip.skeleton = std::move(source.skeleton);
  clip.provenance = std::move(parts->opened.provenance);
  clip.resize(source.frame_count);
  Status status = read_frames(*parts, clip.skeleton, 0, clip.positions, clip.orientations);
  if (!status) return status.error();
  if (stretches == nullptr) return clip;
  stretches->clear();
  if (!is_stretched) return clip;
  auto read = read_stretches(*parts->container, parts->info);
  if (!read) return read.error();
  *stretches = *std::move(read);
  if (Status checked = check(*stretches, clip); !checked) {
    return at_section(std::move(checked).error(), *parts->container, "STRETCH");
  }
  return clip;
}

}  // namespace krok::anim
