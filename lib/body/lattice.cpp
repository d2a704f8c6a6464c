#include "body/lattice.h"

#include <algorithm>
#include <cmath>
#include <queue>

#include "core/parallel.h"

namespace krok::body {

namespace {}  // namespace

BlockedField::BlockedField(const Field& field, double cell, int jobs) : field_(field), cell_(cell) {
  const Eigen::AlignedBox3d bounds = field.bounds();
  origin_ = bounds.min() - Vec3::Constant(2 * cell);
  const double block = cell * kCells;
  std::vector<std::array<std::int64_t, 3>> corners;
  for (const Field::Ball& ball : field.balls()) {
    std::array<std::int64_t, 3> low, high;
    for (int axis = 0; axis < 3; ++axis) {
      const double at = (ball.center[axis] - origin_[axis]) / block, r = ball.radius / block;
      low[static_cast<std::size_t>(axis)] =
          std::max<std::int64_t>(0, static_cast<std::int64_t>(std::floor(at - r)));
      high[static_cast<std::size_t>(axis)] = static_cast<std::int64_t>(std::floor(at + r));
    }
    for (std::int64_t z = low[2]; z <= high[2]; ++z) {
      for (std::int64_t y = low[1]; y <= high[1]; ++y) {
        for (std::int64_t x = low[0]; x <= high[0]; ++x) corners.push_back({x, y, z});
      }
    }
  }
  std::sort(corners.begin(), corners.end());
  corners.erase(std::unique(corners.begin(), corners.end()), corners.end());

  std::vector<Block> all(corners.size());
  std::vector<char> active(corners.size(), 0);
  const double half_diagonal = 0.5 * block * std::sqrt(3.0);
  parallel_for(corners.size(), 16, jobs, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const auto& c = corners[i];
      all[i].corner = {c[0] * kCells, c[1] * kCells, c[2] * kCells};
      const Vec3 center = lattice_point(all[i].corner[0], all[i].corner[1], all[i].corner[2]) +
                          Vec3::Constant(0.5 * block);
      // With a margin of neighbouring cells: if the surface passes within a cell of a block's
      // points, the block with the other end of the lattice edges exists too.
      all[i].near = field.near(center, half_diagonal + 2 * cell);
      active[i] = all[i].near.ranges.empty() ? 0 : 1;
    }
  });
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (!active[i]) continue;
    index_.emplace(lattice_key(corners[i][0], corners[i][1], corners[i][2]), blocks_.size());
    blocks_.push_back(std::move(all[i]));
  }
  everything_ = field.near(bounds.center(), bounds.diagonal().norm());
}

int BlockedField::block_at(std::int64_t x, std::int64_t y, std::int64_t z) const {
  if (x < 0 || y < 0 || z < 0) return -1;
  const auto found = index_.find(lattice_key(x, y, z));
  return found == index_.end() ? -1 : static_cast<int>(found->second);
}

const Field::Near& BlockedField::near(const Vec3& point) const {
  const Vec3 at = (point - origin_) / (cell_ * kCells);
  if ((at.array() >= 0).all()) {
    const auto found = index_.find(lattice_key(static_cast<std::int64_t>(at.x()),
                                               static_cast<std::int64_t>(at.y()),
                                               static_cast<std::int64_t>(at.z())));
    if (found != index_.end()) return blocks_[found->second].near;
  }
  return everything_;
}

Vec3 BlockedField::onto_surface(const Vec3& point, double limit) const {
  Vec3 at = point;
  for (int step = 0; step < 4; ++step) {
    const Field::Near& here = near(at);
    const double distance = field_.value(at, here);
    if (std::abs(distance) < 1e-3 * cell_) break;
    const Vec3 slope = field_.gradient(at, distance, here, 0.1 * cell_);
    const double slope2 = slope.squaredNorm();
    if (slope2 < 1e-4) break;
    Vec3 move = -distance / std::max(slope2, 0.25) * slope;
    const double length = move.norm();
    if (length > limit) move *= limit / length;
    at += move;
  }
  const Vec3 moved = at - point;
  const double length = moved.norm();
  return length > limit ? Vec3(point + moved * (limit / length)) : at;
}

