#include "tools/krok-plot/charts.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <memory>
#include <set>

#include "contacts/loop_steps.h"
#include "contacts/step_measures.h"
#include "core/numbers.h"
#include "core/text.h"
#include "draw/difference_chart.h"
#include "formats/io/open_motion.h"
#include "motion/hips_root.h"
#include "motion/joint_selection.h"
#include "terrain/shapes.h"
#include "tools/cli/paths.h"
#include "tools/cli/usage.h"
#include "tools/shared/keys_sidecar.h"
#include "tools/shared/shown_ground.h"

namespace krok::cli::plot {

namespace {

using draw::ChartedMotion;
using draw::Panel;

// Number of joints shown by default for a skeleton without body angles.
constexpr int kTurningJoints = 6;

void append(std::vector<Panel>& panels, std::vector<Panel> more) {
  std::move(more.begin(), more.end(), std::back_inserter(panels));
}

// The names of joints that a pattern matches in any of the motions, in the order found. Code
// motion-joint for a pattern that matches none.
Result<std::vector<std::string>> chosen_joints(const Motions& motions,
                                               const std::vector<std::string>& patterns) {
  std::vector<std::string> names;
  std::set<std::string> known;
  for (const std::string& pattern : patterns) {
    Result<std::vector<std::uint8_t>> selected = Error();
    bool any = false;
    for (const Motions::Motion& file : motions.files) {
      const Skeleton& skeleton = file.clip.skeleton;
      selected = select_joints(skeleton, {{pattern}, {}});
      if (!selected) continue;
      any = true;
      for (std::size_t j = 0; j < selected->size(); ++j) {
        if ((*selected)[j] != 0 && known.insert(skeleton.names[j]).second) {
          names.push_back(skeleton.names[j]);
        }
      }
    }
    if (!any) return std::move(selected).error().in_file(motions.files.front().path);
  }
  return names;
}

// Assembles the charts.
class MotionChart {
 public:
  MotionChart(const Motions& motions, const Options& options, ToolContext& context)
      : motions_(motions), options_(options), context_(context) {}

  Result<draw::Chart> make() {
    auto joints = chosen_joints(motions_, options_.motion.joints);
    if (!joints) return joints.error();
    joints_ = std::move(*joints);
    std::vector<ChartKind> charts = options_.motion.charts();
    if (charts.empty()) charts = usual_charts();
    for (const ChartKind chart : charts) {
      if (Status status = add(chart); !status) return status.error();
    }
    if (chart_.panels.empty()) return nothing_to_show();
    chart_.legend = draw::motion_legend(motions_.charted, chart_.panels);
    return std::move(chart_);
  }

 private:
  std::vector<ChartKind> usual_charts() const {
    if (!joints_.empty()) return {ChartKind::positions, ChartKind::angles};
    return {ChartKind::path, ChartKind::feet, ChartKind::angles};
  }

  bool asked_for(ChartKind chart) const {
    const auto charts = options_.motion.charts();
    return std::find(charts.begin(), charts.end(), chart) != charts.end();
  }

  Status add(ChartKind chart) {
    const auto& motions = motions_.charted;
    switch (chart) {
      case ChartKind::path:
        append(chart_.panels, draw::path_panels(motions, motions_.ground));
        return {};
      case ChartKind::feet:
        add_sided(draw::foot_panels(motions, scale_of(options_.log_y), motions_.ground), chart,
                  "feet");
        return {};
      case ChartKind::angles:
        add_angles();
        return {};
      case ChartKind::cycles:
        return add_cycles();
      case ChartKind::positions:
        append(chart_.panels, draw::position_panels(motions, joints_or_carriers()));
        return {};
      case ChartKind::difference:
        return add_difference();
    }
    return {};
  }

  void add_sided(std::vector<Panel> panels, ChartKind chart, const char* what) {
    if (panels.empty() && asked_for(chart)) {
      context_.warn("plot-roles", fmt::format("no joint has a role for the {}", what),
                    "--map assigns joint roles; --joint NAME shows any joint");
    }
    append(chart_.panels, std::move(panels));
  }

