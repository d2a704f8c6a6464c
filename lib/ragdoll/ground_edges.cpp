#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>

#include "core/index.h"
#include "ragdoll/faces_internal.h"
#include "ragdoll/ground_edges_internal.h"

namespace krok::ragdoll {

namespace {

constexpr double kWeld = 1e-5;           // metres: corners nearer than that are one
constexpr double kSharp = 0.01;          // sine of the least angle between faces
constexpr double kUprightFace = 1e-3;    // of a wall's normal, upwards
constexpr double kStraight = 1e-4;       // metres off the line of what is one edge
constexpr double kSameNormal = 0.99999;  // cosine
constexpr double kDeepest = 0.03;        // metres: what is deeper is on the other side
constexpr double kBeside = 0.02;         // radians beyond the sides that still count
constexpr double kApart = 0.01;          // metres between touches of one shape

// A triangle by its welded corners.
struct WeldedFace {
  std::array<int, 3> corners = {};
  Vec3 normal = Vec3::Zero();  // upwards
  bool wall = false;
};

struct Side {
  int face = 0, opposite = 0;  // a corner
};

class EdgeFinder {
 public:
  explicit EdgeFinder(std::span<const std::array<Vec3, 3>> triangles);
  void find(std::vector<GroundEdge>& edges, std::vector<std::vector<int>>& of);
  std::vector<Vec3> wall_sides() const;

 private:
  using Ends = std::array<int, 2>;
  struct Piece {
    Ends ends;
    GroundEdge edge;
    int number = -1;
  };

  int corner(const Vec3& point);
  bool is_edge(const Ends& ends, const std::vector<Side>& sides, GroundEdge& edge) const;
  void extend(int piece, int end, GroundEdge& edge);