namespace {

// The neighbours of a point in Kuhn's subdivision: the corners 1 to 7 of its cube, as bit masks of
// the axes, and the same backwards (8 to 14).
constexpr int kNeighbours = 14;
constexpr std::array<int, 3> offset_of(int neighbour) {
  const int corner = neighbour < 7 ? neighbour + 1 : neighbour - 6;
  const int sign = neighbour < 7 ? 1 : -1;
  return {sign * (corner & 1), sign * ((corner >> 1) & 1), sign * ((corner >> 2) & 1)};
}

// Whether a point is simple, for each of the 2^14 inside/outside configurations of its neighbours.
std::vector<char> simple_points() {
  std::array<unsigned, kNeighbours> adjacent{};
  for (int a = 0; a < kNeighbours; ++a) {
    for (int b = 0; b < kNeighbours; ++b) {
      const auto p = offset_of(a), q = offset_of(b);
      int low = 2, high = -2;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        low = std::min(low, q[axis] - p[axis]);
        high = std::max(high, q[axis] - p[axis]);
      }
      // Two points are neighbours if their difference is a corner, or the negative of one.
      if (a != b && (low >= 0 || high <= 0) && high - low <= 1 && low >= -1 && high <= 1) {
        adjacent[static_cast<std::size_t>(a)] |= 1u << b;
      }
    }
  }
  const auto together = [&adjacent](unsigned set) {
    if (set == 0) return false;
    unsigned reached = set & (~set + 1), before = 0;
    while (reached != before) {
      before = reached;
      for (std::size_t i = 0; i < kNeighbours; ++i) {
        if (reached & (1u << i)) reached |= adjacent[i] & set;
      }
    }
    return reached == set;
  };
  constexpr unsigned kAll = (1u << kNeighbours) - 1;
  std::vector<char> simple(kAll + 1);
  for (unsigned set = 0; set <= kAll; ++set) simple[set] = together(set) && together(kAll & ~set);
  return simple;
}

}  // namespace

Lattice::Lattice(const BlockedField& field, int jobs)
    : field_(field), values_(field.blocks().size() * kPoints), beside_(field.blocks().size()) {
  parallel_for(beside_.size(), 4, jobs, [&](std::size_t begin, std::size_t end) {
    for (std::size_t b = begin; b < end; ++b) {
      const auto& corner = field.blocks()[b].corner;
      std::size_t i = 0;
      for (int z = -1; z <= 1; ++z) {
        for (int y = -1; y <= 1; ++y) {
          for (int x = -1; x <= 1; ++x) {
            beside_[b][i++] = field.block_at(corner[0] / kCells + x, corner[1] / kCells + y,
                                             corner[2] / kCells + z);
          }
        }
      }
      sample(b);
    }
  });
}

void Lattice::sample(std::size_t block) {
  const auto& [corner, near] = field_.blocks()[block];
  sample_part(corner, near, {0, 0, 0}, kCells, &values_[block * kPoints]);
}

void Lattice::sample_part(const std::array<std::int64_t, 3>& corner, const Field::Near& near,
                          const std::array<int, 3>& first, int size, double* values) const {
  const auto point = [&](int x, int y, int z) {
    return field_.lattice_point(corner[0] + first[0] + x, corner[1] + first[1] + y,
                                corner[2] + first[2] + z);
  };
  const auto put = [&](int x, int y, int z, double value) {
    values[first[0] + x + kCells * (first[1] + y + kCells * (first[2] + z))] = value;
  };
  // The value at the centre decides whether the surface is beyond all points and their
  // neighbours. Outside, values are at most the distance; inside they may be up to twice that.
  const double half = 0.5 * (size - 1);
  const Vec3 centre = point(0, 0, 0) + Vec3::Constant(half * field_.cell());
  const double middle = field_.field().value(centre, near);
  const double reach = std::sqrt(3.0) * (half + 1) * field_.cell();
  const bool far = middle > 1.2 * reach || middle < -2.2 * reach;
  if (!far && size > 2) {
    const Field::Near nearer =
        size < kCells ? field_.field().near(centre, reach + field_.cell()) : near;
    for (int part = 0; part < 8; ++part) {
      const int step = size / 2;
      sample_part(corner, nearer,
                  {first[0] + (part & 1) * step, first[1] + (part >> 1 & 1) * step,
                   first[2] + (part >> 2) * step},
                  step, values);
    }
    return;
  }
  for (int z = 0; z < size; ++z) {
    for (int y = 0; y < size; ++y) {
      for (int x = 0; x < size; ++x) {
        put(x, y, z, far ? middle : field_.field().value(point(x, y, z), near));
      }
    }
  }
}