  void add_angles() {
    const auto& motions = motions_.charted;
    if (joints_.empty()) {
      auto panels = draw::body_angle_panels(motions);
      if (!panels.empty() || asked_for(ChartKind::angles)) {
        add_sided(std::move(panels), ChartKind::angles, "body angles");
      } else {
        add_most_turning();
      }
      return;
    }
    append(chart_.panels, options_.motion.euler
                              ? draw::euler_panels(motions, joints_, *options_.motion.euler)
                              : draw::turn_panels(motions, joints_));
  }

  Status add_cycles() {
    draw::CycleCharts cycles = draw::cycle_charts(motions_.charted);
    if (cycles.panels.empty()) {
      return Error("plot-cycles",
                   fmt::format("no whole gait cycle, strike to strike of a foot, in {}",
                               counted(motions_.files.size(), "motion")),
                   "krok keys MOTION shows what is found of steps");
    }
    Json json;
    json["left"] = cycles.counts[0];
    json["right"] = cycles.counts[1];
    json["runs"] = cycles.runs;
    json["motions"] = cycles.motions;
    context_.report.result["cycles"] = std::move(json);
    if (cycles.motions < static_cast<int>(motions_.files.size())) {
      context_.warn("plot-cycles",
                    fmt::format("{} of {} have no whole gait cycle and are left out",
                                motions_.files.size() - static_cast<std::size_t>(cycles.motions),
                                counted(motions_.files.size(), "motion")));
    }
    const auto is_unsteady = [](const draw::ChartedMotion& motion) {
      return !step_measures(*motion.clip, *motion.roles, motion.keys.keytimes).are_steady();
    };
    if (const auto unsteady = std::ranges::count_if(motions_.charted, is_unsteady); unsteady > 0) {
      context_.warn("plot-cycles",
                    fmt::format("{} of {} step to and fro, as in a dance: the mean has them, too",
                                unsteady, counted(motions_.files.size(), "motion")),
                    "krok keys IN... --table OUT.csv names the gait of each file");
    }
    const int all = cycles.counts[0] + cycles.counts[1];
    if (10 * std::min(cycles.runs, all - cycles.runs) > all) {
      context_.warn("plot-cycles",
                    fmt::format("{} of {} gait cycles are runs: the mean with walks is neither",
                                cycles.runs, all),
                    "give walks or runs alone; krok keys IN... --table OUT.csv names the gait of "
                    "each file");
    }
    // The mean is of cycles, so that a long take counts for more than a short one.
    if (2 * cycles.max_cycles > all && 2 * cycles.max_cycles * cycles.motions > 3 * all) {
      context_.warn(
          "plot-cycles",
          fmt::format("{} of {} gait cycles are of one of {} motions, {}: the mean is mostly its",
                      cycles.max_cycles, all, cycles.motions,
                      motions_.files[static_cast<std::size_t>(cycles.max_cycles_of)].path),
          "krok-edit --from, --to shortens it");
    }
    append(chart_.panels, std::move(cycles.panels));
    chart_.title =
        fmt::format("{} left and {} right gait cycles{}, mean \u00B1 standard deviation",
                    cycles.counts[0], cycles.counts[1],
                    motions_.files.size() > 1 ? fmt::format(" of {} motions", cycles.motions) : "");
    return {};
  }

  // For skeletons without a human body.
  void add_most_turning() {
    const auto joints = draw::most_turning_joints(motions_.charted.front(), kTurningJoints);
    append(chart_.panels, draw::position_panels(motions_.charted, joints_or_carriers()));
    append(chart_.panels, draw::turn_panels(motions_.charted, joints));
  }

  std::vector<std::string> joints_or_carriers() const {
    if (!joints_.empty()) return joints_;
    std::vector<std::string> names;
    for (const Motions::Motion& file : motions_.files) {
      const auto carrier = static_cast<std::size_t>(carrying_joint(file.roles));
      const std::string& name = file.clip.skeleton.names[carrier];
      if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
    }
    return names;
  }

