#include "body/polygonise.h"

#include <algorithm>
#include <numeric>
#include <unordered_map>

#include "core/parallel.h"

namespace krok::body {

namespace {

using EdgeKey = std::uint64_t;

// Corners of a cube are bit masks of the axes. Each tetrahedron of Kuhn's subdivision is a path
// from corner 0 to corner 7 along the axes; all have the same orientation.
constexpr int kTetrahedra[6][4] = {{0, 1, 3, 7}, {0, 2, 6, 7}, {0, 4, 5, 7},
                                   {0, 3, 2, 7}, {0, 6, 4, 7}, {0, 5, 1, 7}};
// Even permutations that put one vertex, or two, first.
constexpr int kOneFirst[4][4] = {{0, 1, 2, 3}, {1, 0, 3, 2}, {2, 0, 1, 3}, {3, 0, 2, 1}};
constexpr int kTwoFirst[6][4] = {{0, 1, 2, 3}, {0, 2, 3, 1}, {0, 3, 1, 2},
                                 {1, 2, 0, 3}, {1, 3, 2, 0}, {2, 3, 0, 1}};

struct BlockMesh {
  std::vector<std::array<EdgeKey, 3>> triangles;
  std::vector<std::pair<EdgeKey, Vec3>> vertices;
};

class BlockMarcher {
 public:
  BlockMarcher(const BlockedField& field, const BlockedField::Block& block,
               const Lattice::Cubes& values, BlockMesh& out)
      : field_(field), block_(block), values_(values), out_(out) {}

  void run() {
    for (int z = 0; z + 1 < kSide; ++z) {
      for (int y = 0; y + 1 < kSide; ++y) {
        for (int x = 0; x + 1 < kSide; ++x) cube(x, y, z);
      }
    }
  }

 private:
  static constexpr int kSide = Lattice::kSide;

  Vec3 point(int x, int y, int z) const {
    return field_.lattice_point(block_.corner[0] + x, block_.corner[1] + y, block_.corner[2] + z);
  }
  double value(int x, int y, int z) const {
    return values_[static_cast<std::size_t>((z * kSide + y) * kSide + x)];
  }

  void cube(int x, int y, int z) {
    int inside = 0;
    for (int c = 0; c < 8; ++c) {
      corner_[c] = value(x + (c & 1), y + ((c >> 1) & 1), z + ((c >> 2) & 1));
      if (corner_[c] < 0) ++inside;
    }
    if (inside == 0 || inside == 8) return;
    x_ = x, y_ = y, z_ = z;
    for (const auto& tetrahedron : kTetrahedra) march(tetrahedron);
  }

  void march(const int (&t)[4]) {
    int in[4], out[4];
    int ins = 0, outs = 0;
    for (int i = 0; i < 4; ++i) (corner_[t[i]] < 0 ? in[ins++] : out[outs++]) = i;
    if (ins == 1 || ins == 3) {
      const auto& o = kOneFirst[ins == 1 ? in[0] : out[0]];
      const EdgeKey a = edge(t[o[0]], t[o[1]]), b = edge(t[o[0]], t[o[2]]),
                    c = edge(t[o[0]], t[o[3]]);
      if (ins == 1) {
        out_.triangles.push_back({a, b, c});
      } else {
        out_.triangles.push_back({a, c, b});
      }
    } else if (ins == 2) {
      for (const auto& o : kTwoFirst) {
        if (!((o[0] == in[0] && o[1] == in[1]) || (o[0] == in[1] && o[1] == in[0]))) continue;
        const EdgeKey ac = edge(t[o[0]], t[o[2]]), ad = edge(t[o[0]], t[o[3]]),
                      bd = edge(t[o[1]], t[o[3]]), bc = edge(t[o[1]], t[o[2]]);
        out_.triangles.push_back({ac, ad, bd});
        out_.triangles.push_back({ac, bd, bc});
      }
    }
  }

  EdgeKey edge(int a, int b) {
    if (a > b) std::swap(a, b);  // a is then a subset of b's bits
    const int dx = a & 1, dy = (a >> 1) & 1, dz = (a >> 2) & 1;
    const EdgeKey key = (lattice_key(block_.corner[0] + x_ + dx, block_.corner[1] + y_ + dy,
                                     block_.corner[2] + z_ + dz)
                         << 3) |
                        static_cast<EdgeKey>(b ^ a);
    const double va = corner_[a], vb = corner_[b];
    const double t = std::clamp(va / (va - vb), 0.05, 0.95);
    const Vec3 from = point(x_ + dx, y_ + dy, z_ + dz);
    const Vec3 to = point(x_ + (b & 1), y_ + ((b >> 1) & 1), z_ + ((b >> 2) & 1));
    out_.vertices.emplace_back(key, Vec3(from + t * (to - from)));
    return key;
  }

