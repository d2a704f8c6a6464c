#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/index.h"
#include "core/parallel.h"
#include "math/hermite.h"
#include "math/window.h"
#include "scene/frame_source.h"
#include "settle/settler_internal.h"

namespace krok::settling {

namespace {

// Of a person of 1.75 m. Metres per second, seconds.
constexpr double kRising = 0.3, kShortest = 0.06;
constexpr double kSoft = 0.06, kFade = 0.2, kTread = 0.04;  // seconds
constexpr double kStep = 0.02;                              // metres, from one tread to another
// A motion follows the ground that touches it about as long and as closely as a level floor, or
// longer and is not in it, or for some time and is not in it where it is in the level floor.
constexpr double kLittle = 0.003, kAlike = 0.9, kClearly = 0.2, kSome = 0.25;

}  // namespace

void fill_gaps(std::span<double> values) {
  const auto known = [](double value) { return !std::isnan(value); };
  const auto first = std::ranges::find_if(values, known);
  double last = first == values.end() ? 0 : *first;
  for (double& value : values) {
    if (known(value)) last = value;
    value = last;
  }
}

std::vector<Transform> Settler::pose_of(const LocalMotion& motion, int frame) const {
  std::vector<Transform> pose(parents_.size());
  for (int j = 0; j < motion.joints; ++j) {
    const int parent = parents_[at(j)];
    pose[at(j)] = parent < 0 ? motion.at(j, frame) : pose[at(parent)] * motion.at(j, frame);
  }
  return pose;
}

void Settler::each(const FrameSource& rooted,
                   const std::function<void(int first, LocalMotion& block)>& use) const {
  if (!status_) return;
  status_ = for_each_run(rooted, {4096, 0}, options_.jobs, [&](const FrameRun& run) {
    LocalMotion block = local_motion(run.clip);
    use(run.first, block);
    return Status();
  });
}

Heights Settler::heights(const FrameSource& rooted, const Over& over) const {
  Heights heights;
  const auto count = at(frames());
  heights.of_bodies.assign(count * bodies_.size(), std::numeric_limits<double>::infinity());
  each(rooted, [&](int first, const LocalMotion& block) {
    parallel_for(at(block.frames), 16, options_.jobs, [&](std::size_t begin, std::size_t end) {
      for (int i = static_cast<int>(begin); i < static_cast<int>(end); ++i) {
        const std::vector<Transform> pose = pose_of(block, i);
        for (const SupportPoint& point : points_) {
          const int joint = bodies_[at(point.body)].joint;
          const double height = over(point, pose[at(joint)] * point.centre, first + i);
          double& lowest = heights.of_bodies[at(point.body) * count + at(first + i)];
          lowest = std::min(lowest, height);
        }
      }
    });
  });
  const retarget::TouchLimits limits = {kNear * scale_, kFar * scale_, kRising * scale_, kShortest};
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    const std::span<const double> distance(heights.of_bodies.data() + b * count, count);
    std::vector<double> rising(count, 0);
    for (std::size_t f = 0; f < count && count > 1; ++f) {
      const std::size_t before = f == 0 ? 0 : f - 1, after = std::min(f + 1, count - 1);
      rising[f] = std::abs(distance[after] - distance[before]) * rooted_.rate /
                  static_cast<double>(after - before);
    }
    heights.stays.push_back(retarget::find_touch(distance, rising, limits, rooted_.rate).stays);
  }
  return heights;
}

Heights Settler::over_ground(const FrameSource& rooted) const {
  return heights(rooted, [&](const SupportPoint& point, const Vec3& place, int) {
    return clearance(ground_, place, point.radius);
  });
}

