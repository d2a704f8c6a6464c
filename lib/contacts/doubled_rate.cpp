#include "contacts/doubled_rate_internal.h"

#include <algorithm>
#include <array>

namespace krok::contacts {

namespace {

// Frames and weights for the moment between two frames.
struct Between {
  std::array<int, 4> frames{};
  std::array<float, 4> weights{};
};

// The cubic through two frames on either side; the parabola through three at the clip's ends. The
// first frame is not used for others: it may be a rest pose.
Between between(int frame, int frames) {
  if (frame == 0) return {{1, 2, 3, 3}, {1.875F, -1.25F, 0.375F, 0}};
  if (frame == 1) return {{1, 2, 3, 3}, {0.375F, 0.75F, -0.125F, 0}};
  if (frame + 2 == frames) {
    return {{frames - 1, frames - 2, frames - 3, frames - 3}, {0.375F, 0.75F, -0.125F, 0}};
  }
  return {{frame - 1, frame, frame + 1, frame + 2}, {-0.0625F, 0.5625F, 0.5625F, -0.0625F}};
}

}  // namespace

Clip doubled_rate(const Clip& clip) {
  Clip dense;
  dense.skeleton = clip.skeleton;
  dense.rate = 2 * clip.rate;
  const int frames = clip.frame_count();
  dense.resize(2 * frames - 1);
  for (int f = 0; f < frames; ++f) {
    std::ranges::copy(clip.frame_positions(f), dense.frame_positions(2 * f).begin());
    std::ranges::copy(clip.frame_orientations(f), dense.frame_orientations(2 * f).begin());
    if (f + 1 == frames) break;
    const Between parts = between(f, frames);
    const auto positions = dense.frame_positions(2 * f + 1);
    const auto orientations = dense.frame_orientations(2 * f + 1);
    for (std::size_t j = 0; j < positions.size(); ++j) {
      Vec3f position = Vec3f::Zero();
      Eigen::Vector4f turn = Eigen::Vector4f::Zero();
      const Quatf& like = clip.frame_orientations(parts.frames[0])[j];
      for (std::size_t i = 0; i < parts.frames.size(); ++i) {
        position += parts.weights[i] * clip.frame_positions(parts.frames[i])[j];
        const Quatf& q = clip.frame_orientations(parts.frames[i])[j];
        turn += (q.dot(like) < 0 ? -parts.weights[i] : parts.weights[i]) * q.coeffs();
      }
      positions[j] = position;
      orientations[j] = turn.norm() > 1e-3F ? Quatf(Eigen::Vector4f(turn.normalized())) : like;
    }
  }
  return dense;
}

}  // namespace krok::contacts
