#include "scene/mesh_motion.h"

#include <algorithm>
#include <bit>
#include <condition_variable>
#include <cstdint>
#include <mutex>

#include "core/parallel.h"

namespace krok {

namespace {

// One thread asks the motion for a shape, one prepares the shape before it and one hands over that
// before: more would wait.
constexpr int kMostThreads = 3;

// How many frames are handed over in one go: threads that wait for each other after little work
// wait longer than they work.
int frames_together(const ShapeRange& range) {
  constexpr std::size_t kBytes = std::size_t{1} << 20;
  constexpr std::size_t kMostFrames = 16;
  const std::size_t frame = range.vertices * sizeof(Vec3f) * (range.normals ? 2 : 1);
  return static_cast<int>(
      std::clamp<std::size_t>(kBytes / std::max<std::size_t>(frame, 1), 1, kMostFrames));
}

// Lets threads pass one after the other, by number. Numbers are drawn in order, so that whoever
// waits, waits for threads that are at work.
class Turns {
 public:
  // Holds the turn as long as it lives.
  class Turn {
   public:
    Turn(Turns& turns, std::size_t number) : turns_(turns) {
      std::unique_lock lock(turns_.mutex_);
      turns_.passed_.wait(lock, [&] { return turns_.next_ == number; });
    }
    ~Turn() {
      {
        const std::lock_guard lock(turns_.mutex_);
        ++turns_.next_;
      }
      turns_.passed_.notify_all();
    }
    Turn(const Turn&) = delete;
    Turn& operator=(const Turn&) = delete;

   private:
    Turns& turns_;
  };

 private:
  std::mutex mutex_;
  std::condition_variable passed_;
  std::size_t next_ = 0;
};

}  // namespace

bool all_finite(std::span<const Vec3f> vectors) {
  const float* values = vectors.empty() ? nullptr : vectors.front().data();
  // The exponent of what is not finite is all ones: one more carries into the sign's place. Plain
  // integers, so that a compiler takes many at a time.
  std::uint32_t carried = 0;
  for (std::size_t i = 0; i < 3 * vectors.size(); ++i) {
    carried |= (std::bit_cast<std::uint32_t>(values[i]) & 0x7FFFFFFFu) + 0x00800000u;
  }
  return (carried & 0x80000000u) == 0;
}

Status make_shapes(const MeshMotion& motion, const ShapeRange& range, int jobs,
                   const std::function<Status(int, ShapeRoom&)>& prepare,
                   const std::function<Status(int, const ShapeRoom&)>& take) {
  if (range.end <= range.begin) return {};
  const int threads = std::min(thread_count(jobs), kMostThreads);
  const int together = threads == 1 ? 1 : frames_together(range);
  std::vector<std::vector<ShapeRoom>> rooms(slots_for(threads));
  const auto for_each = [&](std::size_t item, std::size_t slot, const auto& work) -> Status {
    const int first = range.begin + static_cast<int>(item) * together;
    const int end = std::min(first + together, range.end);
    for (int frame = first; frame < end; ++frame) {
      ShapeRoom& room = rooms[slot][static_cast<std::size_t>(frame - first)];
      if (Status done = work(frame, room); !done) return done;
    }
    return {};
  };
  Turns turns;
  const auto ask = [&](int frame, ShapeRoom& room) -> Status {
    room.positions.resize(range.vertices);
    room.normals.resize(range.normals ? range.vertices : 0);
    motion.shape_at(frame, room.positions, room.normals);
    return {};
  };
  const auto items = (range.end - range.begin + together - 1) / together;
  return make_in_order(
      static_cast<std::size_t>(items), threads,
      [&](std::size_t item, std::size_t slot) {
        rooms[slot].resize(static_cast<std::size_t>(together));
        {
          const Turns::Turn turn(turns, item);
          (void)for_each(item, slot, ask).ok();
        }
        return for_each(item, slot, prepare);
      },
      [&](std::size_t item, std::size_t slot) { return for_each(item, slot, take); });
}

}  // namespace krok