  std::map<std::array<std::int64_t, 3>, int> places_;
  std::vector<Vec3> points_;
  std::vector<WeldedFace> faces_;
  std::vector<int> face_of_;  // [triangles], -1 for one without an area
  std::map<Ends, std::vector<Side>> sides_;
  std::vector<Piece> pieces_;
  std::vector<std::vector<int>> pieces_at_;  // [points]
};

int EdgeFinder::corner(const Vec3& point) {
  std::array<std::int64_t, 3> place;
  for (int k = 0; k < 3; ++k) place[at(k)] = std::llround(point[k] / kWeld);
  const auto [found, is_new] = places_.emplace(place, static_cast<int>(points_.size()));
  if (is_new) points_.push_back(point);
  return found->second;
}

EdgeFinder::EdgeFinder(std::span<const std::array<Vec3, 3>> triangles) {
  std::map<std::array<int, 3>, int> known;  // a wall may be there once for each side
  for (const auto& triangle : triangles) {
    WeldedFace face;
    for (std::size_t k = 0; k < 3; ++k) face.corners[k] = corner(triangle[k]);
    const Vec3 across = (triangle[1] - triangle[0]).cross(triangle[2] - triangle[0]);
    const double size = across.norm();
    if (!(size > 1e-10)) {
      face_of_.push_back(-1);
      continue;
    }
    face.normal = (across.y() < 0 ? -1 : 1) / size * across;
    face.wall = face.normal.y() < kUprightFace;
    std::array<int, 3> sorted = face.corners;
    std::ranges::sort(sorted);
    const int number = static_cast<int>(faces_.size());
    const auto [found, is_new] = known.emplace(sorted, number);
    face_of_.push_back(found->second);
    if (!is_new) continue;
    faces_.push_back(face);
    for (std::size_t k = 0; k < 3; ++k) {
      const int a = face.corners[k], b = face.corners[(k + 1) % 3];
      sides_[{std::min(a, b), std::max(a, b)}].push_back({number, face.corners[(k + 2) % 3]});
    }
  }
}

bool EdgeFinder::is_edge(const Ends& ends, const std::vector<Side>& sides, GroundEdge& edge) const {
  const Vec3 begin = points_[at(ends[0])], way = points_[at(ends[1])] - begin;
  edge.begin = begin;
  edge.length = way.norm();
  if (!(edge.length > kWeld)) return false;
  edge.along = way / edge.length;
  const auto away = [&](const Side& side) {  // from the face, in its plane
    const Vec3 to = points_[at(side.opposite)] - begin;
    return Vec3((edge.along.dot(to) * edge.along - to).normalized());
  };
  const Side* ground = nullptr;
  for (const Side& side : sides) {
    const WeldedFace& face = faces_[at(side.face)];
    if (face.wall) continue;
    if (ground != nullptr) {
      edge.second = face.normal;
      return edge.first.dot(away(side)) > kSharp;
    }
    ground = &side;
    edge.first = face.normal;
  }
  if (ground == nullptr) return false;
  edge.second = away(*ground);
  for (const Side& side : sides) {
    const WeldedFace& face = faces_[at(side.face)];
    if (!face.wall) continue;
    if (!(edge.first.dot(away(side)) > kSharp)) return false;  // at the foot of the wall
    edge.second = (face.normal.dot(edge.second) < 0 ? -1 : 1) * face.normal;
  }
  return true;
}

// Joins the collinear pieces that continue an edge at one of its ends.
void EdgeFinder::extend(int piece, int end, GroundEdge& edge) {
  const int number = pieces_[at(piece)].number;
  const double sign = end == 0 ? -1 : 1;
  for (int point = pieces_[at(piece)].ends[at(end)];;) {
    int next = -1, far = -1;
    for (const int p : pieces_at_[at(point)]) {
      const Piece& candidate = pieces_[at(p)];
      if (candidate.number >= 0) continue;
      const int other = candidate.ends[0] == point ? candidate.ends[1] : candidate.ends[0];
      const Vec3 way = points_[at(other)] - edge.begin;
      const double along = edge.along.dot(way),
                   here = edge.along.dot(points_[at(point)] - edge.begin);
      const bool on = sign * (along - here) > 0 && (way - along * edge.along).norm() < kStraight;
      const auto same = [&](const Vec3& a, const Vec3& b) {
        return candidate.edge.first.dot(a) > kSameNormal &&
               candidate.edge.second.dot(b) > kSameNormal;
      };
      if (!on || !(same(edge.first, edge.second) || same(edge.second, edge.first))) continue;
      next = p;
      far = other;
    }
    if (next < 0) return;
    pieces_[at(next)].number = number;
    const double along = edge.along.dot(points_[at(far)] - edge.begin);
    if (sign > 0) {
      edge.length = along;
    } else {
      edge.begin += along * edge.along;
      edge.length -= along;
    }
    point = far;
  }
}

void EdgeFinder::find(std::vector<GroundEdge>& edges, std::vector<std::vector<int>>& of) {
  pieces_at_.resize(points_.size());
  std::map<Ends, int> piece_of;
  for (const auto& [ends, sides] : sides_) {
    Piece piece{ends, {}, -1};
    if (!is_edge(ends, sides, piece.edge)) continue;
    const int number = static_cast<int>(pieces_.size());
    piece_of.emplace(ends, number);
    for (const int end : ends) pieces_at_[at(end)].push_back(number);
    pieces_.push_back(piece);
  }
  for (std::size_t p = 0; p < pieces_.size(); ++p) {
    if (pieces_[p].number >= 0) continue;
    pieces_[p].number = static_cast<int>(edges.size());
    GroundEdge edge = pieces_[p].edge;
    for (const int end : {0, 1}) extend(static_cast<int>(p), end, edge);
    edges.push_back(edge);
  }
  of.resize(face_of_.size());
  for (std::size_t t = 0; t < face_of_.size(); ++t) {
    if (face_of_[t] < 0) continue;
    const WeldedFace& face = faces_[at(face_of_[t])];
    for (std::size_t k = 0; k < 3; ++k) {
      const int a = face.corners[k], b = face.corners[(k + 1) % 3];
      const auto found = piece_of.find({std::min(a, b), std::max(a, b)});
      if (found != piece_of.end()) of[t].push_back(pieces_[at(found->second)].number);
    }
  }
}

// From where a wall meets the ground, on over the triangles of the same wall.
std::vector<Vec3> EdgeFinder::wall_sides() const {
  std::vector<Vec3> sides(faces_.size(), Vec3::Zero());
  std::vector<std::vector<int>> beside(faces_.size());
  std::vector<int> waiting;
  for (const auto& [ends, around] : sides_) {
    GroundEdge edge;
    const bool convex = is_edge(ends, around, edge);
    const auto ground =
        std::ranges::find_if(around, [&](const Side& side) { return !faces_[at(side.face)].wall; });
    for (const Side& side : around) {
      const WeldedFace& face = faces_[at(side.face)];
      if (!face.wall) continue;
      for (const Side& other : around) {
        const bool same = std::abs(faces_[at(other.face)].normal.dot(face.normal)) > 0.9;
        if (other.face != side.face && same) beside[at(side.face)].push_back(other.face);
      }
      if (ground == around.end() || !sides[at(side.face)].isZero()) continue;
      const Vec3 to_ground = points_[at(ground->opposite)] - points_[at(ends[0])];
      const double toward = face.normal.dot(to_ground) * (convex ? -1 : 1);
      sides[at(side.face)] = (toward < 0 ? -1 : 1) * face.normal;
      waiting.push_back(side.face);
    }
  }
  while (!waiting.empty()) {
    const int from = waiting.back();
    waiting.pop_back();
    for (const int to : beside[at(from)]) {
      if (!sides[at(to)].isZero()) continue;
      const Vec3& normal = faces_[at(to)].normal;
      sides[at(to)] = (normal.dot(sides[at(from)]) < 0 ? -1 : 1) * normal;
      waiting.push_back(to);
    }
  }
  std::vector<Vec3> of_triangles;
  for (const int face : face_of_) {
    of_triangles.push_back(face < 0 ? Vec3(Vec3::Zero()) : sides[at(face)]);
  }
  return of_triangles;
}

// The plane across an edge, which is its origin: the ways out of the ground are the angles from
// that of the first side, 0, to that of the second.
class Across {
 public:
  explicit Across(const GroundEdge& edge) : edge_(edge), x_(edge.first) {
    y_ = edge.along.cross(x_);
    if (y_.dot(edge.second) < 0) y_ = -y_;
    last_ = std::atan2(y_.dot(edge.second), x_.dot(edge.second));
  }
  Vec2 of(const Vec3& way) const { return {x_.dot(way), y_.dot(way)}; }
  Vec3 way(const Vec2& of) const { return of.x() * x_ + of.y() * y_; }
  bool is_out(const Vec2& way) const {
    const double angle = std::atan2(way.y(), way.x());
    return angle >= -kBeside && angle <= last_ + kBeside;
  }
  Vec2 middle() const { return {std::cos(0.5 * last_), std::sin(0.5 * last_)}; }

