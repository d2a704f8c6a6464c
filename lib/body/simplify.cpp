#include <algorithm>
#include <array>
#include <stdexcept>
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

namespace {

using Triangle = std::array<std::uint32_t, 3>;

// A fixed-capacity list of the triangles or neighbours of a vertex.
struct Ring {
  static constexpr std::size_t kMax = 16;
  std::array<std::uint32_t, kMax> items;
  std::uint32_t count = 0;

  const std::uint32_t* begin() const { return items.data(); }
  const std::uint32_t* end() const { return items.data() + count; }
  bool has(std::uint32_t item) const { return std::find(begin(), end(), item) != end(); }
  void add(std::uint32_t item) {
    if (count == kMax) throw std::length_error("a vertex has more than 16 triangles");
    items[count++] = item;
  }
  void remove(std::uint32_t item) {
    const auto at = std::find(items.begin(), items.begin() + count, item);
    std::copy(at + 1, items.begin() + count, at);
    --count;
  }
};

// Edge collapses over a mesh with triangle lists at the vertices.
class Simplifier {
 public:
  Simplifier(const Mesh& mesh, std::vector<double>& detail)
      : positions_(mesh.positions),
        normals_(vertex_normals(mesh)),
        triangles_(mesh.triangles),
        detail_(detail),
        at_vertex_(mesh.positions.size()),
        alive_(mesh.positions.size(), 1),
        triangle_alive_(mesh.triangles.size(), 1) {
    for (std::uint32_t t = 0; t < triangles_.size(); ++t) {
      for (const std::uint32_t v : triangles_[t]) at_vertex_[v].add(t);
    }
  }

  // Passes over all edges below a cost limit that rises from pass to pass: approximates the order
  // of a priority queue.
  void run(std::size_t target) {
    constexpr double kRise = 1.25;
    std::size_t count = positions_.size();
    double limit = 0.25 * mean_cost();
    while (count > target) {
      std::size_t collapsed = 0;
      double cheapest_left = -1;
      for (std::uint32_t a = 0; a < positions_.size() && count > target; ++a) {
        if (!alive_[a]) continue;
        const Ring around = neighbours(a);
        for (const std::uint32_t b : around) {
          if (b < a || !alive_[b]) continue;
          const double price = cost(a, b);
          if (price > limit) {
            if (cheapest_left < 0 || price < cheapest_left) cheapest_left = price;
            continue;
          }
          if (!collapse(a, b)) continue;
          --count;
          ++collapsed;
          break;  // the neighbours have changed
        }
      }
      if (collapsed == 0 && cheapest_left < 0) return;  // no edge can collapse
      limit = collapsed == 0 ? std::max(limit * kRise, cheapest_left * 1.01) : limit * kRise;
    }
  }

  Mesh result() {
    Mesh mesh;
    std::vector<std::uint32_t> renumbered(positions_.size(), 0);
    std::vector<double> detail;
    for (std::uint32_t v = 0; v < positions_.size(); ++v) {
      if (!alive_[v]) continue;
      renumbered[v] = static_cast<std::uint32_t>(mesh.positions.size());
      mesh.positions.push_back(positions_[v]);
      detail.push_back(detail_[v]);
    }
    for (std::size_t t = 0; t < triangles_.size(); ++t) {
      if (!triangle_alive_[t]) continue;
      const Triangle& old = triangles_[t];
      mesh.triangles.push_back({renumbered[old[0]], renumbered[old[1]], renumbered[old[2]]});
    }
    detail_ = std::move(detail);
    return mesh;
  }

 private:
  double cost(std::uint32_t a, std::uint32_t b) const {
    return (positions_[a] - positions_[b]).squaredNorm() / (detail_[a] * detail_[b]);
  }
  double mean_cost() const {
    double sum = 0;
    for (const Triangle& t : triangles_) sum += cost(t[0], t[1]);
    return triangles_.empty() ? 0.0 : sum / static_cast<double>(triangles_.size());
  }

