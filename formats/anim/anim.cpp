#include "formats/anim/anim.h"

#include <fmt/format.h>

#include <limits>

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

// Joint transforms that are encoded at a time, so that memory stays bounded.
constexpr std::size_t kBlock = std::size_t{1} << 16;
constexpr std::size_t kGrain = std::size_t{1} << 12;

Status write_frames(const Clip& clip, const WriteOptions& options, ContainerWriter& container) {
  const std::size_t size = transform_size(options.orientation);
  const std::size_t total = clip.positions.size();
  std::vector<std::byte> block(std::min(kBlock, total) * size);
  if (Status done = container.begin("FRAMES"); !done) return done;
  for (std::size_t first = 0; first < total; first += kBlock) {
    const std::size_t count = std::min(kBlock, total - first);
    parallel_for(count, kGrain, options.jobs, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        write_transform(clip.positions[first + i], clip.orientations[first + i].cast<double>(),
                        options.orientation, &block[i * size]);
      }
    });
    if (Status done = container.append(std::span(block).first(count * size)); !done) return done;
  }
  return {};
}

// The place of what check(Clip) found wrong.
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
  if (Status holds = check(clip); !holds) return holds;
  if (Status holds = check_storable(clip.skeleton); !holds) return holds;
  const auto joints = static_cast<std::uint32_t>(clip.skeleton.names.size());
  const Info info = {clip.rate, clip.positions.size() / joints, joints, 0};
  ContainerWriter container(file, kFormat, orientation_flags(options.orientation),
                            3 + kSkeletonSections);
  if (Status done = container.section("INFO", std::as_bytes(std::span(&info, 1))); !done) {
    return done;
  }
  if (Status done = write_skeleton(clip.skeleton, options.orientation, container); !done) {
    return done;
  }
  if (Status done = write_frames(clip, options, container); !done) return done;
  if (Status done = write_provenance(clip.provenance, container); !done) return done;
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
              fmt::format("says it has {} joints and {} frames; 1 to {} joints and up "
                          "to {} frames are possible",
                          info.joint_count, info.frame_count, kMaxFileJoints,
                          std::numeric_limits<int>::max()),
              "make the file anew"),
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
  if (Status holds = check(clip); !holds) {
    return with_place(std::move(holds).error(), clip, *container);
  }
  return clip;
}

}  // namespace krok::anim