  const BlockedField& field_;
  const BlockedField::Block& block_;
  const Lattice::Cubes& values_;
  BlockMesh& out_;
  double corner_[8];
  int x_ = 0, y_ = 0, z_ = 0;
};

}  // namespace

Mesh polygonise(const Lattice& lattice, int jobs) {
  const auto& blocks = lattice.field().blocks();
  std::vector<BlockMesh> pieces(blocks.size());
  parallel_for(blocks.size(), 4, jobs, [&](std::size_t begin, std::size_t end) {
    Lattice::Cubes values;
    for (std::size_t i = begin; i < end; ++i) {
      if (!lattice.cubes(i, values)) continue;
      BlockMarcher(lattice.field(), blocks[i], values, pieces[i]).run();
    }
  });
  Mesh mesh;
  std::unordered_map<EdgeKey, std::uint32_t> numbers;
  for (BlockMesh& piece : pieces) {
    for (const auto& [key, position] : piece.vertices) {
      const auto number = static_cast<std::uint32_t>(mesh.positions.size());
      if (numbers.emplace(key, number).second) mesh.positions.push_back(position);
    }
    for (const auto& triangle : piece.triangles) {
      mesh.triangles.push_back(
          {numbers.at(triangle[0]), numbers.at(triangle[1]), numbers.at(triangle[2])});
    }
    piece = BlockMesh();
  }
  return mesh;
}

bool is_sphere(const Mesh& mesh) {
  const std::size_t count = mesh.positions.size();
  std::vector<std::uint32_t> group(count);
  std::iota(group.begin(), group.end(), 0u);
  const auto find = [&group](std::uint32_t v) {
    while (group[v] != v) v = group[v] = group[group[v]];
    return v;
  };
  std::size_t pieces = count;
  for (const auto& t : mesh.triangles) {
    for (std::size_t k = 1; k < 3; ++k) {
      const std::uint32_t a = find(t[0]), b = find(t[k]);
      if (a == b) continue;
      group[std::max(a, b)] = std::min(a, b);
      --pieces;
    }
  }
  // Euler's formula; a closed mesh has three edges for every two triangles.
  return pieces == 1 && count == mesh.triangles.size() / 2 + 2;
}

std::vector<Vec3> vertex_normals(const Mesh& mesh) {
  std::vector<Vec3> normals(mesh.positions.size(), Vec3::Zero());
  for (const auto& t : mesh.triangles) {
    const Vec3& a = mesh.positions[t[0]];
    const Vec3& b = mesh.positions[t[1]];
    const Vec3& c = mesh.positions[t[2]];
    const Vec3 normal = (b - a).cross(c - a);
    const double ab = (b - a).norm(), bc = (c - b).norm(), ca = (a - c).norm();
    if (!(ab > 0) || !(bc > 0) || !(ca > 0)) continue;
    normals[t[0]] += normal / (ab * ca);
    normals[t[1]] += normal / (ab * bc);
    normals[t[2]] += normal / (bc * ca);
  }
  for (Vec3& normal : normals) {
    const double length = normal.norm();
    normal = length > 0 ? Vec3(normal / length) : Vec3(Vec3::UnitY());
  }
  return normals;
}

double signed_volume(const Mesh& mesh) {
  if (mesh.positions.empty()) return 0;
  const Vec3 origin = mesh.positions.front();
  double volume = 0;
  for (const auto& t : mesh.triangles) {
    volume += (mesh.positions[t[0]] - origin)
                  .dot((mesh.positions[t[1]] - origin).cross(mesh.positions[t[2]] - origin));
  }
  return volume / 6;
}

std::vector<std::vector<std::uint32_t>> vertex_neighbours(const Mesh& mesh) {
  std::vector<std::vector<std::uint32_t>> lists(mesh.positions.size());
  for (const auto& t : mesh.triangles) {
    for (std::size_t k = 0; k < 3; ++k) lists[t[k]].push_back(t[(k + 1) % 3]);
  }
  // In a closed manifold each directed edge occurs once, so each neighbour is listed once.
  for (auto& list : lists) std::sort(list.begin(), list.end());
  return lists;
}

}  // namespace krok::body
