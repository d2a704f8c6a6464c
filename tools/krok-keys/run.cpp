#include "tools/krok-keys/options.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <string>

#include "contacts/contacts.h"
#include "contacts/long_take.h"
#include "contacts/loop_steps.h"
#include "core/numbers.h"
#include "core/result.h"
#include "draw/plot.h"
#include "formats/chart/chart_writer.h"
#include "formats/io/open_motion.h"
#include "formats/keys/keys.h"
#include "scene/clip.h"
#include "tools/cli/output_set.h"
#include "tools/cli/paths.h"
#include "tools/cli/usage.h"
#include "tools/krok-keys/gait_table.h"
#include "tools/shared/keys_sidecar.h"

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

// SVG plot of height above the support and speed of each foot's points over time, with contacts as
// bars and keytimes as vertical lines.
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

bool stands(const std::string& path) {
  std::error_code ignored;
  return !path.empty() && path != "-" && std::filesystem::is_regular_file(path, ignored);
}

// The output file is also read first, to keep manual edits in it.
Result<std::optional<krok::keys::Sidecar>> read_before(const Options& options, const Clip& clip,
                                                       ToolContext& context) {
  if (options.discard_edits) return std::optional<krok::keys::Sidecar>();
  if (!options.keys.empty()) {
    auto sidecar = read_keys_file(options.keys, clip, context);
    if (!sidecar) return std::move(sidecar).error();
    return std::optional<krok::keys::Sidecar>(std::move(*sidecar));
  }
  const bool beside = context.output.empty();
  const std::string path = beside ? keys_sidecar_path(options.input()) : context.output;
  if (!stands(path)) return std::optional<krok::keys::Sidecar>();
  const auto file = InputFile::open(path);
  if (!file) return file.error();
  // What was found and not edited is found again, whatever motion it was.
  if (options.find != Find::none && !krok::keys::has_edits(file->text())) {
    return std::optional<krok::keys::Sidecar>();
  }
  if (beside) return read_keys_beside(options.input(), clip, context);
  auto sidecar = krok::keys::read_sidecar(file->text(), path, clip.skeleton, clip.duration());
  if (!sidecar) {
    Error error = std::move(sidecar).error();
    if (error.hint.empty()) error.hint = "--discard-edits replaces the file";
    return error;
  }
  return std::optional<krok::keys::Sidecar>(std::move(*sidecar));
}

struct Found {
  std::optional<FoundContacts> contacts;  // if the feet are known
  MotionKeys keys;
};

Result<Found> find(const Clip& clip, const RoleMap& roles, ToolContext& context) {
  auto steps = find_steps(clip, roles);
  if (!steps) return std::move(steps).error();
  context.diagnose(steps->contacts.warnings);
  context.diagnose(steps->gait.warnings);
  Found found;
  found.keys = {steps->contacts.contacts, std::move(steps->gait.keytimes)};
  found.contacts = std::move(steps->contacts);
  return found;
}

// Whether to detect steps; an Error if that would discard unmarked edits.
Result<bool> is_to_find(const Options& options, const std::optional<krok::keys::Sidecar>& before) {
  if (options.find == Find::none) return false;
  if (!before || !before->has_edits()) return true;
  if (options.find == Find::automatic) return false;
  if (!before->edited) return true;
  return Error("keys-edited",
               "the keytime file has unmarked edits, which finding steps again "
               "would discard",
               "mark them with \"by\": \"hand\", or use --discard-edits");
}

// A keytime that is set far from those of its name is one more.
void log_added(const std::vector<Keytime>& before, const std::vector<Keytime>& now,
               ToolContext& context) {
  for (const Keytime& key : now) {
    double nearest = std::numeric_limits<double>::infinity();
    for (const Keytime& other : before) {
      if (other.name == key.name) nearest = std::min(nearest, std::abs(other.time - key.time));
    }
    if (nearest <= kSameKeytime || !std::isfinite(nearest)) continue;
    context.log(fmt::format("{} at {} s is one more; the nearest that was found is {} s away",
                            key.name, readable(key.time), readable(nearest, 3)));
  }
}

std::string as_table(const krok::keys::Sidecar& sidecar, const Skeleton& skeleton) {
  std::string text;
  const auto hand = [](const std::vector<std::uint8_t>& marks, std::size_t i) {
    return i < marks.size() && marks[i] != 0 ? "  by hand" : "";
  };
  for (std::size_t i = 0; i < sidecar.keys.keytimes.size(); ++i) {
    const Keytime& key = sidecar.keys.keytimes[i];
    text += fmt::format("{:9.3f} s  {}{}\n", key.time, key.name, hand(sidecar.keytimes_by_hand, i));
  }
  for (std::size_t i = 0; i < sidecar.keys.contacts.size(); ++i) {
    const Contact& contact = sidecar.keys.contacts[i];
    text += fmt::format("{:9.3f} s to {:7.3f} s  {} at {:.3f}, {:.3f}, {:.3f} m{}\n", contact.start,
                        contact.end, skeleton.names[static_cast<std::size_t>(contact.joint)],
                        contact.place.x(), contact.place.y(), contact.place.z(),
                        hand(sidecar.contacts_by_hand, i));
  }
  return text;
}

