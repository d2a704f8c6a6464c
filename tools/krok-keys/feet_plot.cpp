#include "tools/krok-keys/feet_plot.h"

#include <fmt/format.h>

#include <algorithm>

#include "draw/plot.h"

namespace krok::cli::keys {

namespace {

// Lane of a contact by the foot point on that joint, from the bottom: heel, ball, tip.
int lane_of(const FoundContacts& found, FootSide side, int joint) {
  for (const PointTrack& track : found.tracks) {
    if (track.point.side == side && track.point.joint == joint) {
      return static_cast<int>(track.point.part);
    }
  }
  return -1;
}

// left_strike and the like belong to one foot, other names to both.
bool concerns(FootSide side, const std::string& name) {
  const char* other = name_of(side == FootSide::left ? FootSide::right : FootSide::left);
  return !name.starts_with(other);
}

draw::Panel panel_of(const Clip& clip, const FoundContacts& found, const MotionKeys& keys,
                     FootSide side, bool heights) {
  draw::Panel panel;
  panel.title =
      fmt::format("{} foot: {}", name_of(side), heights ? "height above support" : "speed");
  panel.x = {"time", "s"};
  panel.x.low = 0;
  panel.x.high = std::max(clip.duration(), 1 / clip.rate);
  panel.y = heights ? draw::Axis{"height", "m"} : draw::Axis{"speed", "m/s"};
  for (const PointTrack& track : found.tracks) {
    if (track.point.side != side) continue;
    draw::Series series;
    series.name = name_of(track.point.part);
    if (track.point.estimated) series.name += " (estimated)";
    series.colour = static_cast<int>(track.point.part);
    series.y = heights ? track.height : track.speed;
    for (std::size_t f = 0; f < series.y.size(); ++f) {
      series.x.push_back(static_cast<double>(f) / clip.rate);
    }
    panel.series.push_back(std::move(series));
  }
  for (const Contact& contact : keys.contacts) {
    const int lane = lane_of(found, side, contact.joint);
    if (lane >= 0) panel.spans.push_back({contact.start, contact.end, lane, lane});
  }
  panel.lanes = {"heel", "ball", "tip"};
  for (const Keytime& key : keys.keytimes) {
    if (concerns(side, key.name)) panel.moments.push_back({key.time, heights ? key.name : ""});
  }
  return panel;
}

}  // namespace

Result<std::string> feet_plot(const std::string& title, const Clip& clip,
                              const FoundContacts& found, const MotionKeys& keys) {
  draw::Chart chart;
  chart.title = title;
  chart.panel_width = std::clamp(150 * clip.duration(), 640.0, 6000.0);
  chart.panel_height = 150;
  for (const FootSide side : {FootSide::left, FootSide::right}) {
    for (const bool heights : {true, false}) {
      chart.panels.push_back(panel_of(clip, found, keys, side, heights));
    }
  }
  return draw::to_svg(chart);
}

}  // namespace krok::cli::keys
