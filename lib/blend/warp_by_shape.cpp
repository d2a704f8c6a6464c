#include "blend/warp_by_shape.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/index.h"
#include "core/parallel.h"
#include "motion/hips_root.h"
#include "motion/sample.h"

namespace krok::blend {

namespace {

constexpr int kMaxMoments = 1000;
constexpr double kUsualRate = 30;
constexpr double kVelocityTime = 0.1;  // seconds

// A motion sampled at evenly spaced moments from start to end: joint positions relative to the
// ground frame, and their velocities.
class Shapes {
 public:
  Shapes(const Clip& clip, int carrier, int moments) {
    // A root that does not move with the hips says nothing about the pose.
    const auto moves = subtree(clip.skeleton, carrier);
    joints_ = static_cast<int>(std::ranges::count(moves, 1));
    std::vector<Transform> pose(clip.skeleton.names.size()), scratch(3 * pose.size());
    const double step = clip.duration() / (moments - 1);
    for (int i = 0; i < moments; ++i) {
      sample(clip, i * step, pose, scratch);
      const Transform world_to_place =
          ground_frame(clip.skeleton, carrier, pose[at(carrier)]).to_world().inverse();
      for (std::size_t j = 0; j < pose.size(); ++j) {
        if (moves[j] == 0) continue;
        positions_.push_back((world_to_place * pose[j].position).cast<float>());
      }
    }
    velocities_.resize(positions_.size());
    for (int i = 0; i < moments; ++i) {
      const int before = std::max(0, i - 1), after = std::min(moments - 1, i + 1);
      const auto scale = static_cast<float>(kVelocityTime / (step * (after - before)));
      for (int j = 0; j < joints_; ++j) {
        velocities_[at(i * joints_ + j)] =
            scale * (positions_[at(after * joints_ + j)] - positions_[at(before * joints_ + j)]);
      }
    }
  }

  double distance(int moment, const Shapes& other, int other_moment) const {
    const Vec3f* p = &positions_[at(moment * joints_)];
    const Vec3f* q = &other.positions_[at(other_moment * joints_)];
    const Vec3f* v = &velocities_[at(moment * joints_)];
    const Vec3f* w = &other.velocities_[at(other_moment * joints_)];
    float sum = 0;
    for (int j = 0; j < joints_; ++j)
      sum += (p[j] - q[j]).squaredNorm() + (v[j] - w[j]).squaredNorm();
    return std::sqrt(static_cast<double>(sum) / joints_);
  }

 private:
  int joints_ = 0;
  std::vector<Vec3f> positions_, velocities_;  // [moments x joints]
};

// The cheapest path from (0, 0) to (n - 1, n - 1): for each moment of the first motion the
// (fractional) moment of the second.
std::vector<double> find_path(const Shapes& first, const Shapes& second, int n, double band) {
  const int reach = std::max(2, static_cast<int>(std::ceil(band * n)));
  const int width = 2 * reach + 1;
  constexpr double kFar = std::numeric_limits<double>::infinity();
  std::vector<double> distance(at(n) * at(width), kFar), cost(distance.size(), kFar);
  std::vector<char> from(distance.size(), 0);
  const auto place = [&](int i, int j) { return at(i) * at(width) + at(j - i + reach); };
  const auto inside = [&](int i, int j) {
    return i >= 0 && j >= 0 && i < n && j < n && std::abs(j - i) <= reach;
  };
  for (int i = 0; i < n; ++i) {
    for (int j = std::max(0, i - reach); j <= std::min(n - 1, i + reach); ++j) {
      distance[place(i, j)] = first.distance(i, second, j);
    }
  }
  cost[place(0, 0)] = distance[place(0, 0)];
  for (int i = 1; i < n; ++i) {
    for (int j = std::max(1, i - reach); j <= std::min(n - 1, i + reach); ++j) {
      const double here = distance[place(i, j)];
      double& best = cost[place(i, j)];
      const auto consider = [&](int back_i, int back_j, double way, char step) {
        if (!inside(back_i, back_j) || cost[place(back_i, back_j)] + way >= best) return;
        best = cost[place(back_i, back_j)] + way;
        from[place(i, j)] = step;
      };
      consider(i - 1, j - 1, 2 * here, 1);
      if (inside(i, j - 1)) consider(i - 1, j - 2, 2 * distance[place(i, j - 1)] + here, 2);
      if (inside(i - 1, j)) consider(i - 2, j - 1, 2 * distance[place(i - 1, j)] + here, 3);
    }
  }
  std::vector<double> path(at(n), 0);
  int i = n - 1, j = n - 1;
  while (i > 0) {
    path[at(i)] = j;
    switch (from[place(i, j)]) {
      case 2:
        --i;
        j -= 2;
        break;
      case 3:
        path[at(i - 1)] = j - 0.5;
        i -= 2;
        --j;
        break;
      default:
        --i;
        --j;
    }
  }
  return path;
}

}  // namespace

Result<Correspondence> warp_by_shape(std::span<const Clip* const> clips, const RoleMap& roles,
                                     const ShapeWarpOptions& options) {
  std::vector<double> durations;
  double longest = 0;
  for (const Clip* clip : clips) {
    durations.push_back(clip->duration());
    longest = std::max(longest, clip->duration());
  }
  auto result = ends_alone(durations);
  if (!result || clips.size() < 2) return result;
  const int n = static_cast<int>(
      std::clamp(std::round(longest * kUsualRate) + 1, 3.0, static_cast<double>(kMaxMoments)));
  const int carrier = carrying_joint(roles);
  std::vector<std::vector<double>> paths(clips.size());
  const Shapes first(*clips[0], carrier, n);
  parallel_for(clips.size() - 1, 1, options.jobs, [&](std::size_t begin, std::size_t end) {
    for (std::size_t m = begin + 1; m < end + 1; ++m) {
      paths[m] = find_path(first, Shapes(*clips[m], carrier, n), n, options.band);
    }
  });
  const int intervals = std::clamp(static_cast<int>(std::round(durations[0] / options.spacing)), 1,
                                   std::max(1, (n - 1) / 2));
  Correspondence found;
  found.times.resize(clips.size());
  for (int k = 0; k <= intervals; ++k) {
    const double moment = static_cast<double>(k) * (n - 1) / intervals;
    const int before = std::min(n - 2, static_cast<int>(moment));
    found.names.push_back(k == 0 ? "begin" : k == intervals ? "end" : fmt::format("match_{}", k));
    for (std::size_t m = 0; m < clips.size(); ++m) {
      double place = moment;
      if (m > 0) {
        const double part = moment - before;
        place = paths[m][at(before)] + part * (paths[m][at(before + 1)] - paths[m][at(before)]);
      }
      found.times[m].push_back(place / (n - 1) * durations[m]);
    }
  }
  return found;
}

}  // namespace krok::blend
