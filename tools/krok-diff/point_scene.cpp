#include "tools/krok-diff/point_scene.h"

#include <algorithm>
#include <cmath>

namespace krok::cli::diff {

namespace {

constexpr double kSamplesPerSecond = 30;

// A time between two keys: `share` is the weight of the next key.
struct KeyInterval {
  std::size_t key = 0;
  double share = 0;
};

KeyInterval place_of(double time, const std::vector<double>& times) {
  const auto after = std::upper_bound(times.begin(), times.end(), time);
  if (after == times.begin()) return {};
  const auto key = static_cast<std::size_t>(after - times.begin()) - 1;
  if (after == times.end()) return {key, 0};
  return {key, (time - times[key]) / (*after - times[key])};
}

std::vector<double> frame_times(int frames, double rate) {
  std::vector<double> times;
  times.reserve(static_cast<std::size_t>(frames));
  for (int i = 0; i < frames; ++i) times.push_back(i / rate);
  return times;
}

template <typename From, typename To = Eigen::Matrix<double, From::RowsAtCompileTime, 1>>
std::vector<To> in_doubles(std::span<const From> values) {
  std::vector<To> result;
  result.reserve(values.size());
  for (const From& value : values) result.push_back(value.template cast<double>());
  return result;
}

// The range of points that belongs to each mesh.
struct Run {
  std::size_t begin = 0, count = 0;
};

std::vector<Run> runs_of(std::size_t points, const Scene* partner) {
  std::vector<Run> runs;
  if (partner != nullptr) {
    std::size_t begin = 0;
    bool each = !partner->meshes.empty();
    for (const SceneMesh& mesh : partner->meshes) {
      runs.push_back({begin, mesh.vertex_count});
      begin += mesh.vertex_count;
      each = each && mesh.vertex_count == points;
    }
    if (each) return std::vector<Run>(runs.size(), {0, points});
    if (begin == points) return runs;
  }
  return {{0, points}};
}

}  // namespace

Result<Scene> scene_of(const pc2::PointCache& points, const Scene* partner) {
  const auto count = static_cast<std::size_t>(points.points());
  if (points.samples() == 0) return Error("pc2-value", "the file has no samples");
  std::vector<Vec3f> sample(count);
  for (std::int64_t i = 0; i < points.samples(); ++i) {
    if (Status status = points.get(i, sample); !status) return status.error();
  }
  Scene scene;
  const std::vector<Run> runs = runs_of(count, partner);
  for (std::size_t i = 0; i < runs.size(); ++i) {
    SceneMesh mesh;
    mesh.only_points = true;
    mesh.vertex_count = runs[i].count;
    if (runs.size() > 1 && partner != nullptr) mesh.name = partner->meshes[i].name;
    scene.meshes.push_back(std::move(mesh));
  }
  const auto samples = static_cast<std::size_t>(points.samples());
  std::vector<double> times = frame_times(static_cast<int>(samples), kSamplesPerSecond);
  if (partner != nullptr && !partner->animations.empty() &&
      partner->animations.front().key_times.size() == samples) {
    times = partner->animations.front().key_times;
  }
  // A single sample is a static shape.
  if (samples != 1 || (partner != nullptr && !partner->animations.empty())) {
    scene.animations.push_back({"", times});
  }
  scene.evaluate = [&points, runs, times, count](int, double time, SceneState& state) {
    std::vector<Vec3f> one, next;
    const KeyInterval place = place_of(time, times);
    // Cannot fail: all samples were validated before.
    const auto get = [&](std::size_t key, std::vector<Vec3f>& values) {
      values.resize(count);
      const Status status = points.get(static_cast<std::int64_t>(key), values);
      if (!status) values.assign(count, Vec3f::Zero());
    };
    get(place.key, one);
    if (place.share > 0) get(place.key + 1, next);
    state.positions.resize(runs.size());
    state.normals.assign(runs.size(), {});
    state.joints.clear();
    for (std::size_t m = 0; m < runs.size(); ++m) {
      const auto of_mesh = [&](const std::vector<Vec3f>& values) {
        return in_doubles(std::span(values).subspan(runs[m].begin, runs[m].count));
      };
      state.positions[m] = of_mesh(one);
      if (next.empty()) continue;
      const std::vector<Vec3> after = of_mesh(next);
      for (std::size_t i = 0; i < after.size(); ++i) {
        state.positions[m][i] += place.share * (after[i] - state.positions[m][i]);
      }
    }
  };
  return scene;
}

}  // namespace krok::cli::diff
