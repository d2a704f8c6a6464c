#include "skin/key_frame_mesh.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>

#include "core/parallel.h"
#include "math/hermite.h"

namespace krok {

namespace {

constexpr std::size_t kVertexTile = 1024;

KeyShares one_key(std::size_t key) {
  KeyShares shares;
  shares.count = 1;
  shares.keys[0] = static_cast<int>(key);
  shares.shares[0] = 1;
  return shares;
}

// Adds the weights of a tangent at key `at`: `share` times its velocity.
void add_velocity(std::span<const double> times, double tension, std::size_t at, double share,
                  std::size_t first, KeyShares& shares) {
  const std::size_t before = at == 0 ? 0 : at - 1;
  const std::size_t after = std::min(at + 1, times.size() - 1);
  const double each = share * (1 - tension) / (times[after] - times[before]);
  shares.shares[after - first] += each;
  shares.shares[before - first] -= each;
}

KeyShares hermite_shares(std::span<const double> times, double tension, std::size_t k, double t) {
  const std::size_t first = k == 0 ? 0 : k - 1;
  const std::size_t last = std::min(k + 2, times.size() - 1);
  KeyShares shares;
  shares.count = static_cast<int>(last - first) + 1;
  for (std::size_t i = first; i <= last; ++i) shares.keys[i - first] = static_cast<int>(i);
  const double t2 = t * t, t3 = t2 * t;
  const double span = times[k + 1] - times[k];
  shares.shares[k - first] = 2 * t3 - 3 * t2 + 1;
  shares.shares[k + 1 - first] = 3 * t2 - 2 * t3;
  add_velocity(times, tension, k, span * (t3 - 2 * t2 + t), first, shares);
  add_velocity(times, tension, k + 1, span * (t3 - t2), first, shares);
  return shares;
}

// The weighted sum of one vertex over the keys.
Vec3 sum_at(const std::vector<Vec3f>& values, std::size_t vertices, const KeyShares& shares,
            std::size_t vertex) {
  Vec3 sum = Vec3::Zero();
  for (std::size_t i = 0; i < static_cast<std::size_t>(shares.count); ++i) {
    const auto key = static_cast<std::size_t>(shares.keys[i]);
    sum += shares.shares[i] * values[key * vertices + vertex].cast<double>();
  }
  return sum;
}

}  // namespace

Status check(const KeyFrameMesh& mesh) {
  const std::size_t expected =
      mesh.times.size() * static_cast<std::size_t>(std::max(0, mesh.vertex_count));
  if (mesh.times.empty() || mesh.vertex_count < 0 || mesh.positions.size() != expected ||
      (!mesh.normals.empty() && mesh.normals.size() != expected)) {
    return Error(
        "key-mesh-shape",
        fmt::format("{} keys of {} vertices have {} positions and {} normals", mesh.times.size(),
                    mesh.vertex_count, mesh.positions.size(), mesh.normals.size()));
  }
  for (std::size_t i = 0; i < mesh.times.size(); ++i) {
    if (!std::isfinite(mesh.times[i])) {
      return Error("key-mesh-time", fmt::format("the time of key {} is not finite", i));
    }
    if (i > 0 && !(mesh.times[i] > mesh.times[i - 1])) {
      return Error("key-mesh-time",
                   fmt::format("key {} is at {} s, not after the key before at {} s", i,
                               mesh.times[i], mesh.times[i - 1]));
    }
  }
  const auto finite = [](const Vec3f& value) { return value.allFinite(); };
  if (std::ranges::all_of(mesh.positions, finite) && std::ranges::all_of(mesh.normals, finite)) {
    return {};
  }
  return Error("key-mesh-value", "a key has a value that is not finite");
}

KeyShares shares_at(std::span<const double> times, ShapeJoin join, double tension, double time) {
  assert(!times.empty());
  if (!(time > times.front())) return one_key(0);
  if (time >= times.back()) return one_key(times.size() - 1);
  const std::size_t k = key_before(times, time);
  if (time == times[k]) return one_key(k);
  const double t = (time - times[k]) / (times[k + 1] - times[k]);
  if (join == ShapeJoin::hermite) return hermite_shares(times, tension, k, t);
  KeyShares shares;
  shares.count = 2;
  shares.keys = {static_cast<int>(k), static_cast<int>(k) + 1, 0, 0};
  shares.shares = {1 - t, t, 0, 0};
  return shares;
}

void shape_at(const KeyFrameMesh& mesh, ShapeJoin join, double tension, double time,
              const MorphedSurface& out, int jobs) {
  const auto vertices = static_cast<std::size_t>(mesh.vertex_count);
  assert(out.positions.size() == vertices);
  assert(out.normals.empty() || out.normals.size() == vertices);
  const KeyShares shares = shares_at(mesh.times, join, tension, time);
  const bool with_normals = !mesh.normals.empty() && !out.normals.empty();
  const auto tile = [&](std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v) {
      out.positions[v] = sum_at(mesh.positions, vertices, shares, v).cast<float>();
      if (!with_normals) continue;
      const Vec3 sum = sum_at(mesh.normals, vertices, shares, v);
      const double length = sum.norm();
      const Vec3f& first = mesh.normals[static_cast<std::size_t>(shares.keys[0]) * vertices + v];
      // A single key is copied exactly.
      out.normals[v] =
          shares.count > 1 && length >= 1e-15 ? Vec3f((sum / length).cast<float>()) : first;
    }
  };
  if (jobs == 1) {
    tile(0, vertices);
  } else {
    parallel_for(vertices, kVertexTile, jobs, tile);
  }
}

}  // namespace krok