  Status add_difference() {
    if (motions_.charted.size() != 2) {
      return Error("usage",
                   fmt::format("a difference needs two motions, not {}", motions_.charted.size()));
    }
    const ChartedMotion& first = motions_.charted[0];
    const ChartedMotion& second = motions_.charted[1];
    auto difference = draw::difference_over_time(first, second, joints_);
    if (!difference) return difference.error();
    for (const std::string& sentence : difference->differences) {
      context_.warn("plot-difference", sentence);
    }
    report(*difference, first.clip->skeleton);
    append(chart_.panels, draw::difference_panels(*difference, scale_of(options_.log_y)));
    return {};
  }

  void report(const draw::MotionDifference& difference, const Skeleton& skeleton) {
    const auto measure = [&](const compare::Measure& values, const char* unit) {
      Json json;
      json["unit"] = reported_unit(unit);
      json["largest"] = reported(values.largest, unit);
      json["joint"] = values.where.joint < 0
                          ? Json()
                          : Json(skeleton.names[static_cast<std::size_t>(values.where.joint)]);
      json["frame"] = values.where.frame < 0 ? Json() : Json(values.where.frame);
      json["rms"] = reported(values.rms(), unit);
      return json;
    };
    Json json;
    json["joints"] = difference.joints;
    json["frames"] = difference.times.size();
    json["positions"] = measure(difference.positions, "m");
    json["orientations"] = measure(difference.orientations, "rad");
    context_.report.result["difference"] = std::move(json);
    const compare::Measure& positions = difference.positions;
    context_.log(fmt::format(
        "difference: max {} mm{}, RMS {} mm", readable(positions.largest * 1000, 4),
        positions.where.joint < 0
            ? ""
            : fmt::format(" ({} at {} s)",
                          skeleton.names[static_cast<std::size_t>(positions.where.joint)],
                          readable(positions.where.time, 4)),
        readable(positions.rms() * 1000, 4)));
  }

  Error nothing_to_show() const {
    return Error("plot-roles", "the skeleton has no joints for any of the charts in --show",
                 "--map assigns joint roles; --joint NAME shows any joint")
        .in_file(motions_.files.front().path);
  }

