#include "formats/bvh/position_choice.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/numbers.h"

namespace krok::bvh {

namespace {

// Where a joint's values lie along its OFFSET in the median row: 0 at zero, 1 at the OFFSET.
// Nothing where the joint cannot tell.
std::optional<double> place_along_offset(const Hierarchy& hierarchy, std::size_t index,
                                         const SampleRows& rows, std::optional<Direction> up) {
  const Hierarchy::Joint& joint = hierarchy.joints[index];
  Vec3 offset = Vec3::Zero();
  for (std::size_t i = 0; i < joint.channel_count; ++i) {
    const Channel& channel = hierarchy.channels[joint.first_channel + i];
    const int axis = static_cast<int>(channel.axis);
    if (channel.kind == ChannelKind::position) offset[axis] = joint.offset[axis];
  }
  if (joint.parent < 0 && up) {
    const Vec3 direction = direction_vector(*up);
    const Vec3 height = direction * direction.dot(offset);
    if (height.norm() > 0.2 * offset.norm()) offset = height;
  }
  if (offset.isZero(0) || rows.count() == 0) return std::nullopt;
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
  const auto middle = places.begin() + static_cast<std::ptrdiff_t>(places.size() / 2);
  std::nth_element(places.begin(), middle, places.end());
  return *middle;
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
  for (std::size_t j = 0; j < hierarchy.joints.size(); ++j) {
    const auto place = place_along_offset(hierarchy, j, rows, up);
    if (!place) continue;
    if (hierarchy.joints[j].parent < 0) {
      root_place = place;
      continue;
    }
    ++(*place > 0.5 ? absolute : additive);
    if (std::abs(*place) > 0.35 && std::abs(*place - 1.0) > 0.35) ++doubtful;
  }
  const int asked = absolute + additive;
  result.has_evidence = asked > 0 || root_place;
  bool is_additive = false;
  if (asked > 0) {
    is_additive = additive > absolute;
    const int agree = std::max(absolute, additive);
    result.choice.reason =
        fmt::format("the position channels of {} of {} joints with an OFFSET stay near {}", agree,
                    asked, is_additive ? "zero" : "it");
    result.choice.confidence = agree == asked && doubtful == 0 ? Confidence::certain
                               : 4 * agree >= 3 * asked        ? Confidence::likely
                                                               : Confidence::guess;
  } else if (root_place) {
    is_additive = *root_place <= 0.5;
    const double distance = std::abs(*root_place - (is_additive ? 0.0 : 1.0));
    result.choice.reason =
        fmt::format("the root's positions lie at {} of its OFFSET, {}", readable(*root_place, 2),
                    is_additive ? "so they are added to it" : "so they replace it");
    result.choice.confidence = distance < 0.35 ? Confidence::likely : Confidence::guess;
  } else {
    result.choice.reason = rows.count() == 0 ? "there are no frames to tell by"
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