// The median height of the lowest part where it hardly rises or falls.
double Settler::usual(const Heights& heights) const {
  const auto count = at(frames());
  std::vector<double> lowest(count, std::numeric_limits<double>::infinity()), still;
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    for (std::size_t f = 0; f < count; ++f) {
      lowest[f] = std::min(lowest[f], heights.of_bodies[b * count + f]);
    }
  }
  for (std::size_t f = 0; f < count; ++f) {
    const double change = f + 1 < count ? (lowest[f + 1] - lowest[f]) * rooted_.rate : 0;
    if (std::isfinite(lowest[f]) && std::abs(change) < kRising * scale_) still.push_back(lowest[f]);
  }
  if (still.empty()) {
    std::ranges::copy_if(lowest, std::back_inserter(still),
                         [](double h) { return std::isfinite(h); });
  }
  if (still.empty()) return std::numeric_limits<double>::infinity();
  return median(std::move(still));
}

GroundFit Settler::fit(const Heights& on_ground, const Heights& over_rest,
                       const Stays& touches) const {
  GroundFit fit;
  const auto count = at(frames());
  for (const double height : on_ground.of_bodies) fit.depth = std::max(fit.depth, -height);
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    for (const retarget::Stay& stay : touches[b]) {
      for (int f = stay.first; f <= stay.last; ++f) {
        const double height = over_rest.of_bodies[b * count + at(f)];
        if (std::isfinite(height)) fit.hover = std::max(fit.hover, height);
      }
    }
  }
  return fit;
}

void Settler::find_steps() {
  Vec2 low = Vec2::Constant(std::numeric_limits<double>::infinity()), high = -low;
  const auto count = at(frames());
  on_tread_.assign(bodies_.size() * count, 0);
  each(rooted_, [&](int first, const LocalMotion& block) {
    for (int i = 0; i < block.frames; ++i) {
      const std::vector<Transform> pose = pose_of(block, i);
      for (std::size_t b = 0; b < bodies_.size(); ++b) {
        const int joint = bodies_[b].joint, parent = parents_[at(joint)];
        const Vec3& place = pose[at(joint)].position;
        low = low.cwiseMin(Vec2(place.x(), place.z()));
        high = high.cwiseMax(Vec2(place.x(), place.z()));
        const Role role = roles_.roles[at(joint)];
        if (parent < 0 || (role != Role::left_foot && role != Role::right_foot)) continue;
        const Vec3 shank = (pose[at(parent)].position - place).normalized();
        on_tread_[b * count + at(first + i)] =
            upright(pose) * smoother_step((shank.y() - 0.3) / 0.4);
      }
    }
  });
  if (!status_) return;
  rolled_ = std::make_unique<RolledGround>(ground_, low, high, options_.jobs);
  if (rolled_->has_steps()) return;
  rolled_.reset();
  on_tread_ = {};
}

// A foot of an upright body rests on the highest tread that it is over. In the air, and from one
// tread to another, it is over the ramp, so that nothing jumps.
void Settler::find_treads() {
  if (!rolled_) return;
  const auto count = at(frames());
  const int reach = std::max(1, static_cast<int>(std::lround(kTread * rooted_.rate)));
  const auto softened = [&](std::span<const double> values) {
    return mean_within(mean_within(max_within(values, 2 * reach), reach), reach);
  };
  treads_.assign(on_tread_.size(), -std::numeric_limits<double>::infinity());
  each(rooted_, [&](int first, const LocalMotion& block) {
    for (int i = 0; i < block.frames; ++i) {
      const std::vector<Transform> pose = pose_of(block, i);
      for (const SupportPoint& point : points_) {
        const std::size_t b = at(point.body), f = b * count + at(first + i);
        if (on_tread_[f] == 0) continue;
        const auto under = surface_at(ground_, pose[at(bodies_[b].joint)] * point.centre);
        if (under) treads_[f] = std::max(treads_[f], under->height);
      }
    }
  });
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    const auto treads = std::span(treads_).subspan(b * count, count);
    std::vector<double> touched(count, 0), changes(count, 0);
    for (std::size_t f = 0; f < count; ++f) {
      if (on_tread_[b * count + f] == 0) continue;
      touched[f] = touches(b, f) ? 1 : 0;
      if (f > 0 && !(std::abs(treads[f] - treads[f - 1]) < kStep)) changes[f - 1] = changes[f] = 1;
    }
    const std::vector<double> near = softened(touched), moves = softened(changes);
    for (std::size_t f = 0; f < count; ++f) on_tread_[b * count + f] *= near[f] * (1 - moves[f]);
  }
}

