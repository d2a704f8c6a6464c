#include <fmt/format.h>

#include <Eigen/Geometry>

#include "core/numbers.h"
#include "settle/settle.h"
#include "tools/krok-edit/steps.h"

namespace krok::cli::edit {

namespace {

// Warns of slopes and stairs that the motion never comes to.
void warn_of_level_ground(const Edit& edit, ToolContext& context) {
  Eigen::AlignedBox3d under;
  for (int f = 0; f < edit.clip.frame_count(); ++f) {
    for (const Vec3f& position : edit.clip.frame_positions(f)) {
      const auto ground = edit.ground->at(position.x(), position.z());
      if (!ground) continue;
      under.extend(Vec3(position.x(), ground->height, position.z()));
      if (under.sizes().y() > 1e-4) return;
    }
  }
  if (under.isEmpty()) return;
  context.warn(
      "settle-level",
      fmt::format("--ground is level where the motion is: x {} to {} m, z {} to {} m",
                  readable(under.min().x(), 3), readable(under.max().x(), 3),
                  readable(under.min().z(), 3), readable(under.max().z(), 3)),
      "slopes and stairs begin where begin= says, or at z = 1 m: slope:12deg,begin=-2m; or "
      "move the motion with --at-origin, --move");
}

}  // namespace

Status settle_on_ground(const Options& options, ToolContext& context, Edit& edit) {
  if (!options.settle) return {};
  SettleOptions how;
  how.floor = options.floor;
  how.model = edit.model.get();
  how.jobs = context.jobs;
  if (!options.ground.empty() && !options.ground.text.starts_with("level")) {
    warn_of_level_ground(edit, context);
  }
  auto settled = settle(edit.clip, edit.roles, *edit.ground, how);
  if (!settled) return settled.error();
  context.diagnose(settled->warnings);
  edit.clip = std::move(settled->clip);
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
  if (settled->turned_joint >= 0) {
    line += fmt::format("; largest turn {} ({})", in_degrees(settled->largest_turn),
                        edit.clip.skeleton.names[static_cast<std::size_t>(settled->turned_joint)]);
  }
  edit.note("settle", std::move(metrics), std::move(line));
  return {};
}

}  // namespace krok::cli::edit
