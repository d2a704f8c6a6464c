#include "settle/settle.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "core/index.h"
#include "math/quaternion.h"
#include "motion/ground_frame.h"
#include "ragdoll/bodies.h"
#include "retarget/stance.h"
#include "settle/settler_internal.h"

namespace krok {

namespace settling {

namespace {

// `share` of the values are below it.
double quantile(std::vector<double> values, double share) {
  if (values.empty()) return 0;
  const auto place = static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + place, values.end());
  return values[static_cast<std::size_t>(place)];
}

}  // namespace

Settler::Settler(const Clip& clip, const RoleMap& roles, const Terrain& ground,
                 const SettleOptions& options, std::vector<ragdoll::Body> bodies,
                 const Skeleton& neutral)
    : clip_(clip),
      roles_(roles),
      ground_(ground),
      options_(options),
      bodies_(std::move(bodies)),
      points_(support_points(bodies_, options.model)),
      hips_root_(clip, carrying_joint(roles)),
      rooted_(hips_root_.rooted(clip)),
      source_(local_motion(rooted_)),
      parents_(rooted_.skeleton.parents),
      scale_(ragdoll::extent(neutral) / 1.75) {
  points_of_.assign(bodies_.size(), {0, 0});
  for (std::size_t p = 0; p < points_.size(); ++p) {
    auto& [begin, end] = points_of_[at(points_[p].body)];
    if (end == 0) begin = p;
    end = p + 1;
  }
}

LocalMotion Settler::moved() const {
  LocalMotion motion = source_;
  for (int f = 0; f < frames(); ++f) {
    const Eigen::VectorXd& values = values_[at(f)];
    motion.joint_positions(0)[at(f)] += values.head<3>();
    for (std::size_t i = 0; i < freedoms_.size(); ++i) {
      Quat& turned = motion.joint_orientations(freedoms_[i].joint)[at(f)];
      turned =
          (from_rotation_vector(values.segment<3>(static_cast<Eigen::Index>(3 + 3 * i))) * turned)
              .normalized();
    }
  }
  return motion;
}

double Settler::differences_of(const LocalMotion& motion, const Eigen::Vector4d& factors) const {
  std::vector<double> differences;
  std::array<std::vector<Transform>, 4> poses;
  for (int f = 0; f < frames(); ++f) {
    std::rotate(poses.begin(), poses.begin() + 1, poses.end());
    poses[3] = pose_of(motion, f);
    if (f < 3) continue;
    for (const ragdoll::Body& body : bodies_) {
      Vec3 sum = Vec3::Zero();
      for (int i = 0; i < 4; ++i) sum += factors[i] * poses[at(i)][at(body.joint)].position;
      differences.push_back(sum.norm());
    }
  }
  return quantile(std::move(differences), 0.99);
}

Settled Settler::finish() {
  Settled settled;
  settled.floor = floor_;
  settled.before = fit_;
  settled.clip = clip_;
  LocalMotion motion = source_;
  if (!values_.empty()) {
    motion = moved();
    set_local_motion(motion, rooted_);
    settled.clip = hips_root_.restored(rooted_, clip_.skeleton);
    settled.clip.provenance = clip_.provenance;
    const Eigen::Vector4d third(-1, 3, -3, 1);
    const double jerk = differences_of(source_, third);
    if (jerk > 0) settled.jerk = differences_of(motion, third) / jerk;
    for (const Eigen::VectorXd& values : values_) {
      for (std::size_t i = 1; i < freedoms_.size(); ++i) {
        const double turn = std::abs(std::remainder(
            values.segment<3>(static_cast<Eigen::Index>(3 + 3 * i)).norm(), 2 * kPi));
        if (!(turn > settled.largest_turn)) continue;
        settled.largest_turn = turn;
        settled.turned_joint = freedoms_[i].joint;
      }
    }
    motion = local_motion(hips_root_.rooted(settled.clip));
  }
  const Heights on_ground = over_ground(motion);
  const Heights over_rest =
      heights(motion, [&](const SupportPoint& point, const Vec3& place, int frame) {
        return this->over_rest(point, place, frame);
      });
  settled.after = fit(on_ground, over_rest, over_source_.touches);
  const auto count = at(frames());
  std::pair<double, std::size_t> deepest = {0, 0}, highest = {0, 0};  // where, [bodies x frames]
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    for (std::size_t f = 0; f < count; ++f) {
      const double height = on_ground.of_bodies[b * count + f];
      if (-height > deepest.first) deepest = {-height, b * count + f};
    }
    for (const retarget::Stay& stay : over_source_.touches[b].stays) {
      SettledTouch touch{bodies_[b].name, stay.first, stay.last, 0, 0};
      for (int f = stay.first; f <= stay.last; ++f) {
        const double height = over_rest.of_bodies[b * count + at(f)];
        if (!std::isfinite(height)) continue;
        touch.depth = std::max(touch.depth, -on_ground.of_bodies[b * count + at(f)]);
        touch.hover = std::max(touch.hover, height);
        if (height > highest.first) highest = {height, b * count + at(f)};
      }
      settled.touches.push_back(touch);
    }
  }
  const auto warn = [&](const char* code, const std::pair<double, std::size_t>& worst,
                        const char* text) {
    if (worst.first <= kTolerated) return;
    Diagnostic warning = make_warning(
        code,
        fmt::format("{} is {:.1f} mm {} the ground at {:.3f} s ({} are tolerated)",
                    bodies_[worst.second / count].name, 1000 * worst.first, text,
                    static_cast<double>(worst.second % count) / clip_.rate, 1000 * kTolerated),
        "smoother ground there, or another place for the motion");
    warning.frame = static_cast<std::int64_t>(worst.second % count);
    settled.warnings.push_back(std::move(warning));
  };
  warn("settle-depth", deepest, "in");
  warn("settle-hover", highest, "above");
  if (without_ground_ > 0) {
    settled.warnings.push_back(
        make_warning("settle-partly",
                     fmt::format("there is no ground under the hips in {} of {} frames",
                                 without_ground_, frames()),
                     "a larger ground, or another place for the motion"));
  }
  return settled;
}

}  // namespace settling

Result<Settled> settle(const Clip& clip, const RoleMap& roles, const Terrain& ground,
                       const SettleOptions& options) {
  if (Status status = check(clip); !status) return status.error();
  if (clip.frame_count() == 0) {
    Settled settled;
    settled.clip = clip;
    return settled;
  }
  const Skeleton neutral = retarget::neutral_skeleton(clip, roles);
  ragdoll::BodyOptions how;
  how.model = options.model;
  auto bodies = ragdoll::make_bodies(neutral, roles, how);
  if (!bodies) return bodies.error();
  settling::Settler settler(clip, roles, ground, options, *std::move(bodies), neutral);
  if (Status status = settler.find_ground(); !status) return status.error();
  if (settler.lies_already()) return settler.finish();
  settler.find_freedoms();
  settler.solve();
  Settled settled = settler.finish();
  const auto misfit = [](const GroundFit& fit) { return std::max(fit.depth, fit.hover); };
  if (misfit(settled.after) <= misfit(settled.before)) return settled;
  settler.keep_source();
  return settler.finish();
}

}  // namespace krok