// Null for what no step shows.
Json number(const std::optional<double>& value) {
  return value ? Json(*value) : Json();
}

Json as_json(const GaitFacts& facts) {
  const auto& [gait, steps, slide] = facts;
  const auto if_known = [](bool known, double value) { return known ? Json(value) : Json(); };
  const bool cycles = gait.cycles > 0;
  return {
      {"cycles", gait.cycles},
      {"cycle", if_known(cycles, gait.cycle)},
      {"cadence", if_known(cycles, gait.cadence)},
      {"stance",
       {if_known(gait.stance[0] > 0, gait.stance[0]),
        if_known(gait.stance[1] > 0, gait.stance[1])}},
      {"double_support", if_known(gait.stance[0] > 0 && gait.stance[1] > 0, gait.double_support)},
      {"steps", steps.steps},
      {"speed", number(steps.speed)},
      {"stride_length", number(steps.stride_length)},
      {"step_length", {number(steps.step_length[0]), number(steps.step_length[1])}},
      {"step_width", number(steps.step_width)},
      {"slide_speed", slide}};
}

Json as_json(const krok::keys::Sidecar& sidecar, const Skeleton& skeleton) {
  const auto hand = [](const std::vector<std::uint8_t>& marks, std::size_t i) {
    return i < marks.size() && marks[i] != 0;
  };
  Json keytimes = Json::array(), contacts = Json::array();
  for (std::size_t i = 0; i < sidecar.keys.keytimes.size(); ++i) {
    const Keytime& key = sidecar.keys.keytimes[i];
    keytimes.push_back(
        {{"name", key.name}, {"time", key.time}, {"by_hand", hand(sidecar.keytimes_by_hand, i)}});
  }
  for (std::size_t i = 0; i < sidecar.keys.contacts.size(); ++i) {
    const Contact& contact = sidecar.keys.contacts[i];
    contacts.push_back({{"joint", skeleton.names[static_cast<std::size_t>(contact.joint)]},
                        {"start", contact.start},
                        {"end", contact.end},
                        {"place", {contact.place.x(), contact.place.y(), contact.place.z()}},
                        {"by_hand", hand(sidecar.contacts_by_hand, i)}});
  }
  Json json;
  json["keytimes"] = std::move(keytimes);
  json["contacts"] = std::move(contacts);
  return json;
}

std::string gait_text(const GaitFacts& facts) {
  const auto& [gait, steps, slide] = facts;
  if (gait.cycles == 0) return {};
  const auto stance = [&](double share) {
    return share > 0 ? fmt::format("{:.0f} %", 100 * share) : std::string("an unknown part");
  };
  std::string text = fmt::format("; {:.0f} steps per minute, stance {} and {} of a cycle",
                                 gait.cadence, stance(gait.stance[0]), stance(gait.stance[1]));
  if (steps.speed) {
    text += fmt::format(", {} m/s, strides of {} m", readable(*steps.speed, 3),
                        readable(*steps.stride_length, 3));
  }
  if (!facts.is_run()) text += fmt::format(", foot skate {:.1f} mm/s", 1e3 * slide);
  return text;
}

void report(const Options& options, const krok::keys::Sidecar& sidecar, const Skeleton& skeleton,
            const GaitFacts& gait, bool found, ToolContext& context) {
  context.report.result = as_json(sidecar, skeleton);
  context.report.result["gait"] = as_json(gait);
  context.report.result["found"] = found;
  context.report.result["edited"] = sidecar.has_edits();
  if (context.output.empty() && options.plot.empty()) context.print(as_table(sidecar, skeleton));
  context.log(fmt::format("{}: {}, {}{}", name_of_input(options.input()),
                          counted(sidecar.keys.keytimes.size(), "keytime"),
                          counted(sidecar.keys.contacts.size(), "contact"), gait_text(gait)));
}

Status write_results(const Options& options, const Clip& clip, const RoleMap& roles,
                     std::optional<FoundContacts> found, const krok::keys::Sidecar& sidecar,
                     ToolContext& context) {
  OutputSet outputs(context);
  if (!context.output.empty()) {
    const std::string text = krok::keys::write_sidecar(sidecar, clip.skeleton);
    const Status status = outputs.add(context.output, text);
    if (!status) return status;
  }
  if (!options.plot.empty()) {
    if (!found) {
      auto contacts = find_contacts(clip, roles);
      if (!contacts) return std::move(contacts).error();
      found = std::move(*contacts);
    }
    const auto svg = feet_plot(name_of_input(options.input()), clip, *found, sidecar.keys);
    if (!svg) return svg.error();
    const Status status = outputs.add(
        options.plot, [&](OutputFile& file) { return chart::write(options.plot, *svg, file); });
    if (!status) return status;
  }
  return outputs.finish();
}

