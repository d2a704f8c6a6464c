#include <algorithm>
#include <cmath>

#include "core/index.h"
#include "core/parallel.h"
#include "motion/ground_frame.h"
#include "motion/sample.h"
#include "timeline/paces_internal.h"

namespace krok::timeline {

namespace {

constexpr std::size_t kMaxMoments = 4000;
constexpr double kUsualPart = 0.99;
constexpr double kFaster = 1.5, kSlow = 0.3;  // metres per second
constexpr double kHarder = 2.5, kSoft = 10;   // metres per second squared

}  // namespace

TrackedJoints tracked_joints(const RoleMap& roles) {
  TrackedJoints joints;
  joints.hips = carrying_joint(roles);
  for (const Role role : {Role::left_foot, Role::right_foot, Role::left_toes, Role::right_toes}) {
    const int joint = roles.joint(role);
    if (joint >= 0) joints.feet.push_back(joint);
  }
  return joints;
}

std::array<PaceNow, kPaces> paces_of(const TrackedJoints& joints, std::span<const Transform> before,
                                     std::span<const Transform> now,
                                     std::span<const Transform> next, double rate) {
  std::array<PaceNow, kPaces> paces;
  const auto add = [&](PaceOf of, double value, int joint) {
    if (value > paces[of].value) paces[of] = {value, joint};
  };
  const auto look_at = [&](int joint, PaceOf speed, PaceOf acceleration) {
    const Vec3 step = next[at(joint)].position - now[at(joint)].position;
    const Vec3 step_before = now[at(joint)].position - before[at(joint)].position;
    add(speed, step.norm() * rate, joint);
    add(acceleration, (step - step_before).norm() * rate * rate, joint);
  };
  look_at(joints.hips, hips_speed, hips_acceleration);
  for (const int joint : joints.feet) look_at(joint, feet_speed, feet_acceleration);
  return paces;
}

std::array<double, kPaces> usual_paces(const TrackedJoints& joints, const Clip& clip, double speed,
                                       double rate, int jobs) {
  std::array<double, kPaces> usual = {};
  const double step = std::abs(speed) / rate;  // of the source's time
  const double steps = std::floor(clip.duration() / step + 1e-6);
  if (!(steps >= 2)) return usual;
  const double moments = std::min(steps - 1, static_cast<double>(kMaxMoments));
  std::vector<std::array<PaceNow, kPaces>> paces(static_cast<std::size_t>(moments));
  const double stride = std::floor((steps - 1) / moments);
  parallel_for(paces.size(), 64, jobs, [&](std::size_t begin, std::size_t end) {
    const std::size_t count = clip.skeleton.names.size();
    std::array<std::vector<Transform>, 3> poses;
    for (auto& pose : poses) pose.resize(count);
    std::vector<Transform> scratch(3 * count);
    for (std::size_t i = begin; i < end; ++i) {
      for (int k = 0; k < 3; ++k) {
        sample(clip, (static_cast<double>(i) * stride + k) * step, poses[at(k)], scratch);
      }
      paces[i] = paces_of(joints, poses[0], poses[1], poses[2], rate);
    }
  });
  std::vector<double> values(paces.size());
  for (std::size_t of = 0; of < usual.size(); ++of) {
    std::ranges::transform(paces, values.begin(), [&](const auto& one) { return one[of].value; });
    const auto place =
        static_cast<std::ptrdiff_t>(kUsualPart * static_cast<double>(values.size() - 1));
    std::nth_element(values.begin(), values.begin() + place, values.end());
    usual[of] = values[static_cast<std::size_t>(place)];
  }
  return usual;
}

std::optional<PaceOf> worst_pace(const std::array<Pace, kPaces>& paces) {
  std::optional<PaceOf> worst;
  double furthest = 1;
  for (const PaceOf of : {hips_speed, feet_speed, hips_acceleration, feet_acceleration}) {
    const bool speed = of == hips_speed || of == feet_speed;
    const double allowed = speed ? std::max(kFaster * paces[of].usual, kSlow)
                                 : std::max(kHarder * paces[of].usual, kSoft);
    if (paces[of].most / allowed <= furthest) continue;
    furthest = paces[of].most / allowed;
    worst = of;
  }
  return worst;
}

}  // namespace krok::timeline