 private:
  const GroundEdge& edge_;
  Vec3 x_, y_;
  double last_ = 0;
};

// A ball of a capsule.
void touch_ball(const Vec3& point, double radius, const GroundEdge& edge, const Across& across,
                double reach, std::vector<EdgeTouch>& touches) {
  const double s = edge.along.dot(point - edge.begin);
  if (s < 0 || s > edge.length) return;
  const Vec2 off = across.of(point - edge.begin);
  const double distance = off.norm();
  if (distance < 1e-9) return;
  Vec2 normal = off / distance;
  double gap = distance - radius;
  if (!across.is_out(normal)) {  // its middle may be in the ground
    normal = -normal;
    gap = -distance - radius;
    if (!across.is_out(normal)) return;
  }
  if (gap > reach || gap < -kDeepest) return;
  const Vec3 world = across.way(normal);
  touches.push_back({gap, world, edge.begin + s * edge.along + gap * world});
}

void touch_capsule(const Shape& shape, const Transform& pose, const GroundEdge& edge, double reach,
                   std::vector<EdgeTouch>& touches) {
  const Across across(edge);
  const double half = shape.kind == Shape::Kind::capsule ? shape.half_length : 0;
  const Vec3 low = pose * Vec3(0, -half, 0), high = pose * Vec3(0, half, 0);
  touch_ball(low, shape.radius, edge, across, reach, touches);
  if (!(half > 0)) return;
  touch_ball(high, shape.radius, edge, across, reach, touches);
  // Where it crosses the edge.
  const Vec2 from = across.of(low - edge.begin), way = across.of(high - low);
  if (!(way.squaredNorm() > kApart * kApart)) return;
  const double t = -from.dot(way) / way.squaredNorm();
  const double end = std::min(0.5, kApart / (2 * half));
  if (t < end || t > 1 - end) return;
  touch_ball(low + t * (high - low), shape.radius, edge, across, reach, touches);
}

struct BoxAcross {
  Vec2 centre;
  std::array<Vec2, 3> halves;

