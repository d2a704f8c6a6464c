#include "gait/shown_prints.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <unordered_map>

#include "contacts/sole_points.h"
#include "gait/ground_prints_internal.h"

namespace krok::gait {

namespace {

constexpr double kTopStorey = 1e6;  // metres: the first print is on the highest storey
constexpr double kSunkFoot = 0.3;   // metres: ground so high above a joint may be what it stands on
constexpr double kTableCell = 0.25;   // metres, of the table that finds prints by place
constexpr double kShortestGap = 2.5;  // a gap of fewer does not end a contact

const SolePoint* sole_point_of(const Feet& feet, FootSide side, FootPart part) {
  const auto& points = feet.points[index_of(side)];
  const auto found = std::ranges::find(points, part, &SolePoint::part);
  return found == points.end() ? nullptr : &*found;
}

Vec3 sole_place(const Clip& clip, int frame, const SolePoint& point) {
  const auto joint = static_cast<std::size_t>(point.joint);
  return clip.frame_positions(frame)[joint].cast<double>() +
         clip.frame_orientations(frame)[joint].cast<double>().normalized() * point.offset;
}

// Prints by place over the ground.
class PrintTable {
 public:
  PrintTable(std::span<const GroundedPrint> prints, const FootSize& size) : prints_(prints) {
    for (std::size_t i = 0; i < prints.size(); ++i) {
      heels_.push_back(prints[i].heel);
      balls_.push_back(prints[i].heel + size.ball * prints[i].forward);
    }
    fill(heels_, heel_cells_);
    fill(balls_, ball_cells_);
  }

  // The print on which the point stands, or -1.
  int find(FootSide side, FootPart part, const Vec3& at, double near) const {
    const bool heel = part == FootPart::heel;
    const std::vector<Vec3>& places = heel ? heels_ : balls_;
    const Cells& cells = heel ? heel_cells_ : ball_cells_;
    int best = -1;
    double least = near;
    for (int dx = -1; dx <= 1; ++dx) {
      for (int dz = -1; dz <= 1; ++dz) {
        const auto cell = cells.find(key(cell_of(at.x()) + dx, cell_of(at.z()) + dz));
        if (cell == cells.end()) continue;
        for (const int print : cell->second) {
          const auto i = static_cast<std::size_t>(print);
          const double distance = (places[i] - at).norm();
          if (prints_[i].side != side || !(distance < least)) continue;
          least = distance;
          best = print;
        }
      }
    }
    return best;
  }

 private:
  using Cells = std::unordered_map<std::uint64_t, std::vector<int>>;

  static std::int64_t cell_of(double x) {
    return static_cast<std::int64_t>(std::floor(x / kTableCell));
  }
  static std::uint64_t key(std::int64_t x, std::int64_t z) {
    return (static_cast<std::uint64_t>(x) << 32) ^ (static_cast<std::uint64_t>(z) & 0xFFFFFFFFu);
  }
  static void fill(const std::vector<Vec3>& places, Cells& cells) {
    for (std::size_t i = 0; i < places.size(); ++i) {
      cells[key(cell_of(places[i].x()), cell_of(places[i].z()))].push_back(static_cast<int>(i));
    }
  }

  std::span<const GroundedPrint> prints_;
  std::vector<Vec3> heels_, balls_;
  Cells heel_cells_, ball_cells_;
};

}  // namespace

std::function<std::optional<double>(const Vec3&)> height_of(const Terrain& ground) {
  return [&ground](const Vec3& point) -> std::optional<double> {
    const auto below = ground.at(point.x(), point.z(), point.y() + kSunkFoot);
    if (!below) return {};
    return below->height;
  };
}

UpOfGround up_of(const Terrain& ground) {
  return [&ground](const Vec3& point) -> Vec3 {
    const auto below = ground.at(point.x(), point.z(), point.y() + kSunkFoot);
    return below ? below->normal : Vec3(Vec3::UnitY());
  };
}

FootSize foot_size(const Clip& clip, const RoleMap& roles) {
  const Feet feet = find_feet(clip, roles);
  FootSize size;
  if (!(feet.leg_length > 0) || clip.frame_count() == 0) return size;
  size.leg = feet.leg_length;
  double ball = 0, tip = 0;
  int known = 0;
  for (const FootSide side : {FootSide::left, FootSide::right}) {
    const SolePoint* heel = sole_point_of(feet, side, FootPart::heel);
    const SolePoint* front = sole_point_of(feet, side, FootPart::ball);
    if (heel == nullptr || front == nullptr) continue;
    const double length = (sole_place(clip, 0, *front) - sole_place(clip, 0, *heel)).norm();
    const SolePoint* end = sole_point_of(feet, side, FootPart::tip);
    ball += length;
    tip += end == nullptr
               ? 1.35 * length
               : length + (sole_place(clip, 0, *end) - sole_place(clip, 0, *front)).norm();
    ++known;
  }
  if (known == 0 || !(ball > 0)) {
    const double scale = size.leg / FootSize().leg;
    size.ball *= scale;
    size.length *= scale;
    return size;
  }
  size.ball = ball / known;
  size.length = tip / known;
  return size;
}

Result<std::vector<GroundedPrint>> set_on_ground(std::span<const Print> prints,
                                                 const FootSize& size, const Terrain& ground) {
  Walker walker;
  for (Leg& leg : walker.legs) {
    leg.length = size.leg;
    leg.sole.length = size.ball;
  }
  std::vector<GroundedPrint> placed;
  placed.reserve(prints.size());
  for (const Print& print : prints) {
    const double from = placed.empty() ? print.height.value_or(kTopStorey) : placed.back().heel.y();
    auto grounded = set_on_ground(print, static_cast<int>(placed.size()), walker, ground, from);
    if (!grounded) return grounded.error();
    placed.push_back(*std::move(grounded));
  }
  return placed;
}

std::vector<PrintContact> contacts_with_prints(const Clip& clip, const RoleMap& roles,
                                               std::span<const GroundedPrint> prints,
                                               const FootSize& size, const Terrain& ground,
                                               double near) {
  std::vector<PrintContact> contacts;
  if (prints.empty() || clip.frame_count() == 0) return contacts;
  const Feet feet = find_feet(clip, roles, up_of(ground));
  const PrintTable table(prints, size);
  for (const FootSide side : {FootSide::left, FootSide::right}) {
    int current = -1;  // index into `contacts`
    for (int f = 0; f < clip.frame_count(); ++f) {
      int print = -1;
      for (const FootPart part : {FootPart::heel, FootPart::ball}) {
        const SolePoint* point = sole_point_of(feet, side, part);
        if (point == nullptr || print >= 0) continue;
        print = table.find(side, part, sole_place(clip, f, *point), near);
      }
      if (print < 0) continue;
      const double time = f / clip.rate;
      if (current >= 0) {
        PrintContact& last = contacts[static_cast<std::size_t>(current)];
        if (last.print == print && time - last.end < kShortestGap / clip.rate) {
          last.end = time;
          continue;
        }
      }
      current = static_cast<int>(contacts.size());
      contacts.push_back({print, time, time});
    }
  }
  std::ranges::sort(contacts, [](const PrintContact& a, const PrintContact& b) {
    return std::pair(a.print, a.start) < std::pair(b.print, b.start);
  });
  return contacts;
}

}  // namespace krok::gait
