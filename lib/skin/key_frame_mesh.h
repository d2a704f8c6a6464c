#pragma once

#include <array>
#include <span>
#include <vector>

#include "core/result.h"
#include "math/transform.h"
#include "skin/morph.h"

// Per-vertex key-frame animation: shapes of one mesh at key times.

namespace krok {

struct KeyFrameMesh {
  std::vector<double> times;  // [keys] seconds, strictly increasing
  int vertex_count = 0;
  std::vector<Vec3f> positions;  // [keys x vertices] metres
  std::vector<Vec3f> normals;    // [keys x vertices] unit, or empty

  int key_count() const { return static_cast<int>(times.size()); }
};

// Requires at least one key, matching array lengths, increasing times and finite values. Codes
// key-mesh-shape, key-mesh-time, key-mesh-value.
Status check(const KeyFrameMesh& mesh);

// Interpolation between shapes. With p_i, t_i the keys, h = t_{i+1} - t_i and t in [0, 1] the
// fraction of h:
//
//   linear   p(t) = (1 - t) p_i + t p_{i+1}
//   hermite  p(t) = (2t^3 - 3t^2 + 1) p_i + (t^3 - 2t^2 + t) m_i
//                   + (3t^2 - 2t^3) p_{i+1} + (t^3 - t^2) m_{i+1}
//            with m_i = h v_i, v_i = (1 - a) (p_{i+1} - p_{i-1}) / (t_{i+1} - t_{i-1}) for a
//            tension a; one-sided differences at the first and last key. For evenly spaced keys
//            m_i = (1 - a) / 2 ((p_i - p_{i-1}) + (p_{i+1} - p_i)); for uneven spacing the velocity
//            is still continuous at keys (Kochanek and Bartels, Interpolating splines with local
//            tension, continuity, and bias control, SIGGRAPH 1984, section 4). a = 0 is
//            Catmull-Rom; a = 1 has zero velocity at each key.
enum class ShapeJoin : unsigned char { linear, hermite };

// The keys that contribute to a shape, and their weights, which sum to 1.
struct KeyShares {
  int count = 0;  // 1 to 4
  std::array<int, 4> keys{};
  std::array<double, 4> shares{};
};

// The weights at `time`: clamped to the first and last key; exactly one key at a key time. `times`
// is not empty and increasing. NaN counts as the start.
KeyShares shares_at(std::span<const double> times, ShapeJoin join, double tension, double time);

// The shape at `time`. Normals, if both the keys and `out` have them, are blended too and
// normalised; one with length below 1e-15 is taken from the first contributing key. Sums are
// computed in double and rounded once. Allocates nothing with one job; `jobs` as in parallel_for,
// the result does not depend on it.
void shape_at(const KeyFrameMesh& mesh, ShapeJoin join, double tension, double time,
              const MorphedSurface& out, int jobs = 1);

}  // namespace krok