  const Motions& motions_;
  const Options& options_;
  ToolContext& context_;
  std::vector<std::string> joints_;
  draw::Chart chart_;
};

constexpr double kSameFrame = 1e-3;  // of a frame

Result<draw::FrameRange> frames_of(const Clip& clip, const MotionOptions& options) {
  if (clip.frame_count() == 0) {
    return Error("plot-range", "the motion has no frames");
  }
  // Clamped before rounding, because a time can be anywhere in the range of double.
  const double end = clip.frame_count() - 1;
  const double from = options.from ? options.from->seconds(clip.rate) * clip.rate : 0.0;
  const double to = options.to ? options.to->seconds(clip.rate) * clip.rate : end;
  const double first = std::ceil(std::min(from, end + 1) - kSameFrame);
  const double last = std::floor(std::min(to, end) + kSameFrame);
  if (first > last) {
    return Error("plot-range",
                 fmt::format("no frame lies between {} s and {} s", readable(from / clip.rate),
                             readable(to / clip.rate)),
                 fmt::format("the motion has {}, {} s", counted(clip.frame_count(), "frame"),
                             readable(clip.duration())));
  }
  return draw::FrameRange{static_cast<int>(first), static_cast<int>(last)};
}

// Keys that are not given are detected if `needed`; without any, there are none.
Result<MotionKeys> read_keys(const std::string& option, const Motions::Motion& file, bool needed,
                             ToolContext& context) {
  const std::string& motion = file.path;
  const Clip& clip = file.clip;
  if (option == "none") return MotionKeys();
  if (option != "auto") {
    auto given = read_keys_file(option, clip, context);
    if (!given) return given.error();
    return std::move(given->keys);
  }
  auto beside = read_keys_beside(motion, clip, context);
  if (!beside) {
    if (beside.error().hint.empty()) {
      beside.error().hint = "it was found next to the motion; --contacts none ignores it";
    }
    return beside.error();
  }
  if (*beside) return std::move((*beside)->keys);
  if (!needed) return MotionKeys();
  auto found = find_keys(file.path, clip, file.roles, context);
  return found ? *std::move(found) : MotionKeys();
}

// The cycles of a loop go on over its seam: each foot's of one round, from its first strike on.
void close_loop(Motions::Motion& file, draw::ChartedMotion& charted) {
  auto rounds = rounds_of(file.clip, file.roles);
  if (!rounds) return;
  std::vector<Keytime> keytimes = in_rounds(charted.keys.keytimes, *rounds);
  const double rate = file.clip.rate;
  for (const std::string foot : {"left", "right"}) {
    const auto first = std::ranges::find(keytimes, foot + "_strike", &Keytime::name);
    if (first == keytimes.end()) continue;
    const double end = first->time + (rounds->period + 0.5) / rate;
    std::erase_if(keytimes,
                  [&](const Keytime& key) { return key.name.starts_with(foot) && key.time > end; });
  }
  file.clip = std::move(rounds->clip);
  charted.keys.keytimes = std::move(keytimes);
  charted.frames = {0, file.clip.frame_count() - 1};
}

// The ground and the footprints of --ground and --prints.
Result<draw::ChartedGround> read_ground(const MotionOptions& options, const Motions& motions,
                                        ToolContext& context) {
  draw::ChartedGround charted;
  auto opened = options.ground.empty() ? terrain::level() : options.ground.open(context);
  if (!opened) return opened.error();
  const std::shared_ptr<const Terrain> ground = *std::move(opened);
  if (!options.ground.empty()) {
    charted.height = [ground](const Vec3& point) { return gait::height_of(*ground)(point); };
    charted.up = [ground](const Vec3& point) { return gait::up_of(*ground)(point); };
  }
  if (options.prints.empty()) return charted;
  const auto prints = open_prints(options.prints, context);
  if (!prints) return prints.error();
  std::vector<const Clip*> clips;
  for (const Motions::Motion& file : motions.files) clips.push_back(&file.clip);
  const auto shown = show_prints(*prints, *ground, clips, context);
  if (!shown) return Error(shown.error()).in_file(options.prints);
  charted.prints = viewed_prints(*shown);
  return charted;
}

}  // namespace

Result<draw::Chart> chart_motions(const Motions& motions, const Options& options,
                                  ToolContext& context) {
  return MotionChart(motions, options, context).make();
}

Result<Motions> read_motions(const std::vector<std::string>& inputs, const MotionOptions& options,
                             ToolContext& context) {
  if (options.keys != "auto" && options.keys != "none" && inputs.size() > 1) {
    return Error("usage", "--contacts takes one file, but there are several motions",
                 "--contacts auto uses the file next to each motion");
  }
  const auto find_roles_of = io::open_role_map(options.map, context);
  if (!find_roles_of) return find_roles_of.error();
  Motions motions;
  const auto charts = options.charts();
  const bool of_cycles = std::ranges::find(charts, ChartKind::cycles) != charts.end();
  for (const std::string& path : inputs) {
    auto clip = io::open_motion(path, context);
    if (!clip) {
      Status status = context.leave_out(path, std::move(clip).error(), inputs.size());
      if (!status) return status.error();
      continue;
    }
    auto roles = (*find_roles_of)(clip->skeleton);
    if (!roles) return roles.error();
    motions.files.push_back({path, std::move(*clip), std::move(*roles)});
    const Motions::Motion& file = motions.files.back();

    draw::ChartedMotion charted;
    charted.name = name_of_input(path);
    charted.clip = &file.clip;
    charted.roles = &file.roles;
    const auto frames = frames_of(file.clip, options);
    if (!frames) return Error(frames.error()).in_file(path);
    charted.frames = *frames;
    if (options.to && options.to->seconds(file.clip.rate) > file.clip.duration() + 1e-3) {
      context.warn("plot-range", fmt::format("{} ends at {} s, before --to", shown(charted.name),
                                             readable(file.clip.duration(), 4)));
    }
    auto keys = read_keys(options.keys, file, of_cycles, context);
    if (!keys) return keys.error();
    charted.keys = std::move(*keys);
    if (of_cycles && charts.size() == 1 && !options.from && !options.to) {
      close_loop(motions.files.back(), charted);
    }
    motions.charted.push_back(std::move(charted));
  }
  if (motions.files.empty()) return none_can_be_used();
  auto ground = read_ground(options, motions, context);
  if (!ground) return ground.error();
  motions.ground = *std::move(ground);
  return motions;
}

}  // namespace krok::cli::plot
