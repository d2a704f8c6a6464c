#include "scene/frame_source.h"

#include <algorithm>
#include <array>
#include <memory>
#include <mutex>

#include "core/index.h"
#include "core/parallel.h"
#include "math/quaternion.h"

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

namespace {

Result<FrameRun> load_run(const FrameSource& source, BlockSize size, int jobs, int number) {
  FrameRun run;
  const int begin = number * size.frames;
  const int end = std::min(source.frame_count - begin, size.frames) + begin;
  run.first = std::max(begin - size.overlap, 0);
  const int last = std::min(source.frame_count - end, size.overlap) + end;
  run.kept_begin = begin - run.first;
  run.kept_end = end - run.first;
  auto clip = load(part_of(source, run.first, last - run.first), jobs);
  if (!clip) return clip.error();
  if (source.release) source.release(std::max(end - size.overlap, 0));
  run.clip = *std::move(clip);
  return run;
}

class Blocks {
 public:
  Blocks(FrameSource source, BlockSize size, int jobs, std::function<Status(FrameRun&)> change)
      : source_(std::move(source)), size_(size), jobs_(jobs), change_(std::move(change)) {}

  Status read(int first, int count, std::span<Vec3f> positions, std::span<Quatf> orientations) {
    for (int done = 0; done < count;) {
      const int number = (first + done) / size_.frames;
      const auto run = run_of(number);
      if (!run) return run.error();
      const FrameRun& block = **run;
      const auto joints = static_cast<std::size_t>(block.clip.joint_count());
      const int begin = first + done - block.first;
      const int frames = std::min(block.kept_end - begin, count - done);
      const auto from = static_cast<std::size_t>(begin) * joints;
      const auto to = static_cast<std::ptrdiff_t>(static_cast<std::size_t>(done) * joints);
      const std::size_t values = static_cast<std::size_t>(frames) * joints;
      std::ranges::copy(std::span(block.clip.positions).subspan(from, values),
                        positions.begin() + to);
      std::ranges::copy(std::span(block.clip.orientations).subspan(from, values),
                        orientations.begin() + to);
      done += frames;
    }
    return {};
  }

 private:
  Result<std::shared_ptr<const FrameRun>> run_of(int number) {
    const std::lock_guard lock(mutex_);
    for (; next_ < number; ++next_) {
      if (Status status = make(next_); !status) return status.error();
    }
    for (const Made& made : made_) {
      if (made.run && made.number == number) return made.run;
    }
    if (Status status = make(number); !status) return status.error();
    next_ = std::max(next_, number + 1);
    return made_[0].run;
  }

  Status make(int number) {
    auto run = load_run(source_, size_, jobs_, number);
    if (!run) return run.error();
    if (Status status = change_(*run); !status) return status.error();
    std::swap(made_[0], made_[1]);
    made_[0] = {number, std::make_shared<const FrameRun>(*std::move(run))};
    return {};
  }

  struct Made {
    int number = 0;
    std::shared_ptr<const FrameRun> run;
  };

  FrameSource source_;
  BlockSize size_;
  int jobs_;
  std::function<Status(FrameRun&)> change_;
  std::mutex mutex_;
  std::array<Made, 2> made_;  // the newest first
  int next_ = 0;              // the first block that was never made
};

}  // namespace

FrameSource part_of(const FrameSource& source, int first, int count) {
  FrameSource part = source;
  part.frame_count = count;
  part.release = {};
  part.read = [read = source.read, start = first](int from, auto... block) {
    return read(start + from, block...);
  };
  return part;
}

FrameSource changed(const FrameSource& source, std::function<Status(Clip& frames)> change) {
  FrameSource result = source;
  result.read = [source, change = std::move(change)](int first, int count,
                                                     std::span<Vec3f> positions,
                                                     std::span<Quatf> orientations) -> Status {
    auto frames = load(part_of(source, first, count), 1);
    if (!frames) return frames.error();
    if (Status status = change(*frames); !status) return status;
    std::ranges::copy(frames->positions, positions.begin());
    std::ranges::copy(frames->orientations, orientations.begin());
    return {};
  };
  return result;
}

Status for_each_run(const FrameSource& source, BlockSize size, int jobs,
                    const std::function<Status(const FrameRun&)>& use) {
  for (int number = 0; number * size.frames < source.frame_count; ++number) {
    const auto run = load_run(source, size, jobs, number);
    if (!run) return run.error();
    if (Status status = use(*run); !status) return status;
  }
  return {};
}

FrameSource changed_in_blocks(const FrameSource& source, BlockSize size, int jobs,
                              std::function<Status(FrameRun& run)> change) {
  const auto blocks = std::make_shared<Blocks>(source, size, jobs, std::move(change));
  FrameSource result = source;
  result.release = {};
  result.read = [blocks](auto... block) { return blocks->read(block...); };
  return result;
}

std::vector<Transform> usual_pose(const Clip& clip) {
  return *usual_pose(frames_of(clip));  // frames of a clip are always there
}

Result<std::vector<Transform>> usual_pose(const FrameSource& source) {
  const std::vector<int>& parents = source.skeleton.parents;
  const auto parent_of = [&](const std::vector<Transform>& pose, std::size_t joint) {
    return joint == 0 ? Transform() : pose[at(parents[joint])];
  };
  const int count = std::min(source.frame_count, 32);
  std::vector<Vec3f> positions(parents.size());
  std::vector<Quatf> orientations(parents.size());
  std::vector<Vec3> places(parents.size(), Vec3::Zero());
  std::vector<Vec4> turns(parents.size(), Vec4::Zero());
  std::vector<Transform> pose(parents.size());
  for (int k = 0; k < count; ++k) {
    const auto frame = static_cast<int>((2LL * k + 1) * source.frame_count / (2LL * count));
    if (Status status = source.read(frame, 1, positions, orientations); !status)
      return status.error();
    for (std::size_t j = 0; j < pose.size(); ++j) {
      pose[j] = {positions[j].cast<double>(), orientations[j].cast<double>().normalized()};
      const Transform local = parent_of(pose, j).inverse() * pose[j];
      const Vec4 turn = local.orientation.coeffs();
      places[j] += local.position / count;
      turns[j] += turns[j].dot(turn) < 0 ? -turn : turn;
    }
  }
  if (count == 0) return std::vector<Transform>();
  for (std::size_t j = 0; j < pose.size(); ++j) {
    pose[j] = parent_of(pose, j) * Transform{places[j], normalized_or_identity(Quat(turns[j]))};
  }
  return pose;
}

}  // namespace krok
