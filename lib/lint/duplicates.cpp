#include "lint/duplicates.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/index.h"
#include "roles/roles.h"

namespace krok::lint {

namespace {

constexpr double kMoments = 16;  // at least, of a motion
constexpr double kSameDuration = 0.02;
constexpr float kHeld = 0.052F;  // 3 degrees, as a distance of unit vectors

}  // namespace

Signature signature_of(const FrameSource& motion, const RoleMap& roles) {
  std::vector<std::pair<int, int>> bones;
  for (std::size_t side = 0; side < 2; ++side) {
    const auto add = [&](Role upper, Role lower) {
      bones.emplace_back(roles.joint(upper), roles.joint(lower));
    };
    add(kLegRoles[side].upper, kLegRoles[side].lower);
    add(kLegRoles[side].lower, kLegRoles[side].foot);
    add(kArmRoles[side].upper, kArmRoles[side].lower);
    add(kArmRoles[side].lower, kArmRoles[side].hand);
  }
  const int hips = roles.joint(Role::hips), frames = motion.frame_count;
  std::erase_if(bones, [](const auto& bone) { return bone.first < 0 || bone.second < 0; });
  Signature signature{motion.duration(), {}};
  if (hips < 0 || bones.size() < 4 || frames < 3) return signature;
  // The hips' frame differs between exporters of one capture; that of the reference pose does not.
  const Quatf reference = motion.skeleton.reference[at(hips)].orientation.cast<float>();
  // Times from the beginning, by a power of two of seconds: a frame more or less at the end, as
  // other rates have it, moves none of them.
  const double step = std::exp2(std::floor(std::log2(signature.duration / kMoments)));
  const std::size_t joints = motion.skeleton.names.size();
  std::vector<Vec3f> places(2 * joints);
  std::vector<Quatf> turns(2 * joints);
  for (int m = 0; m * step <= signature.duration; ++m) {
    const double place = std::min<double>(m * step * motion.rate, frames - 1);
    const int first = std::min(frames - 2, static_cast<int>(place));
    const auto share = static_cast<float>(place - first);
    if (!motion.read(first, 2, places, turns)) return {};
    const auto direction = [&](std::size_t frame, const std::pair<int, int>& bone) {
      const Vec3f* const at_frame = &places[frame * joints];
      const Quatf turn = turns[frame * joints + at(hips)] * reference.conjugate();
      return Vec3f(turn.conjugate() * (at_frame[bone.second] - at_frame[bone.first]));
    };
    for (const auto& bone : bones) {
      const Vec3f mixed = (1 - share) * direction(0, bone) + share * direction(1, bone);
      signature.directions.push_back(mixed.normalized());
    }
  }
  float moved = 0;
  for (std::size_t i = bones.size(); i < signature.directions.size(); ++i) {
    moved =
        std::max(moved, (signature.directions[i] - signature.directions[i % bones.size()]).norm());
  }
  if (moved < kHeld) signature.directions.clear();
  return signature;
}

std::vector<std::pair<int, int>> find_duplicates(std::span<const Signature> signatures,
                                                 double radians) {
  std::vector<int> order(signatures.size());
  std::iota(order.begin(), order.end(), 0);
  std::ranges::stable_sort(order, {}, [&](int i) { return signatures[at(i)].duration; });
  const auto limit = static_cast<float>(2 * std::sin(radians / 2));
  std::vector<int> same(signatures.size(), -1);
  for (std::size_t i = 0; i < order.size(); ++i) {
    const Signature& a = signatures[at(order[i])];
    if (a.directions.empty()) continue;
    for (std::size_t k = i + 1; k < order.size(); ++k) {
      const Signature& b = signatures[at(order[k])];
      if (b.duration > a.duration * (1 + kSameDuration)) break;
      const std::size_t common = std::min(a.directions.size(), b.directions.size());
      if (4 * common < 3 * std::max(a.directions.size(), b.directions.size())) continue;
      const bool equal = std::ranges::equal(
          std::span(a.directions).first(common), std::span(b.directions).first(common),
          [&](const Vec3f& x, const Vec3f& y) { return (x - y).squaredNorm() <= limit * limit; });
      if (!equal) continue;
      const int first = std::min(order[i], order[k]), second = std::max(order[i], order[k]);
      int& found = same[at(second)];
      if (found < 0 || first < found) found = first;
    }
  }
  std::vector<std::pair<int, int>> pairs;
  for (std::size_t i = 0; i < same.size(); ++i) {
    if (same[i] >= 0) pairs.emplace_back(same[i], static_cast<int>(i));
  }
  return pairs;
}

}  // namespace krok::lint