Lattice::Point Lattice::neighbour(Point point, int dx, int dy, int dz) const {
  int x = point.at % kCells + dx, y = point.at / kCells % kCells + dy,
      z = point.at / (kCells * kCells) + dz;
  const auto wrap = [](int& v) {
    const int step = v < 0 ? -1 : v >= kCells ? 1 : 0;
    v -= step * kCells;
    return step;
  };
  const int bx = wrap(x), by = wrap(y), bz = wrap(z);
  const auto index = static_cast<std::size_t>(bx + 1 + 3 * (by + 1) + 9 * (bz + 1));
  return {beside_[static_cast<std::size_t>(point.block)][index],
          static_cast<std::uint16_t>(x + kCells * (y + kCells * z))};
}

bool Lattice::cubes(std::size_t block, Cubes& values) const {
  std::size_t i = 0;
  bool inside = false, outside = false;
  for (int z = 0; z < kSide; ++z) {
    for (int y = 0; y < kSide; ++y) {
      for (int x = 0; x < kSide; ++x) {
        const int bx = x / kCells, by = y / kCells, bz = z / kCells;
        const int at = beside_[block][static_cast<std::size_t>(13 + bx + 3 * by + 9 * bz)];
        const auto local =
            static_cast<std::size_t>(x % kCells + kCells * (y % kCells + kCells * (z % kCells)));
        const double value =
            at < 0 ? field_.cell() : values_[static_cast<std::size_t>(at) * kPoints + local];
        values[i++] = value;
        (value < 0 ? inside : outside) = true;
      }
    }
  }
  return inside && outside;
}

void Lattice::make_ball() {
  static const std::vector<char> simple = simple_points();
  const auto deepest = std::min_element(values_.begin(), values_.end());
  if (deepest == values_.end() || *deepest >= 0) return;

  struct Candidate {
    double value;
    std::size_t index;
    bool operator<(const Candidate& other) const {  // the queue's top is the largest
      return value != other.value ? value > other.value : index > other.index;
    }
  };
  std::priority_queue<Candidate> queue;
  std::vector<char> grown(values_.size(), 0), queued(values_.size(), 0);
  const auto point_of = [](std::size_t index) {
    return Point{static_cast<std::int32_t>(index / kPoints),
                 static_cast<std::uint16_t>(index % kPoints)};
  };
  const auto add = [&](std::size_t index) {
    grown[index] = 1;
    for (int n = 0; n < kNeighbours; ++n) {
      const auto [dx, dy, dz] = offset_of(n);
      const Point next = neighbour(point_of(index), dx, dy, dz);
      if (next.block < 0) continue;
      const std::size_t at = static_cast<std::size_t>(next.block) * kPoints + next.at;
      if (grown[at] || queued[at] || values_[at] >= 0) continue;
      queued[at] = 1;
      queue.push({values_[at], at});
    }
  };
  add(static_cast<std::size_t>(deepest - values_.begin()));
  while (!queue.empty()) {
    const std::size_t index = queue.top().index;
    queue.pop();
    queued[index] = 0;
    unsigned around = 0;
    for (int n = 0; n < kNeighbours; ++n) {
      const auto [dx, dy, dz] = offset_of(n);
      const Point next = neighbour(point_of(index), dx, dy, dz);
      if (next.block < 0) continue;
      if (grown[static_cast<std::size_t>(next.block) * kPoints + next.at]) around |= 1u << n;
    }
    // A point that is not simple yet is queued again when another neighbour is added.
    if (simple[around]) add(index);
  }
  for (std::size_t i = 0; i < values_.size(); ++i) {
    if (values_[i] < 0 && !grown[i]) values_[i] = 0.3 * field_.cell();
  }
}

}  // namespace krok::body
