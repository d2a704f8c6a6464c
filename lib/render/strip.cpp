#include "render/strip.h"

#include <algorithm>

namespace krok::render {

namespace {

constexpr double kFirst = 0.35;  // opacity
constexpr double kApart = 0.62;  // of the widest actor's width
// If the mean spacing is less than this fraction of the width, actors overlap too much.
constexpr double kCrowded = 0.3;

// An actor's extent in the image.
struct Width {
  double low = 0, high = 0;
};

Width width_of(const Actor& actor, const Vec3& right) {
  Width width{1e300, -1e300};
  const auto add = [&](const Vec3f& point) {
    const double at = right.dot(point.cast<double>() - actor.centre);
    width.low = std::min(width.low, at);
    width.high = std::max(width.high, at);
  };
  for (const Surface& surface : actor.surfaces) {
    for (const Vec3f& point : surface.positions) add(point);
  }
  for (const Bone& bone : actor.bones) {
    add(bone.from);
    add(bone.to);
  }
  return width.low <= width.high ? width : Width{};
}

Actor moved(const Actor& actor, const Vec3& by) {
  Actor result = actor;
  const Vec3f way = by.cast<float>();
  for (Surface& surface : result.surfaces) {
    for (Vec3f& point : surface.positions) point += way;
  }
  for (Bone& bone : result.bones) {
    bone.from += way;
    bone.to += way;
  }
  result.centre += by;
  return result;
}

}  // namespace

StripCells strip_row(const Strip& strip, Spread spread) {
  StripCells result;
  result.row.title = strip.title;
  result.row.note = strip.note;
  result.row.yaw = strip.yaw;
  result.row.elevation = strip.elevation;
  SheetCell& cell = result.row.cells.emplace_back();
  const std::size_t count = strip.moments.size();
  if (count == 0) return result;

  const Vec3 right = Camera{Vec3::Zero(), strip.yaw, strip.elevation}.right();
  double width = 0;
  double low = right.dot(strip.moments[0].actor->centre);
  double high = low;
  for (const Strip::Moment& moment : strip.moments) {
    const Width own = width_of(*moment.actor, right);
    width = std::max(width, own.high - own.low);
    low = std::min(low, right.dot(moment.actor->centre));
    high = std::max(high, right.dot(moment.actor->centre));
  }
  const auto steps = static_cast<double>(count - 1);
  result.spread_by_time = spread == Spread::time || (spread == Spread::automatic && count > 1 &&
                                                     high - low < kCrowded * width * steps);

  const Vec3 start = strip.moments[0].actor->centre;
  if (result.spread_by_time) {
    for (std::size_t i = 0; i < count; ++i) {
      const Actor& actor = *strip.moments[i].actor;
      const Vec3 place = start + kApart * width * static_cast<double>(i) * right;
      result.moved.push_back(moved(actor, place - actor.centre));
    }
  } else {
    cell.path = strip.path;
  }
  for (std::size_t i = 0; i < count; ++i) {
    const Actor& actor = result.spread_by_time ? result.moved[i] : *strip.moments[i].actor;
    const double share = count > 1 ? static_cast<double>(i) / steps : 1.0;
    cell.layers.push_back({&actor, kFirst + (1 - kFirst) * share, false});
    cell.marks.push_back({actor.centre, strip.moments[i].label});
  }
  cell.centre = start;
  cell.centre.y() = 0;
  return result;
}

}  // namespace krok::render