double Settler::over_rest(const SupportPoint& point, const Vec3& place, int frame) const {
  if (!rolled_) return clearance(ground_, place, point.radius);
  const std::size_t i = at(point.body) * at(frames()) + at(frame);
  double height = 0;
  if (on_tread_[i] > 0) {
    height += on_tread_[i] * (treads_.empty() ? clearance(ground_, place, point.radius)
                                              : place.y() - point.radius - treads_[i]);
  }
  if (on_tread_[i] < 1) height += (1 - on_tread_[i]) * clearance(*rolled_, place, point.radius);
  return on_tread_[i] > 0 ? std::min(height, clearance(ground_, place, point.radius)) : height;
}

Vec3 Settler::slope_under(const SupportPoint& point, const Vec3& place, int frame) const {
  const auto under = surface_at(rolled_ ? static_cast<const Terrain&>(*rolled_) : ground_, place);
  if (!under) return Vec3::Zero();
  const double level = rolled_ ? on_tread_[at(point.body) * at(frames()) + at(frame)] : 0;
  return (level - 1) / under->normal.y() * Vec3(under->normal.x(), 0, under->normal.z());
}

Status Settler::find_ground() {
  find_steps();
  const auto over_rest = [&](const SupportPoint& point, const Vec3& place, int frame) {
    return this->over_rest(point, place, frame);
  };
  Heights on_ground = heights(rooted_, over_rest);
  const double ground_height = usual(on_ground);
  // What rests on a tread is deep in the ramp over it, and not in the ground.
  const Heights over_steps = rolled_ ? over_ground(rooted_) : Heights();
  const Heights& clear = rolled_ ? over_steps : on_ground;
  const auto over_level = [](const SupportPoint& point, const Vec3& place, int) {
    return place.y() - point.radius;
  };
  floor_ = options_.floor ? *options_.floor : usual(heights(rooted_, over_level));
  Heights over_floor = heights(rooted_, [&](const SupportPoint& point, const Vec3& place, int) {
    return place.y() - point.radius - floor_;
  });
  fit_ = fit(clear, on_ground, on_ground.stays);
  const GroundFit on_level = fit(over_floor, over_floor, over_floor.stays);
  const auto misfit = [](const GroundFit& fit) { return std::max(fit.depth, fit.hover); };
  const auto touching = [](const Heights& over) {  // frames, of all parts
    int sum = 0;
    for (const auto& stays : over.stays) {
      for (const retarget::Stay& stay : stays) sum += stay.last - stay.first + 1;
    }
    return sum;
  };
  const int on_it = touching(on_ground), on_level_floor = touching(over_floor);
  const double level_misfit = misfit(on_level);
  const bool closely = misfit(fit_) <= level_misfit + kLittle * scale_;
  const bool longer = kAlike * on_it > on_level_floor && fit_.depth <= kTolerated;
  // What settle() made of a roll is over the ground more often than on it; the level floor that it
  // would usually touch is above its lowest parts.
  const bool kept_out = on_it > 0 && on_it >= kSome * on_level_floor && fit_.depth <= kTolerated &&
                        on_level.depth > 2 * kTolerated;
  const bool near = std::abs(ground_height) <= kNear * scale_ &&
                    (misfit(fit_) < kClearly * level_misfit || longer ||
                     (closely && on_it >= kAlike * on_level_floor));
  follows_ground_ = !options_.floor && (near || kept_out);
  lies_already_ = follows_ground_ && fit_.depth <= kNear * scale_;
  if (!follows_ground_) fit_ = fit(clear, on_ground, over_floor.stays);
  set_goals(std::move(follows_ground_ ? on_ground : over_floor));
  if (!follows_ground_) find_treads();
  // What is under the hips, carried over gaps.
  ground_below_.assign(at(frames()), std::numeric_limits<double>::quiet_NaN());
  Vec3 hips = Vec3::Zero();  // in the first frame
  each(rooted_, [&](int first, const LocalMotion& block) {
    if (first == 0) hips = block.at(0, 0).position;
    for (int i = 0; i < block.frames; ++i) {
      const Terrain& under = rolled_ ? static_cast<const Terrain&>(*rolled_) : ground_;
      const auto found = surface_at(under, block.at(0, i).position);
      if (!found) ++without_ground_;
      const std::size_t f = at(first + i);
      if (found) ground_below_[f] = (follows_ground_ ? 0 : found->height - floor_) + lift_[f];
    }
  });
  if (!status_) return status_;
  if (without_ground_ == frames()) {
    return Error("settle-ground",
                 fmt::format("there is no ground under the motion, which begins at x {:.2f} m, z "
                             "{:.2f} m",
                             hips.x(), hips.z()),
                 "a larger ground, or move the motion onto it (krok-edit --move, --at-origin)");
  }
  fill_gaps(ground_below_);
  ground_below_ = mean_within(ground_below_, static_cast<int>(std::lround(0.2 * rooted_.rate)));
  return {};
}

