#include "formats/bvh/choose_conventions_internal.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/numbers.h"
#include "formats/bvh/kinematics.h"

namespace krok::bvh {

namespace {

double median(std::vector<double>& values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

// The components of a joint's OFFSET that its position channels could replace.
Vec3 replaced_offset(const Hierarchy& hierarchy, const Hierarchy::Joint& joint) {
  Vec3 offset = Vec3::Zero();
  for (std::size_t i = 0; i < joint.channel_count; ++i) {
    const Channel& channel = hierarchy.channels[joint.first_channel + i];
    const int axis = static_cast<int>(channel.axis);
    if (channel.kind == ChannelKind::position) offset[axis] = joint.offset[axis];
  }
  return offset;
}

// Position of a joint's values along its OFFSET in the median row: 0 at zero, 1 at the OFFSET.
// nullopt if the joint has no position channels, no OFFSET, or there are no rows. Of a root only
// the heights count where up is known: takes start anywhere on the ground. Infinity if its OFFSET
// has none.
std::optional<double> place_along_offset(const Hierarchy& hierarchy, std::size_t index,
                                         const SampleRows& rows, std::optional<Direction> up) {
  const Hierarchy::Joint& joint = hierarchy.joints[index];
  Vec3 offset = replaced_offset(hierarchy, joint);
  if (offset.isZero(0) || rows.count() == 0) return std::nullopt;
  if (joint.parent < 0 && up) {
    const Vec3 direction = direction_vector(*up);
    const Vec3 height = direction * direction.dot(offset);
    if (height.norm() < 1e-3 * offset.norm()) return INFINITY;
    offset = height;
  }
  std::vector<double> places;
  for (std::size_t row = 0; row < rows.count(); ++row) {
    Vec3 value = Vec3::Zero();
    for (std::size_t i = 0; i < joint.channel_count; ++i) {
      const std::size_t c = joint.first_channel + i;
      const Channel& channel = hierarchy.channels[c];
      if (channel.kind == ChannelKind::position) {
        value[static_cast<int>(channel.axis)] = rows.row(row)[c];
      }
    }
    places.push_back(value.dot(offset) / offset.squaredNorm());
  }
  return median(places);
}

// The only child of the root, usually the hips, if it branches: it carries the whole skeleton as
// the root does, and so travels. -1 if there is none.
int carrier_below_root(const Hierarchy& hierarchy) {
  const auto children = [&](int parent) {
    std::vector<int> found;
    for (std::size_t j = 0; j < hierarchy.joints.size(); ++j) {
      const auto& joint = hierarchy.joints[j];
      if (joint.parent == parent && !joint.end_site) found.push_back(static_cast<int>(j));
    }
    return found;
  };
  const std::vector<int> below = children(0);
  return below.size() == 1 && children(below[0]).size() > 1 ? below[0] : -1;
}

// Median height of the lowest joint relative to the character's height, with positions replacing
// OFFSETs and added to them.
struct HeightsOverGround {
  double absolute = 0;
  double additive = 0;
};

// Medians of the lowest joint's height and of the character's height.
struct Stance {
  double low = 0;
  double size = 0;
};

// Uses the joints from the carrier on; a root above it may be on the ground.
std::optional<Stance> median_stance(const Hierarchy& hierarchy, const SampleRows& rows,
                                    Positions positions, const Vec3& vertical) {
  const auto first = static_cast<std::size_t>(std::max(0, carrier_below_root(hierarchy)));
  const Kinematics kinematics(hierarchy, positions, {});
  std::vector<Transform> pose(kinematics.joint_count());
  std::vector<double> lows;
  std::vector<double> sizes;
  constexpr std::size_t kEnough = 16;  // more rows hardly move a median, and each costs a pose
  const std::size_t step = (rows.count() + kEnough - 1) / kEnough;
  for (std::size_t row = 0; row < rows.count(); row += step) {
    kinematics.pose(rows.row(row), pose);
    double low = INFINITY;
    double high = -INFINITY;
    for (std::size_t j = first; j < pose.size(); ++j) {
      low = std::min(low, pose[j].position.dot(vertical));
      high = std::max(high, pose[j].position.dot(vertical));
    }
    if (!std::isfinite(low) || !std::isfinite(high)) continue;
    lows.push_back(low);
    sizes.push_back(high - low);
  }
  if (lows.empty()) return std::nullopt;
  return Stance{median(lows), median(sizes)};
}

// nullopt if both modes give the same height, or the character has no height.
std::optional<HeightsOverGround> heights_over_ground(const Hierarchy& hierarchy,
                                                     const SampleRows& rows, Direction up) {
  const Vec3 vertical = direction_vector(up);
  const auto absolute = median_stance(hierarchy, rows, Positions::absolute, vertical);
  const auto additive = median_stance(hierarchy, rows, Positions::additive, vertical);
  if (!absolute || !additive || !(absolute->size > 0) || absolute->low == additive->low) {
    return std::nullopt;
  }
  return HeightsOverGround{absolute->low / absolute->size, additive->low / absolute->size};
}

// The root's positions are neither near its OFFSET nor near zero, relative to the character's size.
bool lies_far_from_both(double root_place, const HeightsOverGround& heights) {
  constexpr double kNearZero = 0.25;
  const double height = root_place * (heights.additive - heights.absolute);
  return (root_place < -0.5 || root_place > 1.5) && std::abs(height) > kNearZero;
}

// The ground is at 0. Decides if the character is on it in one mode and clearly above or below it
// in the other.
std::optional<PositionChoice> choose_by_ground(const HeightsOverGround& heights) {
  constexpr double kNear = 0.08;
  const auto clearly_nearer = [](double a, double b) {
    return std::abs(a) <= kNear && std::abs(b) > kNear && std::abs(b) > 3 * std::abs(a);
  };
  const bool absolute = clearly_nearer(heights.absolute, heights.additive);
  if (!absolute && !clearly_nearer(heights.additive, heights.absolute)) return std::nullopt;
  const auto percent = [](double share) { return readable(std::round(100 * share), 3); };
  PositionChoice result;
  result.positions = absolute ? Positions::absolute : Positions::additive;
  result.has_evidence = result.by_ground = true;
  result.choice.choice = absolute ? "absolute" : "additive";
  result.choice.reason = fmt::format(
      "the lowest joint is {}% of the character's height from the ground if the root's positions "
      "{} its OFFSET, {}% if they {} it",
      percent(absolute ? heights.absolute : heights.additive), absolute ? "replace" : "add to",
      percent(absolute ? heights.additive : heights.absolute), absolute ? "add to" : "replace");
  result.choice.confidence = Confidence::likely;
  return result;
}

}  // namespace

PositionChoice choose_positions(const Hierarchy& hierarchy, const SampleRows& rows,
                                std::optional<Direction> up) {
  PositionChoice result;
  result.choice.choice = "absolute";
  int absolute = 0;
  int additive = 0;
  int doubtful = 0;
  std::optional<double> root_place;
  const int carrier = carrier_below_root(hierarchy);
  for (std::size_t j = 0; j < hierarchy.joints.size(); ++j) {
    const auto place = place_along_offset(hierarchy, j, rows, up);
    if (!place) continue;
    if (hierarchy.joints[j].parent < 0 || static_cast<int>(j) == carrier) {
      root_place = place;
      continue;
    }
    ++(*place > 0.5 ? absolute : additive);
    if (std::abs(*place) > 0.35 && std::abs(*place - 1.0) > 0.35) ++doubtful;
  }
  const int asked = absolute + additive;
  result.has_evidence = asked > 0 || root_place;
  result.depends_on_up = asked == 0 && root_place;
  bool is_additive = false;
  if (asked > 0) {
    is_additive = additive > absolute;
    const int agree = std::max(absolute, additive);
    result.choice.reason =
        fmt::format("the position channels of {} of {} joints with an OFFSET are near {}", agree,
                    asked, is_additive ? "zero" : "it");
    result.choice.confidence = agree == asked && doubtful == 0 ? Confidence::certain
                               : 4 * agree >= 3 * asked        ? Confidence::likely
                                                               : Confidence::guess;
  } else if (root_place) {
    const auto heights = up ? heights_over_ground(hierarchy, rows, *up) : std::nullopt;
    if (heights) {
      if (const auto by_ground = choose_by_ground(*heights)) return *by_ground;
    }
    const bool level = std::isinf(*root_place);
    const bool usual = !up || level || (heights && lies_far_from_both(*root_place, *heights));
    is_additive = *root_place <= 0.5 && !usual;
    const double distance = std::abs(*root_place - (is_additive ? 0.0 : 1.0));
    result.choice.reason =
        level ? "the root's OFFSET is horizontal; in most files the positions replace it"
              : fmt::format("the root's positions are at {} of its OFFSET, {}",
                            readable(*root_place, 2),
                            !up           ? "and up is unclear; in most files they replace it"
                            : usual       ? "which is inconclusive; in most files they replace it"
                            : is_additive ? "so they are added to it"
                                          : "so they replace it");
    result.choice.confidence = level || (distance < 0.35 && (up || *root_place > 0.5))
                                   ? Confidence::likely
                                   : Confidence::guess;
  } else {
    result.choice.reason = rows.count() == 0 ? "there are no frames to decide from"
                                             : "no joint has both position channels and an OFFSET";
    result.choice.confidence = Confidence::certain;
  }
  if (is_additive) {
    result.positions = Positions::additive;
    result.choice.choice = "additive";
  }
  return result;
}

}  // namespace krok::bvh