// Unless all of it is needed for more.
bool is_long_take(const Options& options, const InputFile& file, const ToolContext& context) {
  const std::string& path =
      context.output.empty() ? keys_sidecar_path(options.input()) : context.output;
  return file.bytes().size() >= kLongTake && options.find != Find::none && options.keys.empty() &&
         options.changes.empty() && options.plot.empty() &&
         (options.discard_edits || !stands(path));
}

Result<int> run_long(const Options& options, const InputFile& file, ToolContext& context) {
  const auto find_roles = io::open_role_map(options.map, context);
  if (!find_roles) return find_roles.error();
  std::optional<LongTake> found;
  const auto motion = io::stream_motion(file, context, [&](const FrameSource& frames) -> Status {
    const auto roles = (*find_roles)(frames.skeleton);
    if (!roles) return roles.error();
    auto take = find_in_long_take(frames, *roles, context.jobs, context.progress);
    if (!take) return std::move(take.error()).in_file(options.input());
    found = *std::move(take);
    return {};
  });
  if (!motion) return motion.error();
  context.diagnose(found->warnings);
  krok::keys::Sidecar sidecar;
  sidecar.keys = std::move(found->keys);
  sidecar.duration = motion->duration;
  if (Status status = krok::check(sidecar.keys, motion->skeleton, motion->duration); !status) {
    return status.error();
  }
  if (!context.output.empty()) {
    const std::string text = krok::keys::write_sidecar(sidecar, motion->skeleton);
    const Status status = write_output(context, context.output, text);
    if (!status) return status.error();
  }
  report(options, sidecar, motion->skeleton,
         {gait_metrics(sidecar.keys.keytimes), found->steps, found->slide_speed}, true, context);
  return options.find == Find::steps && sidecar.keys.keytimes.empty() ? kExitNo : kExitDone;
}

}  // namespace

Result<int> run(const Options& options, ToolContext& context) {
  if (!options.table.empty()) return write_gait_table(options, context);
  if (extension(context.output) == ".csv") {
    if (!options.changes.empty() || !options.plot.empty() || !options.keys.empty()) {
      return usage("a table of events is of keytimes as they are",
                   "change them with -o NAME.keys.json first");
    }
    return write_event_table(options, context);
  }
  if (options.inputs.size() > 1) {
    return usage(
        "several motions are given",
        "--table OUT.csv makes a table of their gait, -o OUT.csv of their events, --out-dir "
        "DIR a keytime file of each");
  }
  if (!options.changes.empty() && context.output.empty()) {
    return no_output(fmt::format(
        "use -o {} to write beside the motion",
        options.input() == "-" ? "NAME.keys.json" : keys_sidecar_path(options.input())));
  }
  const auto file = context.open_input(options.input());
  if (!file) return file.error();
  if (is_long_take(options, *file, context)) return run_long(options, *file, context);
  const auto clip = io::open_motion(*file, context);
  if (!clip) return clip.error();
  const auto find_roles = io::open_role_map(options.map, context);
  if (!find_roles) return find_roles.error();
  const auto roles = (*find_roles)(clip->skeleton);
  if (!roles) return roles.error();
  const auto before = read_before(options, *clip, context);
  if (!before) return before.error();
  const auto finding = is_to_find(options, *before);
  if (!finding) return finding.error();

  krok::keys::Sidecar sidecar = before->value_or(krok::keys::Sidecar{});
  std::optional<FoundContacts> contacts;
  // In place, feet on the ground move with it: steps are found in the motion as it travels.
  const auto moving = travelling_on_feet(*clip, *roles);
  if (*finding) {
    auto found = find(*clip, *roles, context);
    if (!found) return std::move(found).error().in_file(options.input());
    sidecar = with_edits(std::move(found->keys), sidecar);
    contacts = std::move(found->contacts);
  } else if (*before && (*before)->has_edits()) {
    context.log("the keys were edited by hand and are kept; --find steps detects the rest again");
  }
  sidecar.duration = clip->duration();
  const std::vector<Keytime> found_keys = sidecar.keys.keytimes;
  if (Status status = change(options.changes, *clip, sidecar); !status) return status.error();
  log_added(found_keys, sidecar.keys.keytimes, context);
  if (Status status = krok::check(sidecar.keys, clip->skeleton, clip->duration()); !status) {
    return status.error();
  }
  const Status status = write_results(options, moving ? *moving : *clip, *roles,
                                      std::move(contacts), sidecar, context);
  if (!status) return status.error();

  context.diagnose_in(options.input(), doubts_of_gait(*clip, *roles));
  report(options, sidecar, clip->skeleton, gait_facts(*clip, *roles, sidecar.keys.keytimes),
         *finding, context);
  return options.find == Find::steps && sidecar.keys.keytimes.empty() ? kExitNo : kExitDone;
}

}  // namespace krok::cli::keys
