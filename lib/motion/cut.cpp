#include "motion/cut.h"

#include <algorithm>
#include <cassert>

namespace krok {

Clip cut(const Clip& clip, int first, int last, int step) {
  assert(0 <= first && first <= last && last < clip.frame_count() && step >= 1);
  Clip result;
  result.skeleton = clip.skeleton;
  result.provenance = clip.provenance;
  result.rate = clip.rate / step;
  result.resize((last - first) / step + 1);
  for (int f = 0; f < result.frame_count(); ++f) {
    const int from = first + f * step;
    std::ranges::copy(clip.frame_positions(from), result.frame_positions(f).begin());
    std::ranges::copy(clip.frame_orientations(from), result.frame_orientations(f).begin());
  }
  return result;
}

}  // namespace krok
