#include "tools/krok-plot/motions.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "core/numbers.h"
#include "formats/io/open_motion.h"
#include "formats/io/open_role_map.h"
#include "terrain/level.h"
#include "tools/cli/file_name.h"
#include "tools/shared/keys_sidecar.h"
#include "tools/shared/shown_ground.h"

namespace krok::cli::plot {

namespace {

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
  auto found = find_keys(clip, file.roles, context);
  return found ? *std::move(found) : MotionKeys();
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
    if (!clip) return std::move(clip).error().in_file(path);
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
    auto keys = read_keys(options.keys, file, of_cycles, context);
    if (!keys) return keys.error();
    charted.keys = std::move(*keys);
    motions.charted.push_back(std::move(charted));
  }
  auto ground = read_ground(options, motions, context);
  if (!ground) return ground.error();
  motions.ground = *std::move(ground);
  return motions;
}

}  // namespace krok::cli::plot
