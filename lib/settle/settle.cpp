#include "settle/settle.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "core/index.h"
#include "math/quaternion.h"
#include "motion/hips_root.h"
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

FrameSource rooted(const FrameSource& frames, const HipsRoot& hips_root) {
  if (!hips_root.changes()) return frames;
  FrameSource result = changed(frames, [hips_root](Clip& part) {
    part = hips_root.rooted(part);
    return Status();
  });
  result.skeleton = hips_root.rooted(frames.skeleton);
  return result;
}

}  // namespace

Settler::Settler(FrameSource frames, HipsRoot hips_root, const RoleMap& roles,
                 const Terrain& ground, const SettleOptions& options,
                 std::vector<ragdoll::Body> bodies, const Skeleton& neutral)
    : frames_(std::move(frames)),
      roles_(roles),
      ground_(ground),
      options_(options),
      bodies_(std::move(bodies)),
      points_(support_points(bodies_, options.model)),
      hips_root_(std::move(hips_root)),
      rooted_(rooted(frames_, hips_root_)),
      parents_(rooted_.skeleton.parents),
      scale_(ragdoll::extent(neutral) / 1.75) {
  points_of_.assign(bodies_.size(), {0, 0});
  for (std::size_t p = 0; p < points_.size(); ++p) {
    auto& [begin, end] = points_of_[at(points_[p].body)];
    if (end == 0) begin = p;
    end = p + 1;
  }
}

void Settler::move(int first, LocalMotion& block) const {
  for (int f = 0; f < block.frames; ++f) {
    const Eigen::VectorXd& values = values_[at(first + f)];
    block.joint_positions(0)[at(f)] += values.head<3>();
    for (std::size_t i = 0; i < freedoms_.size(); ++i) {
      Quat& turned = block.joint_orientations(freedoms_[i].joint)[at(f)];
      turned =
          (from_rotation_vector(values.segment<3>(static_cast<Eigen::Index>(3 + 3 * i))) * turned)
              .normalized();
    }
  }
}

double Settler::differences(bool moved, const Eigen::Vector4d& factors) const {
  std::vector<double> all;
  all.reserve(at(frames()) * bodies_.size());
  std::array<std::vector<Transform>, 4> poses;
  each(rooted_, [&](int first, LocalMotion& block) {
    if (moved) move(first, block);
    for (int f = 0; f < block.frames; ++f) {
      std::rotate(poses.begin(), poses.begin() + 1, poses.end());
      poses[3] = pose_of(block, f);
      if (first + f < 3) continue;
      for (const ragdoll::Body& body : bodies_) {
        Vec3 sum = Vec3::Zero();
        for (int i = 0; i < 4; ++i) sum += factors[i] * poses[at(i)][at(body.joint)].position;
        all.push_back(sum.norm());
      }
    }
  });
  return quantile(std::move(all), 0.99);
}

Result<Settled> Settler::finish(const std::shared_ptr<const Settler>& self) {
  Settled settled;
  settled.floor = floor_;
  settled.before = fit_;
  settled.frames = frames_;
  if (!values_.empty()) {
    settled.frames.read = [self](int first, int count, std::span<Vec3f> positions,
                                 std::span<Quatf> orientations) -> Status {
      auto clip = load(part_of(self->rooted_, first, count), 1);
      if (!clip) return clip.error();
      LocalMotion motion = local_motion(*clip);
      self->move(first, motion);
      set_local_motion(motion, *clip);
      const Clip restored = self->hips_root_.restored(*clip, self->frames_.skeleton);
      std::ranges::copy(restored.positions, positions.begin());
      std::ranges::copy(restored.orientations, orientations.begin());
      return {};
    };
    const Eigen::Vector4d third(-1, 3, -3, 1);
    const double jerk = differences(false, third);
    if (jerk > 0) settled.jerk = differences(true, third) / jerk;
    for (const Eigen::VectorXd& values : values_) {
      for (std::size_t i = 1; i < freedoms_.size(); ++i) {
        const double turn = std::abs(std::remainder(
            values.segment<3>(static_cast<Eigen::Index>(3 + 3 * i)).norm(), 2 * kPi));
        if (!(turn > settled.largest_turn)) continue;
        settled.largest_turn = turn;
        settled.turned_joint = freedoms_[i].joint;
      }
    }
  }
  const FrameSource motion = rooted(settled.frames, hips_root_);
  const Heights on_ground = over_ground(motion);
  Heights over_steps;
  if (rolled_) {
    over_steps = heights(motion, [&](const SupportPoint& point, const Vec3& place, int frame) {
      return this->over_rest(point, place, frame);
    });
  }
  if (!status_) return status_.error();
  const Heights& over_rest = rolled_ ? over_steps : on_ground;
  settled.after = fit(on_ground, over_rest, over_source_.stays);
  const auto count = at(frames());
  std::pair<double, std::size_t> deepest = {0, 0}, highest = {0, 0};  // where, [bodies x frames]
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    for (std::size_t f = 0; f < count; ++f) {
      const double height = on_ground.of_bodies[b * count + f];
      if (-height > deepest.first) deepest = {-height, b * count + f};
    }
    for (const retarget::Stay& stay : over_source_.stays[b]) {
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
                    static_cast<double>(worst.second % count) / frames_.rate, 1000 * kTolerated),
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
  auto settled = settle(frames_of(clip), roles, ground, options);
  if (!settled) return settled;
  auto made = load(settled->frames, options.jobs);
  if (!made) return made.error();
  settled->clip = *std::move(made);
  settled->clip.provenance = clip.provenance;
  settled->frames = {};
  return settled;
}

Result<Settled> settle(const FrameSource& source, const RoleMap& roles, const Terrain& ground,
                       const SettleOptions& options) {
  if (source.frame_count == 0) {
    Settled settled;
    settled.frames = source;
    return settled;
  }
  const auto neutral = retarget::neutral_skeleton(source, roles);
  if (!neutral) return neutral.error();
  ragdoll::BodyOptions how;
  how.model = options.model;
  auto bodies = ragdoll::make_bodies(*neutral, roles, how);
  if (!bodies) return bodies.error();
  auto hips_root = HipsRoot::of(source, carrying_joint(roles), options.jobs);
  if (!hips_root) return hips_root.error();
  const auto settler = std::make_shared<settling::Settler>(
      source, *std::move(hips_root), roles, ground, options, *std::move(bodies), *neutral);
  if (Status status = settler->find_ground(); !status) return status.error();
  if (settler->lies_already()) return settler->finish(settler);
  settler->find_freedoms();
  settler->solve();
  auto settled = settler->finish(settler);
  if (!settled) return settled;
  const auto misfit = [](const GroundFit& fit) { return std::max(fit.depth, fit.hover); };
  if (misfit(settled->after) <= misfit(settled->before)) return settled;
  settler->keep_source();
  return settler->finish(settler);
}

}  // namespace krok