  double gap(const Vec2& normal) const {
    double gap = normal.dot(centre);
    for (const Vec2& half : halves) gap -= std::abs(normal.dot(half));
    return gap;
  }
};

// The way out of the ground in which the box is farthest from the edge, or least deep. Nothing if
// it is rather at a side of the edge.
bool find_way_out(const BoxAcross& box, const Across& across, Vec2& normal, double& gap) {
  double elsewhere = -1;
  gap = -1;
  const auto attempt = [&](const Vec2& way) {
    if (!(way.dot(across.middle()) > 0.2)) return;
    const double its = box.gap(way);
    if (!across.is_out(way)) {
      elsewhere = std::max(elsewhere, its);
    } else if (its > gap) {
      gap = its;
      normal = way;
    }
  };
  Vec2 nearest = box.centre;
  for (int corner = 0; corner < 8; ++corner) {
    Vec2 point = box.centre;
    for (int k = 0; k < 3; ++k)
      point += ((corner >> k) & 1) != 0 ? box.halves[at(k)] : Vec2(-box.halves[at(k)]);
    if (point.norm() < nearest.norm()) nearest = point;
  }
  if (nearest.norm() > 1e-6 && box.gap(nearest.normalized()) > 0) attempt(nearest.normalized());
  for (const Vec2& half : box.halves) {
    const double size = half.norm();
    if (!(size > 1e-6)) continue;
    const Vec2 way = Vec2(-half.y(), half.x()) / size;
    attempt(way);
    attempt(-way);
  }
  return gap > -kDeepest && !(elsewhere > gap + 1e-3);
}

void touch_box(const Shape& shape, const Transform& pose, const GroundEdge& edge, double reach,
               std::vector<EdgeTouch>& touches) {
  const Across across(edge);
  const Mat3 axes = pose.orientation.toRotationMatrix();
  BoxAcross box;
  box.centre = across.of(pose.position - edge.begin);
  for (int k = 0; k < 3; ++k) box.halves[at(k)] = shape.half[k] * across.of(axes.col(k));
  Vec2 way;
  double gap = 0;
  if (!find_way_out(box, across, way, gap) || gap > reach) return;
  const Vec3 normal = across.way(way);
  // The part of the edge that is in the box once it is moved there.
  const Vec3 begin = axes.transpose() * (edge.begin + std::max(gap, 0.0) * normal - pose.position);
  const Vec3 along = axes.transpose() * edge.along;
  double low = 0, high = edge.length;
  for (int k = 0; k < 3; ++k) {
    const double half = shape.half[k] + 1e-3;
    if (std::abs(along[k]) < 1e-9) {
      if (std::abs(begin[k]) > half) return;
      continue;
    }
    const double a = (-half - begin[k]) / along[k], b = (half - begin[k]) / along[k];
    low = std::max(low, std::min(a, b));
    high = std::min(high, std::max(a, b));
  }
  if (!(low <= high)) return;
  const auto add = [&](double s, double its) {
    touches.push_back({its, normal, edge.begin + s * edge.along + its * normal});
  };
  const Vec3 down = axes.transpose() * -normal;
  int face = 0;
  const double flat = down.cwiseAbs().maxCoeff(&face);
  if (flat < 0.99 || high - low < kApart) {
    add(0.5 * (low + high), gap);
    return;
  }
  const double sign = down[face] < 0 ? -1 : 1;
  const Vec3 first = axes.transpose() * (edge.begin - pose.position);
  for (const double s : {low, high}) {
    // The face is not quite along the edge: where it passes beside the box, it is no depth.
    const double its = sign * (first[face] + s * along[face]) - shape.half[face];
    add(s, gap > 0 ? std::max(gap, its) : its);
  }
}

}  // namespace

GroundEdges::GroundEdges(std::span<const std::array<Vec3, 3>> triangles) {
  EdgeFinder finder(triangles);
  finder.find(edges_, of_);
  wall_sides_ = finder.wall_sides();
}

void touch_edge(const Shape& shape, const Transform& pose, const GroundEdge& edge, double reach,
                std::vector<EdgeTouch>& touches) {
  if (shape.kind == Shape::Kind::box) {
    touch_box(shape, pose, edge, reach, touches);
  } else {
    touch_capsule(shape, pose, edge, reach, touches);
  }
}

}  // namespace krok::ragdoll