// How far the body is off the ground as a whole: what all parts that touch are in it by, or, below
// 0, above it. A body that is lifted stays as it is; by turning joints it would crouch.
std::vector<double> Settler::common_lift(const Heights& source) const {
  const auto count = at(frames());
  std::vector<double> lift(count, std::numeric_limits<double>::quiet_NaN());
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    for (const retarget::Stay& stay : source.stays[b]) {
      for (int f = stay.first; f <= stay.last; ++f) {
        const double own = -source.of_bodies[b * count + at(f)];
        if (!std::isfinite(own)) continue;
        double& all = lift[at(f)];
        if (std::isnan(all)) {
          all = own;
        } else {
          all = own * all <= 0 ? 0 : std::abs(own) < std::abs(all) ? own : all;
        }
      }
    }
  }
  fill_gaps(lift);
  const int reach = std::max(1, static_cast<int>(std::lround(kSoft * rooted_.rate)));
  return mean_within(mean_within(lift, reach), reach);
}

// How high each part should be over the ground: as in the source, but that those which touch are
// lowered or raised until their lowest point lies on it.
void Settler::set_goals(Heights source) {
  over_source_ = std::move(source);
  const auto count = at(frames());
  lift_ = common_lift(over_source_);
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    const auto lowest = std::span(over_source_.of_bodies).subspan(b * count, count);
    std::vector<double> depth;
    for (const double height : lowest) depth.push_back(std::max(0.0, -height));
    const int reach = std::max(1, static_cast<int>(std::lround(kSoft * rooted_.rate)));
    depth = mean_within(mean_within(max_within(depth, 2 * reach), reach), reach);
    // Of the height in a stay nothing is left; before and after it is taken away, less and less.
    std::vector<double> lowered(count, 0);
    const int fade = std::max(1, static_cast<int>(std::lround(kFade * rooted_.rate)));
    for (const retarget::Stay& stay : over_source_.stays[b]) {
      for (int f = std::max(0, stay.first - fade); f <= std::min(frames() - 1, stay.last + fade);
           ++f) {
        const std::size_t in_stay = at(std::clamp(f, stay.first, stay.last));
        const int away = std::abs(f - static_cast<int>(in_stay));
        const double part = 1 - smoother_step(static_cast<double>(away) / fade);
        lowered[at(f)] = std::max(lowered[at(f)], part * (lowest[in_stay] + depth[in_stay]));
      }
    }
    for (std::size_t f = 0; f < count; ++f) {
      raised_.push_back(std::max(depth[f], lift_[f]) - std::max(lowered[f], -lift_[f]));
    }
  }
  over_source_.of_bodies = {};
}

}  // namespace krok::settling
