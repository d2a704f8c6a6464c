#include "plant/steady_internal.h"

#include <algorithm>
#include <cmath>

#include "plant/smooth_curve_internal.h"

namespace krok::plant {

namespace {

constexpr double kSharedCutoff = 4;  // Hz, above which movement may be jitter
// The variance of jitter, of what it has from frame to frame: most is slower than white noise.
constexpr double kSlower = 30;

// What is left of a curve after its slow part.
KnownCurve fast_part(const KnownCurve& curve, double rate) {
  const std::vector<Vec3> slow = smooth_curve(curve, {.rate = rate, .cutoff = kSharedCutoff});
  KnownCurve fast(curve.values.size());
  for (std::size_t f = 0; f < slow.size(); ++f) {
    if (curve.is_exact(f)) fast.set(f, curve.values[f] - slow[f]);
  }
  return fast;
}

// What takes the jitter out; `jitter` is the deviation of the pelvis'. Each foot that stands shows
// it, with an error of its own; so does the pelvis, with what it really moves. Their covariance is
// its variance, and what they vary by beyond that their errors'; the estimate is the mean with the
// inverse variances as weights, and with zero at the jitter's own (Wiener).
std::vector<Vec3> shared_jitter(const KnownCurve& hips, const std::vector<KnownCurve>& feet,
                                double jitter) {
  const std::size_t frames = hips.values.size();
  std::vector<Vec3> result(frames, Vec3::Zero());
  double both = 0, of_feet = 0, of_hips = 0;
  int count = 0;
  for (const KnownCurve& foot : feet) {
    for (std::size_t f = 0; f < frames; ++f) {
      if (!foot.is_exact(f)) continue;
      both += foot.values[f].dot(hips.values[f]);
      of_feet += foot.values[f].squaredNorm();
      of_hips += hips.values[f].squaredNorm();
      ++count;
    }
  }
  // Landings move feet and pelvis alike, too, but not where nothing jitters from frame to frame.
  both = std::min(both, 3 * kSlower * jitter * jitter * count);
  if (count < 3 || !(both > 0)) return result;
  constexpr double kLeast = 1e-3;  // of the jitter's variance
  const double foot_weight = both / std::max(of_feet - both, kLeast * both);
  const double hips_weight = both / std::max(of_hips - both, kLeast * both);
  for (std::size_t f = 0; f < frames; ++f) {
    Vec3 sum = hips_weight * hips.values[f];
    double weight = 1 + hips_weight;
    for (const KnownCurve& foot : feet) {
      if (!foot.is_exact(f)) continue;
      sum += foot_weight * foot.values[f];
      weight += foot_weight;
    }
    result[f] = sum / weight;
  }
  return result;
}

// Negative, for it is compared with what brings feet back.
KnownCurve pelvis_track(const PlantedBody& body, const Clip& clip) {
  KnownCurve hips(static_cast<std::size_t>(clip.frame_count()));
  for (int f = 0; f < clip.frame_count(); ++f) {
    hips.set(static_cast<std::size_t>(f), -joint_at(clip, f, body.pelvis).position);
  }
  return hips;
}

}  // namespace

double pelvis_jitter(const PlantedBody& body, const Clip& clip) {
  return jitter_of(pelvis_track(body, clip));
}

double steady(const PlantedBody& body, const std::vector<KnownCurve>& shifts, double jitter,
              Clip& clip) {
  const KnownCurve hips = pelvis_track(body, clip);
  std::vector<KnownCurve> feet;
  for (const KnownCurve& shift : shifts) feet.push_back(fast_part(shift, clip.rate));
  const std::vector<Vec3> still = shared_jitter(fast_part(hips, clip.rate), feet, jitter);
  double squares = 0;
  for (int f = 0; f < clip.frame_count(); ++f) {
    const Vec3& shift = still[static_cast<std::size_t>(f)];
    squares += shift.squaredNorm();
    for (std::size_t j = 0; j < body.bodies.size(); ++j) {
      if (body.bodies[j] == Body::none) continue;
      Vec3f& position = clip.frame_positions(f)[j];
      position = (position.cast<double>() + shift).cast<float>();
    }
  }
  return std::sqrt(squares / clip.frame_count());
}

}  // namespace krok::plant
