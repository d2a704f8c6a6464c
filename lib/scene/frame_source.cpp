#include "scene/frame_source.h"

#include <algorithm>

#include "core/parallel.h"

namespace krok {

namespace {

constexpr std::size_t kFramesAtOnce = 128;

}  // namespace

Result<Clip> load(const FrameSource& source, int jobs) {
  Clip clip;
  clip.skeleton = source.skeleton;
  clip.rate = source.rate;
  clip.resize(source.frame_count);
  const auto joints = static_cast<std::size_t>(source.joint_count());
  const auto frames = static_cast<std::size_t>(source.frame_count);
  const auto read = [&](std::size_t block, std::size_t) {
    const std::size_t first = block * kFramesAtOnce;
    const std::size_t count = std::min(kFramesAtOnce, frames - first);
    return source.read(static_cast<int>(first), static_cast<int>(count),
                       std::span(clip.positions).subspan(first * joints, count * joints),
                       std::span(clip.orientations).subspan(first * joints, count * joints));
  };
  const auto release = [&](std::size_t block, std::size_t) {
    const std::size_t done = std::min((block + 1) * kFramesAtOnce, frames);
    if (source.release) source.release(static_cast<int>(done));
    return Status();
  };
  const std::size_t blocks = (frames + kFramesAtOnce - 1) / kFramesAtOnce;
  if (Status status = make_in_order(blocks, jobs, read, release); !status) return status.error();
  return clip;
}

Status for_each_block(const FrameSource& source, int jobs,
                      const std::function<Status(int first, const Clip& block)>& use) {
  const auto frames = static_cast<std::size_t>(source.frame_count);
  Clip empty;
  empty.skeleton = source.skeleton;
  empty.rate = source.rate;
  std::vector<Clip> blocks(slots_for(jobs), empty);
  const auto read = [&](std::size_t block, std::size_t slot) {
    const std::size_t first = block * kFramesAtOnce;
    const auto count = static_cast<int>(std::min(kFramesAtOnce, frames - first));
    blocks[slot].resize(count);
    return source.read(static_cast<int>(first), count, blocks[slot].positions,
                       blocks[slot].orientations);
  };
  const auto pass_on = [&](std::size_t block, std::size_t slot) {
    const std::size_t first = block * kFramesAtOnce;
    if (source.release) {
      source.release(static_cast<int>(std::min(first + kFramesAtOnce, frames)));
    }
    return use(static_cast<int>(first), blocks[slot]);
  };
  return make_in_order((frames + kFramesAtOnce - 1) / kFramesAtOnce, jobs, read, pass_on);
}

Status read_through(const FrameSource& source, int jobs) {
  return for_each_block(source, jobs, [](int, const Clip&) { return Status(); });
}

FrameSource frames_of(const Clip& clip) {
  FrameSource source;
  source.skeleton = clip.skeleton;
  source.rate = clip.rate;
  source.frame_count = clip.frame_count();
  source.read = [&clip](int first, int count, std::span<Vec3f> positions,
                        std::span<Quatf> orientations) {
    const auto joints = clip.joint_count();
    std::copy_n(clip.positions.begin() + std::ptrdiff_t{first} * joints,
                std::ptrdiff_t{count} * joints, positions.begin());
    std::copy_n(clip.orientations.begin() + std::ptrdiff_t{first} * joints,
                std::ptrdiff_t{count} * joints, orientations.begin());
    return Status();
  };
  return source;
}

}  // namespace krok
