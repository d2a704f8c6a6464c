#pragma once

#include <array>
#include <span>
#include <vector>

#include "core/result.h"
#include "math/types.h"
#include "skin/morph.h"

// Per-vertex key-frame animation: whole shapes of one mesh at times of their own.

namespace krok {

struct KeyFrameMesh {
  std::vector<double> times;  // [keys] seconds, rising strictly
  int vertex_count = 0;
  std::vector<Vec3f> positions;  // [keys x vertices] metres
  std::vector<Vec3f> normals;    // [keys x vertices] unit, or none

  int key_count() const { return static_cast<int>(times.size()); }
};

// Whether there is a key, the lengths fit, times rise and all is finite. Codes key-mesh-shape,
// key-mesh-time, key-mesh-value.
Status check(const KeyFrameMesh& mesh);

// How a shape becomes the next one. With p_i, t_i the keys, h = t_{i+1} - t_i and t in [0, 1] the
// part of it that is over:
//
//   linear   p(t) = (1 - t) p_i + t p_{i+1}
//   hermite  p(t) = (2t^3 - 3t^2 + 1) p_i + (t^3 - 2t^2 + t) m_i
//                   + (3t^2 - 2t^3) p_{i+1} + (t^3 - t^2) m_{i+1}
//            with m_i = h v_i, v_i = (1 - a) (p_{i+1} - p_{i-1}) / (t_{i+1} - t_{i-1}) for a
//            tension a; at the first and last key (1 - a) times the one difference over its time.
//            For evenly spaced keys that is m_i = (1 - a) / 2 ((p_i - p_{i-1}) + (p_{i+1} - p_i));
//            for others the velocity is the same on both sides of a key (Kochanek and Bartels,
//            Interpolating splines with local tension, continuity, and bias control, SIGGRAPH 1984,
//            section 4). a = 0 is Catmull-Rom; a = 1 comes to rest at each key.
enum class ShapeJoin : unsigned char { linear, hermite };

// The keys that make a shape, and the share of each; the shares sum to 1.
struct KeyShares {
  int count = 0;  // 1 to 4
  std::array<int, 4> keys{};
  std::array<double, 4> shares{};
};

// The shares at `time`: before the first key and after the last that key alone, at a key's own time
// exactly that key. `times` is not empty and rises. A time that is not a number is the beginning.
KeyShares shares_at(std::span<const double> times, ShapeJoin join, double tension, double time);

// The shape at `time`. Normals, where both the keys and `out` have them, are summed likewise and
// brought to length 1; one that has none to speak of (under 1e-15) comes out as in the first of the
// keys that take part. Sums are worked out in doubles and rounded once. Allocates nothing with one
// job; `jobs` as in parallel_for, the same bytes for any.
void shape_at(const KeyFrameMesh& mesh, ShapeJoin join, double tension, double time,
              const MorphedSurface& out, int jobs = 1);

}  // namespace krok