  // In a closed manifold each neighbour is the next corner of exactly one triangle at the vertex.
  Ring neighbours(std::uint32_t v) const {
    Ring result;
    for (const std::uint32_t t : at_vertex_[v]) {
      const Triangle& triangle = triangles_[t];
      result.add(triangle[0] == v ? triangle[1] : triangle[1] == v ? triangle[2] : triangle[0]);
    }
    return result;
  }

  // Whether the triangles at v, except those that also contain `other`, stay valid with v at `to`.
  bool fits(std::uint32_t v, std::uint32_t other, const Vec3& to) const {
    for (const std::uint32_t t : at_vertex_[v]) {
      const Triangle& triangle = triangles_[t];
      if (triangle[0] == other || triangle[1] == other || triangle[2] == other) continue;
      Vec3 corners[3];
      for (std::size_t k = 0; k < 3; ++k) corners[k] = positions_[triangle[k]];
      const Vec3 before = area_normal(corners[0], corners[1], corners[2]);
      double longest = 0;
      for (std::size_t k = 0; k < 3; ++k) {
        if (triangle[k] == v) corners[k] = to;
      }
      for (std::size_t k = 0; k < 3; ++k) {
        longest = std::max(longest, (corners[k] - corners[(k + 1) % 3]).squaredNorm());
      }
      const Vec3 after = area_normal(corners[0], corners[1], corners[2]);
      const double length = after.norm();
      if (length < 0.08 * longest) return false;
      if (after.dot(before) < 0.3 * length * before.norm()) return false;
      // Prevents gradual rotation away from the original surface normal.
      const Vec3 facing = normals_[triangle[0]] + normals_[triangle[1]] + normals_[triangle[2]];
      if (after.dot(facing) < 0.3 * length * facing.norm()) return false;
    }
    return true;
  }

  bool collapse(std::uint32_t a, std::uint32_t b) {
    if (at_vertex_[a].count + at_vertex_[b].count > 15) return false;
    const Ring around_a = neighbours(a), around_b = neighbours(b);
    Ring shared;
    for (const std::uint32_t u : around_a) {
      if (around_b.has(u)) shared.add(u);
    }
    // The link condition (Dey et al. 1999) for keeping the topology.
    if (shared.count != 2) return false;
    if (at_vertex_[shared.items[0]].count <= 3 || at_vertex_[shared.items[1]].count <= 3) {
      return false;
    }
    const Vec3 middle = 0.5 * (positions_[a] + positions_[b]);
    if (!fits(a, b, middle) || !fits(b, a, middle)) return false;

    positions_[a] = middle;
    detail_[a] = 0.5 * (detail_[a] + detail_[b]);
    normals_[a] += normals_[b];
    const double facing = normals_[a].norm();
    if (facing > 0) normals_[a] /= facing;
    alive_[b] = 0;
    const Ring at_b = at_vertex_[b];
    for (const std::uint32_t t : at_b) {
      Triangle& triangle = triangles_[t];
      if (std::find(triangle.begin(), triangle.end(), a) != triangle.end()) {
        triangle_alive_[t] = 0;
        for (const std::uint32_t u : triangle) at_vertex_[u].remove(t);
      }
    }
    for (const std::uint32_t t : at_vertex_[b]) {  // the remaining triangles
      Triangle& triangle = triangles_[t];
      std::replace(triangle.begin(), triangle.end(), b, a);
      at_vertex_[a].add(t);
    }
    at_vertex_[b].count = 0;
    return true;
  }

  std::vector<Vec3> positions_, normals_;
  std::vector<Triangle> triangles_;
  std::vector<double>& detail_;
  std::vector<Ring> at_vertex_;
  std::vector<char> alive_, triangle_alive_;
};

}  // namespace

Mesh simplify(const Mesh& mesh, std::vector<double>& detail, std::size_t target) {
  Simplifier simplifier(mesh, detail);
  simplifier.run(target);
  return simplifier.result();
}

}  // namespace krok::body
