#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

#include "body/polygonise.h"
#include "core/parallel.h"

namespace krok::body {

namespace {

using Triangle = std::array<std::uint32_t, 3>;

std::size_t corner_of(const Triangle& triangle, std::uint32_t v) {
  return triangle[0] == v ? 0 : triangle[1] == v ? 1 : 2;
}

// The edges of a closed mesh as (lower vertex, higher vertex, two triangles), sorted.
struct Edge {
  std::uint32_t a, b, left, right;
};
std::vector<Edge> edges_of(const Mesh& mesh) {
  struct Half {
    std::uint32_t low, high, triangle;
    bool operator<(const Half& other) const {
      return std::tie(low, high, triangle) < std::tie(other.low, other.high, other.triangle);
    }
  };
  std::vector<Half> halves;
  halves.reserve(mesh.triangles.size() * 3);
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    for (std::size_t k = 0; k < 3; ++k) {
      const auto [low, high] = std::minmax(mesh.triangles[t][k], mesh.triangles[t][(k + 1) % 3]);
      halves.push_back({low, high, t});
    }
  }
  std::sort(halves.begin(), halves.end());
  std::vector<Edge> edges;
  const auto same = [&](std::size_t i, std::size_t j) {
    return halves[i].low == halves[j].low && halves[i].high == halves[j].high;
  };
  for (std::size_t first = 0, end = 0; first < halves.size(); first = end) {
    while (end < halves.size() && same(first, end)) ++end;
    if (end != first + 2) continue;
    edges.push_back({halves[first].low, halves[first].high, halves[first].triangle,
                     halves[first + 1].triangle});
  }
  return edges;
}

// Flips edges if that brings vertex valences closer to six.
void flip_edges(Mesh& mesh) {
  std::vector<int> valence(mesh.positions.size(), 0);
  for (const Triangle& t : mesh.triangles) {
    for (const std::uint32_t v : t) ++valence[v];
  }
  auto neighbours = vertex_neighbours(mesh);
  std::vector<char> touched(mesh.triangles.size(), 0);
  for (const Edge& edge : edges_of(mesh)) {
    if (touched[edge.left] || touched[edge.right]) continue;
    Triangle& left = mesh.triangles[edge.left];
    Triangle& right = mesh.triangles[edge.right];
    const std::size_t i = corner_of(left, edge.a);
    const bool forward = left[(i + 1) % 3] == edge.b;  // left runs a -> b
    const std::uint32_t a = forward ? edge.a : edge.b, b = forward ? edge.b : edge.a;
    const std::uint32_t c = left[0] ^ left[1] ^ left[2] ^ a ^ b;
    const std::uint32_t d = right[0] ^ right[1] ^ right[2] ^ a ^ b;
    if (c == d || std::binary_search(neighbours[c].begin(), neighbours[c].end(), d)) continue;
    const auto miss = [&valence](std::uint32_t v, int change) {
      const int off = valence[v] + change - 6;
      return off * off;
    };
    const int before = miss(a, 0) + miss(b, 0) + miss(c, 0) + miss(d, 0);
    const int after = miss(a, -1) + miss(b, -1) + miss(c, 1) + miss(d, 1);
    if (after >= before || valence[a] <= 3 || valence[b] <= 3) continue;
    const Vec3 &pa = mesh.positions[a], &pb = mesh.positions[b], &pc = mesh.positions[c],
               &pd = mesh.positions[d];
    const Vec3 n1 = area_normal(pa, pb, pc), n2 = area_normal(pb, pa, pd);
    const Vec3 m1 = area_normal(pc, pa, pd), m2 = area_normal(pd, pb, pc);
    const Vec3 mean = n1 + n2;
    const double floor = 0.2 * std::min(n1.norm(), n2.norm());
    if (m1.dot(mean) <= 0.7 * m1.norm() * mean.norm() || m1.norm() < floor) continue;
    if (m2.dot(mean) <= 0.7 * m2.norm() * mean.norm() || m2.norm() < floor) continue;
    left = {c, a, d};
    right = {d, b, c};
    touched[edge.left] = touched[edge.right] = 1;
    --valence[a], --valence[b], ++valence[c], ++valence[d];
    const auto insert = [&neighbours](std::uint32_t at, std::uint32_t v) {
      auto& list = neighbours[at];
      list.insert(std::lower_bound(list.begin(), list.end(), v), v);
    };
    std::erase(neighbours[a], b), std::erase(neighbours[b], a);
    insert(c, d), insert(d, c);
  }
}

// Reverts moves that would flip a triangle.
void keep_facing(const Mesh& mesh, const std::vector<Vec3>& normals, std::vector<Vec3>& moved) {
  for (int round = 0; round < 3; ++round) {
    bool folded = false;
    for (const Triangle& t : mesh.triangles) {
      const Vec3 facing = normals[t[0]] + normals[t[1]] + normals[t[2]];
      const Vec3 after = area_normal(moved[t[0]], moved[t[1]], moved[t[2]]);
      if (after.dot(facing) > 0.2 * after.norm() * facing.norm()) continue;
      for (const std::uint32_t v : t) moved[v] = mesh.positions[v];
      folded = true;
    }
    if (!folded) return;
  }
}

}  // namespace

void smooth(Mesh& mesh, int jobs) {
  const auto neighbours = vertex_neighbours(mesh);
  std::vector<Vec3> moved(mesh.positions.size());
  parallel_for(moved.size(), 1024, jobs, [&](std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v) {
      Vec3 middle = Vec3::Zero();
      for (const std::uint32_t u : neighbours[v]) middle += mesh.positions[u];
      moved[v] = 0.5 * mesh.positions[v] + 0.5 / static_cast<double>(neighbours[v].size()) * middle;
    }
  });
  mesh.positions = std::move(moved);
}

void relax(Mesh& mesh, const BlockedField& field, int passes, double strength, int jobs) {
  for (int pass = 0; pass < passes; ++pass) {
    flip_edges(mesh);
    const auto neighbours = vertex_neighbours(mesh);
    const auto normals = vertex_normals(mesh);
    std::vector<Vec3> moved(mesh.positions.size());
    parallel_for(mesh.positions.size(), 256, jobs, [&](std::size_t begin, std::size_t end) {
      for (std::size_t v = begin; v < end; ++v) {
        const Vec3& at = mesh.positions[v];
        Vec3 middle = Vec3::Zero();
        double shortest = 1e300;
        for (const std::uint32_t u : neighbours[v]) {
          middle += mesh.positions[u];
          shortest = std::min(shortest, (mesh.positions[u] - at).norm());
        }
        Vec3 move = middle / static_cast<double>(neighbours[v].size()) - at;
        move -= normals[v] * normals[v].dot(move);
        moved[v] = field.onto_surface(at + strength * move, std::max(shortest, field.cell()));
      }
    });
    keep_facing(mesh, normals, moved);
    mesh.positions = std::move(moved);
  }
}

}  // namespace krok::body
