#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "character/space.h"
#include "contacts/loop_steps.h"
#include "contacts/sole_points.h"
#include "core/numbers.h"
#include "core/parallel.h"
#include "motion/hips_root.h"
#include "motion/travel.h"
#include "roles/body_frame.h"
#include "scene/frame_source.h"
#include "settle/settle.h"
#include "tools/krok-edit/steps.h"

namespace krok::cli::edit {

namespace {

// The mean facing of a joint, radians; `front`: that of the reference pose.
double facing_of(const Clip& clip, int joint, double front) {
  Vec2 facing = Vec2::Zero();
  for (int f = 0; f < clip.frame_count(); ++f) {
    const double heading = front + ground_frame(clip, joint, f).heading;
    facing += Vec2(std::sin(heading), std::cos(heading));
  }
  return std::atan2(facing.x(), facing.y());
}

// The heading of the removed travel, or its opposite where the character walks backwards. Where it
// walks sideways or hardly at all, the facing of its head, as the pelvis may be turned by its
// stance.
double forward(const Edit& edit) {
  constexpr double kAlong = 55 * kRadiansPerDegree;
  constexpr double kWalks = 0.1;  // metres per second
  const double front = front_of(edit.clip.skeleton, edit.roles);
  std::vector<double> facings;
  for (const Role role : {Role::head, Role::chest}) {
    const int joint = edit.roles.joint(role);
    if (joint >= 0) facings.push_back(facing_of(edit.clip, joint, front));
  }
  if (facings.empty()) facings.push_back(facing_of(edit.clip, edit.carrier, front));
  const auto& removed = edit.clip.provenance.removed_root_motion;
  const Vec3 velocity = removed ? removed->velocity : Vec3::Zero();
  if (std::hypot(velocity.x(), velocity.z()) < kWalks) return facings.front();
  const double travel = std::atan2(velocity.x(), velocity.z());
  const auto is_along = [&](double way) {
    return std::ranges::any_of(
        facings, [&](double facing) { return std::abs(wrapped(way - facing)) < kAlong; });
  };
  if (is_along(travel)) return travel;
  return is_along(travel + kPi) ? travel + kPi : facings.front();
}

std::string velocity_text(const RootMotion& removed) {
  const Vec3& v = removed.velocity;
  std::string text = fmt::format("{} m/s ({}, {}, {})", readable(v.norm(), 4), readable(v.x(), 4),
                                 readable(v.y(), 4), readable(v.z(), 4));
  if (removed.turn_rate != 0) text += fmt::format(", {}/s", in_degrees(removed.turn_rate));
  return text;
}

// A person's stature, which no pose changes; of other skeletons the reference pose's height.
double height_of(const Skeleton& skeleton) {
  const RoleMap roles = find_roles(skeleton);
  const auto stature = roles.humanoid ? stature_of(skeleton, roles) : std::nullopt;
  return stature ? stature->metres : reference_height(skeleton);
}

// Warns of hips that jump, which neither planted feet nor a velocity that is taken out allows for.
Status warn_of_jumps(const Options& options, const Edit& edit, ToolContext& context) {
  std::vector<Vec3f> track;
  const FrameSource source = edit.source();
  track.reserve(static_cast<std::size_t>(source.frame_count));
  const auto look = [&](int, const Clip& part) {
    for (int f = 0; f < part.frame_count(); ++f) {
      track.push_back(part.frame_positions(f)[static_cast<std::size_t>(edit.carrier)]);
    }
    return Status();
  };
  if (Status status = for_each_block(source, 1, look); !status) return status;
  const std::vector<Jump> jumps = jumps_of(track, source.rate);
  if (jumps.empty()) return {};
  const Jump& first = jumps.front();
  context.warn(
      "edit-jump",
      fmt::format("the hips jump by {} m at {} s (frame {} of the cut take){}: {}",
                  readable(first.distance, 3), readable(first.frame / source.rate, 3), first.frame,
                  jumps.size() > 1 ? fmt::format(", and {} more times", jumps.size() - 1) : "",
                  options.in_place || options.treadmill
                      ? "the velocity that is taken out includes it"
                      : "no foot is planted across that"),
      "cut the parts with --from and --to; krok-lint lists jumps");
  return {};
}

// Warns of slopes and stairs that the motion never comes to.
Status warn_of_level_ground(const FrameSource& frames, const Edit& edit, ToolContext& context) {
  Eigen::AlignedBox3d under;
  const auto level = [&] { return under.isEmpty() || under.sizes().y() <= 1e-4; };
  const auto look = [&](int, const Clip& part) {
    for (const Vec3f& position : part.positions) {
      if (!level()) break;
      const auto ground = edit.ground->at(position.x(), position.z());
      if (ground) under.extend(Vec3(position.x(), ground->height, position.z()));
    }
    return Status();
  };
  if (Status status = for_each_block(frames, 1, look); !status) return status;
  if (under.isEmpty() || !level()) return {};
  context.warn(
      "settle-level",
      fmt::format("--ground is level where the motion is: x {} to {} m, z {} to {} m",
                  readable(under.min().x(), 3), readable(under.max().x(), 3),
                  readable(under.min().z(), 3), readable(under.max().z(), 3)),
      "slopes and stairs begin where begin= says, or at z = 1 m: slope:12deg,begin=-2m; or "
      "move the motion with --at-origin, --move");
  return {};
}

}  // namespace

// Whether a motion is a loop in place; then what its feet show is its root motion, if none was
// taken out of it.
bool take_root_motion(Edit& edit) {
  const auto displacement = loop_displacement(edit.clip, edit.carrier);
  if (!displacement || !is_in_place(*displacement, edit.clip.skeleton)) return false;
  auto& removed = edit.clip.provenance.removed_root_motion;
  if (removed) return true;
  const Vec3 velocity = velocity_of_feet(edit.clip, edit.roles);
  removed.emplace().velocity = velocity;
  edit.note("feet",
            {{"speed", velocity.norm()}, {"velocity", {velocity.x(), velocity.y(), velocity.z()}}},
            !edit.roles.humanoid ? "a loop in place without known feet: its velocity is set to 0 "
                                   "m/s, what moves it has to say the speed"
            : velocity.isZero()  ? "a loop in place whose feet do not walk: its velocity is 0 m/s"
                                : "a loop in place; an engine moves it at the speed of its feet, " +
                                      velocity_text(*removed));
  return true;
}

void complete_game_loop(Options& options, Edit& edit) {
  if (!options.game_loop) return;
  const bool ends = options.from || options.to;
  const bool changed = ends || options.cycle != CycleFoot::none || !options.append.empty();
  edit.kept_loop = take_root_motion(edit) && !changed;
  if (edit.kept_loop) return;
  options.at_origin = true;
  options.plant = true;
  if (options.cycle == CycleFoot::none && !(ends && options.loop)) {
    options.cycle = CycleFoot::either;
  }
  if (options.looping.turn == LoopTurn::automatic) options.looping.turn = LoopTurn::straighten;
  options.treadmill = !options.in_place;
}

Status take_out_travel(const Options& options, ToolContext& context, Edit& edit) {
  if (options.plant || options.in_place || options.treadmill) {
    if (Status status = warn_of_jumps(options, edit, context); !status) return status;
  }
  if (!options.in_place && !options.treadmill) return {};
  const Travel removed = options.in_place ? Travel::all : Travel::trend;
  const FrameSource source = edit.source();
  const int last = source.frame_count - 1;
  Vec3 way = Vec3::Zero();
  auto& root_motion = edit.clip.provenance.removed_root_motion;
  if (last > 0) {
    const GroundFrame from = ground_frame(edit.clip, edit.carrier, 0);
    const auto end = load(part_of(source, last, 1), 1);
    if (!end) return end.error();
    const GroundFrame to = ground_frame(*end, edit.carrier, 0);
    way = Vec3(to.x - from.x, 0, to.z - from.z);
    // What was removed before is still missing.
    if (!root_motion) root_motion.emplace();
    root_motion->velocity += way / source.duration();
    root_motion->turn_rate += edit.turn_rate;
  }
  Status status = edit.take(in_place(source, edit.carrier, removed, thread_count(context.jobs)));
  if (!status) return status;
  if (edit.climb_rate != 0) {
    Provenance kept = edit.clip.provenance;
    edit.clip = carried_along(edit.clip, edit.carrier, {Vec3(0, -edit.climb_rate, 0), 0});
    edit.clip.provenance = std::move(kept);
    root_motion->velocity.y() += edit.climb_rate;
  }
  const bool all = removed == Travel::all;
  Json metrics;
  metrics["removed"] = all ? "all" : "trend";
  metrics["way"] = way.norm();
  std::string line = fmt::format("{} of {} m from first to last frame removed",
                                 all ? "all root motion" : "constant-velocity root motion",
                                 readable(way.norm(), 3));
  if (root_motion) {
    metrics["speed"] = root_motion->velocity.norm();
    metrics["turn_rate"] = to_degrees(root_motion->turn_rate);
    line += ", " + velocity_text(*root_motion);
  }
  edit.note("travel", std::move(metrics), std::move(line));
  return {};
}

Status change_size(const Options& options, ToolContext& context, Edit& edit) {
  if (!options.scale && !options.height) return {};
  const double height = height_of(edit.clip.skeleton);
  if (options.height && !(height > 0)) {
    return Error("motion-scale", "the reference pose has no height to scale", "use --scale")
        .in_file(options.input);
  }
  const double factor = options.scale ? *options.scale : *options.height / height;
  if (Status status = scale_clip(factor, edit.clip); !status) return status;
  if (edit.frames) {
    edit.frames = changed(*edit.frames, [factor](Clip& part) { return scale_clip(factor, part); });
    edit.frames->skeleton = edit.clip.skeleton;
  }
  if (auto& removed = edit.clip.provenance.removed_root_motion) removed->velocity *= factor;
  const double made = height_of(edit.clip.skeleton);
  if (character::is_plausible_size(height) && !character::is_plausible_size(made)) {
    context.warn("motion-scale",
                 fmt::format("{} is {} m high now", options.input, readable(made, 3)),
                 "motions are in metres; a capture's unit is set by krok-import --unit");
  }
  Json metrics;
  metrics["factor"] = factor;
  metrics["height_before"] = height;
  metrics["height"] = made;
  edit.note("scale", std::move(metrics),
            fmt::format("scaled by {}: height {} m instead of {} m", readable(factor),
                        readable(made, 4), readable(height, 4)));
  return {};
}

Status change_place(const Options& options, ToolContext& context, Edit& edit) {
  Transform move;
  std::string line;
  Clip& clip = edit.clip;
  const auto apply = [&](const Transform& step, const std::string& done) {
    move_clip(step, clip);
    if (edit.frames) {
      edit.frames = changed(*edit.frames, [step](Clip& part) {
        move_clip(step, part);
        return Status();
      });
    }
    move = step * move;
    line += (line.empty() ? "" : ", ") + done;
  };
  const auto degrees = [](double angle) { return readable(angle / kRadiansPerDegree, 4); };
  if (options.at_origin) apply(to_origin(clip, edit.carrier), "starts above the origin");
  auto& root_motion = clip.provenance.removed_root_motion;
  if (options.game_loop && !edit.kept_loop && !options.heading && !options.re_orient) {
    const double turn = std::remainder(-forward(edit), 2 * kPi);
    apply(turned_about_start(clip, edit.carrier, turn),
          fmt::format("turned by {} deg to +Z", degrees(turn)));
  }
  if (options.heading || options.re_orient) {
    const double heading = options.heading.value_or(0);
    apply(facing_at_start(clip, edit.carrier, heading - front_of(clip.skeleton, edit.roles)),
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
  if (options.on_ground) {
    const auto feet = foot_joints(clip.skeleton, edit.roles);
    Transform lift = onto_ground(clip, feet);
    if (edit.frames) {
      const Status status =
          for_each_block(*edit.frames, thread_count(context.jobs), [&](int, const Clip& part) {
            lift.position.y() = std::max(lift.position.y(), onto_ground(part, feet).position.y());
            return Status();
          });
      if (!status) return status;
    }
    apply(lift, fmt::format("lifted by {} m onto the ground", readable(lift.position.y(), 4)));
  }
  if (line.empty()) return {};
  if (root_motion) {
    Vec3& velocity = root_motion->velocity;
    velocity = (move.orientation * velocity).unaryExpr([](double part) {
      return std::abs(part) < 1e-9 ? 0.0 : part;  // rounding
    });
  }
  Json metrics;
  if (root_motion && options.game_loop) {
    const Vec3& velocity = root_motion->velocity;
    metrics["velocity"] = {velocity.x(), velocity.y(), velocity.z()};
    line += fmt::format("; an engine moves it at {}", velocity_text(*root_motion));
    // Of what is written, which may slide where the seam was closed.
    const auto moving = travelling(clip, edit.carrier);
    const double slide = slide_speed(moving ? *moving : clip, edit.roles);
    metrics["slide_speed"] = slide;
    line += fmt::format(", the lower foot then slides at {} mm/s", readable(1000 * slide, 3));
  }
  metrics["moved"] = {move.position.x(), move.position.y(), move.position.z()};
  metrics["turned"] = to_degrees(2 * std::atan2(move.orientation.y(), move.orientation.w()));
  edit.note("place", std::move(metrics), std::move(line));
  return {};
}

Status settle_on_ground(const Options& options, ToolContext& context, Edit& edit) {
  if (!options.settle) return {};
  SettleOptions how;
  how.floor = options.floor;
  how.model = edit.model.get();
  how.jobs = context.jobs;
  if (!options.ground.empty() && !options.ground.text.starts_with("level")) {
    if (Status status = warn_of_level_ground(edit.source(), edit, context); !status) return status;
  }
  auto settled = settle(edit.source(), edit.roles, *edit.ground, how);
  if (!settled) return settled.error();
  context.diagnose(settled->warnings);
  if (Status status = edit.take(std::move(settled->frames)); !status) return status;
  Json metrics;
  const auto put = [&](const char* name, const GroundFit& fit) {
    metrics[name] = {{"depth", fit.depth}, {"hover", fit.hover}};
  };
  put("before", settled->before);
  put("after", settled->after);
  metrics["floor"] = settled->floor;
  metrics["jerk"] = settled->jerk;
  metrics["largest_turn"] = to_degrees(settled->largest_turn);
  metrics["touches"] = Json::array();
  for (const SettledTouch& touch : settled->touches) {
    metrics["touches"].push_back({{"part", touch.part},
                                  {"start", touch.first / edit.clip.rate},
                                  {"end", touch.last / edit.clip.rate},
                                  {"depth", touch.depth},
                                  {"hover", touch.hover}});
  }
  const auto mm = [](double metres) { return readable(1000 * metres, 3); };
  std::string line = fmt::format(
      "settled on the ground: {}, at most {} mm deep (before {}) and {} mm above it (before {})",
      counted(static_cast<int>(settled->touches.size()), "touch", "touches"),
      mm(settled->after.depth), mm(settled->before.depth), mm(settled->after.hover),
      mm(settled->before.hover));
  if (how.model == nullptr) line += ", by bodies of usual sizes (--model measures a mesh)";
  if (settled->turned_joint >= 0) {
    line += fmt::format("; largest turn {} ({})", in_degrees(settled->largest_turn),
                        edit.clip.skeleton.names[static_cast<std::size_t>(settled->turned_joint)]);
  }
  edit.note("settle", std::move(metrics), std::move(line));
  return {};
}

}  // namespace krok::cli::edit
