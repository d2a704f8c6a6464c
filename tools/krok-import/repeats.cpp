#include "tools/krok-import/repeats.h"

#include <fmt/format.h>

#include <cmath>

#include "core/hash.h"
#include "core/index.h"
#include "core/numbers.h"

namespace krok::cli::import {

FrameSource Repeats::watched(const FrameSource& frames) {
  rate_ = frames.rate;
  poses_.assign(at(frames.frame_count), 0);
  FrameSource watching = frames;
  watching.read = [this, read = frames.read](int first, int count, std::span<Vec3f> positions,
                                             std::span<Quatf> orientations) {
    Status status = read(first, count, positions, orientations);
    const std::size_t joints = count > 0 ? positions.size() / at(count) : 0;
    for (std::size_t f = 0; status && f < at(count); ++f) {
      poses_[at(first) + f] = xxh3(std::as_bytes(positions.subspan(f * joints, joints))) * 31 +
                              xxh3(std::as_bytes(orientations.subspan(f * joints, joints)));
    }
    return status;
  };
  return watching;
}

std::optional<Diagnostic> Repeats::warning() const {
  constexpr int kMinPoses = 10, kHeld = 8;  // frames; who stands still for longer holds a pose
  int poses = 0, single = 0, frames = 0;
  for (std::size_t f = 0; f < poses_.size();) {
    std::size_t end = f + 1;
    while (end < poses_.size() && poses_[end] == poses_[f]) ++end;
    const int length = static_cast<int>(end - f);
    f = end;
    if (length > kHeld) continue;
    ++poses;
    frames += length;
    single += length == 1 ? 1 : 0;
  }
  if (poses < kMinPoses || 10 * single > poses) return std::nullopt;
  const double each = static_cast<double>(frames) / poses;
  const double rate = rate_ / (std::abs(each - std::round(each)) < 0.05 ? std::round(each) : each);
  return make_warning(
      "import-repeats",
      fmt::format("each pose is there {} times in turn: {} frames per second of {}",
                  readable(rate_ / rate, 2), readable(rate, 4), readable(rate_, 4)),
      fmt::format("--rate {} keeps each once, at the same speed; krok-lint shows whether that is a "
                  "person's",
                  readable(rate, 4)));
}

std::optional<Diagnostic> Repeats::in(const Clip& clip) {
  Repeats repeats;
  return read_through(repeats.watched(frames_of(clip)), 1) ? repeats.warning() : std::nullopt;
}

}  // namespace krok::cli::import
