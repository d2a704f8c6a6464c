#include <fmt/format.h>

#include <cmath>

#include "core/numbers.h"
#include "motion/ground_frame.h"
#include "motion/place.h"
#include "tools/krok-edit/steps.h"

namespace krok::cli::edit {

Status take_out_travel(const Options& options, ToolContext&, Edit& edit) {
  if (!options.in_place && !options.treadmill) return {};
  const Travel removed = options.in_place ? Travel::all : Travel::trend;
  const int last = edit.clip.frame_count() - 1;
  double way = 0;
  if (last > 0) {
    const GroundFrame from = ground_frame(edit.clip, edit.carrier, 0);
    const GroundFrame to = ground_frame(edit.clip, edit.carrier, last);
    way = Vec2(to.x - from.x, to.z - from.z).norm();
  }
  edit.clip = in_place(edit.clip, edit.carrier, removed);
  const bool all = removed == Travel::all;
  Json metrics;
  metrics["removed"] = all ? "all" : "trend";
  metrics["way"] = way;
  edit.note(
      "travel", std::move(metrics),
      fmt::format("{} of {} m from first to last frame removed",
                  all ? "all root motion" : "constant-velocity root motion", readable(way, 3)));
  return {};
}

Status change_size(const Options& options, ToolContext&, Edit& edit) {
  if (!options.scale && !options.height) return {};
  const double height = reference_height(edit.clip.skeleton);
  if (options.height && !(height > 0)) {
    return Error("motion-scale", "the reference pose has no height to scale", "use --scale")
        .in_file(options.input);
  }
  const double factor = options.scale ? *options.scale : *options.height / height;
  if (Status status = scale_clip(factor, edit.clip); !status) return status;
  Json metrics;
  metrics["factor"] = factor;
  metrics["height_before"] = height;
  metrics["height"] = reference_height(edit.clip.skeleton);
  edit.note("scale", std::move(metrics),
            fmt::format("scaled by {}: height {} m instead of {} m", readable(factor),
                        readable(reference_height(edit.clip.skeleton), 4), readable(height, 4)));
  return {};
}

Status change_place(const Options& options, ToolContext&, Edit& edit) {
  Transform move;
  std::string line;
  Clip& clip = edit.clip;
  const auto apply = [&](const Transform& step, const std::string& done) {
    move_clip(step, clip);
    move = step * move;
    line += (line.empty() ? "" : ", ") + done;
  };
  const auto degrees = [](double angle) { return readable(angle / kRadiansPerDegree, 4); };
  if (options.at_origin) apply(to_origin(clip, edit.carrier), "starts above the origin");
  if (options.heading || options.re_orient) {
    const double heading = options.heading.value_or(0);
    apply(facing_at_start(clip, edit.carrier, heading),
          fmt::format("starts facing {} deg", degrees(heading)));
  }
  if (options.turn != 0) {
    apply(turned_about_start(clip, edit.carrier, options.turn),
          fmt::format("turned by {} deg", degrees(options.turn)));
  }
  if (options.move != Vec3::Zero()) {
    apply({options.move, Quat::Identity()},
          fmt::format("moved by {}, {}, {} m", readable(options.move.x()),
                      readable(options.move.y()), readable(options.move.z())));
  }
  if (options.ground) {
    const Transform lift = onto_ground(clip, foot_joints(clip.skeleton, edit.roles));
    apply(lift, fmt::format("lifted by {} m onto the ground", readable(lift.position.y(), 4)));
  }
  if (line.empty()) return {};
  Json metrics;
  metrics["moved"] = {move.position.x(), move.position.y(), move.position.z()};
  metrics["turned"] = to_degrees(2 * std::atan2(move.orientation.y(), move.orientation.w()));
  edit.note("place", std::move(metrics), std::move(line));
  return {};
}

}  // namespace krok::cli::edit
