#include "scene/mesh_motion.h"

#include <algorithm>
#include <utility>

#include "core/parallel.h"

namespace krok {

namespace {

// Only one thread at a time takes, and taking costs about as much as making: with more threads than
// this, the others would wait.
constexpr int kMaxThreads = 8;

std::size_t frame_bytes(const ShapeRange& range) {
  return range.vertices *
         (sizeof(Vec3f) * (range.normals ? 2 : 1) + (range.tangents ? sizeof(Vec4f) : 0));
}

// Frames per call of `take`: threads that synchronise after little work mostly wait, and files are
// written best in large pieces.
int frames_together(const ShapeRange& range) {
  constexpr std::size_t kBytes = std::size_t{1} << 20;
  constexpr std::size_t kMaxFrames = 16;
  return static_cast<int>(std::clamp<std::size_t>(
      kBytes / std::max<std::size_t>(frame_bytes(range), 1), 1, kMaxFrames));
}

// Fewer threads for frames with many vertices, to limit memory.
int threads_for(const ShapeRange& range, int jobs) {
  constexpr std::size_t kBytes = std::size_t{256} << 20;
  const std::size_t each = 2 * std::max<std::size_t>(frame_bytes(range), 1);
  const auto fit = static_cast<int>(std::clamp<std::size_t>(kBytes / each, 2, kMaxThreads));
  return std::min(thread_count(jobs), fit);
}

// The state of a slot of make_in_order().
struct Slot {
  ShapeSource source;
  std::vector<ShapeRoom> rooms;
};

}  // namespace

std::function<ShapeSource()> copies_of(ShapeSource source) {
  return [source = std::move(source)] { return source; };
}

Status make_shapes(const MeshMotion& motion, const ShapeRange& range, int jobs,
                   const std::function<Status(int, ShapeRoom&)>& prepare,
                   const std::function<Status(int, std::span<const ShapeRoom>)>& take) {
  if (range.end <= range.begin) return {};
  const int threads = threads_for(range, jobs);
  const int together = frames_together(range);
  const int items = (range.end - range.begin + together - 1) / together;
  std::vector<Slot> slots(std::min(slots_for(threads), static_cast<std::size_t>(items)));
  for (Slot& slot : slots) {
    slot.source = motion.source();
    slot.rooms.resize(static_cast<std::size_t>(together));
    for (ShapeRoom& room : slot.rooms) {
      room.positions.resize(range.vertices);
      room.normals.resize(range.normals ? range.vertices : 0);
      room.tangents.resize(range.tangents ? range.vertices : 0);
    }
  }
  const auto first_of = [&](std::size_t item) {
    return range.begin + static_cast<int>(item) * together;
  };
  const auto rooms_of = [&](std::size_t item, std::size_t slot) {
    const int count = std::min(together, range.end - first_of(item));
    return std::span(slots[slot].rooms).first(static_cast<std::size_t>(count));
  };
  return make_in_order(
      static_cast<std::size_t>(items), threads,
      [&](std::size_t item, std::size_t slot) -> Status {
        int frame = first_of(item);
        for (ShapeRoom& room : rooms_of(item, slot)) {
          slots[slot].source(frame, room.place());
          if (Status status = prepare(frame++, room); !status) return status;
        }
        return {};
      },
      [&](std::size_t item, std::size_t slot) {
        return take(first_of(item), rooms_of(item, slot));
      });
}

}  // namespace krok
