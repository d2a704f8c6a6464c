#include "motion/travel.h"

#include "motion/ground_frame.h"

namespace krok {

namespace {

bool travels(const Clip& clip, int joint) {
  constexpr float kStillMetres = 1e-3f;
  const auto j = static_cast<std::size_t>(joint);
  Eigen::AlignedBox2f box;
  for (int f = 0; f < clip.frame_count(); ++f) {
    const Vec3f& position = clip.frame_positions(f)[j];
    box.extend(Eigen::Vector2f(position.x(), position.z()));
  }
  return box.sizes().maxCoeff() > kStillMetres;
}

// The topmost joint that travels, from the carrier upwards; the carrier if none does.
int top_traveller(const Clip& clip, int carrier) {
  int top = carrier;
  for (int j = carrier; j >= 0; j = clip.skeleton.parents[static_cast<std::size_t>(j)]) {
    if (travels(clip, j)) top = j;
  }
  return top;
}

}  // namespace

Clip in_place(const Clip& clip, int carrier, Travel removed) {
  Clip result = clip;
  const int last = clip.frame_count() - 1;
  if (last < 1) return result;
  const auto within = subtree(clip.skeleton, top_traveller(clip, carrier));
  const GroundFrame first = ground_frame(clip, carrier, 0);
  const GroundFrame end = ground_frame(clip, carrier, last);
  for (int f = 1; f <= last; ++f) {
    const GroundFrame now = ground_frame(clip, carrier, f);
    const double share = static_cast<double>(f) / last;
    const Vec3 travel = removed == Travel::all
                            ? Vec3(now.x - first.x, 0, now.z - first.z)
                            : Vec3(share * (end.x - first.x), 0, share * (end.z - first.z));
    auto positions = result.frame_positions(f);
    for (std::size_t j = 0; j < positions.size(); ++j) {
      if (within[j]) positions[j] = (positions[j].cast<double>() - travel).cast<float>();
    }
  }
  return result;
}

}  // namespace krok
