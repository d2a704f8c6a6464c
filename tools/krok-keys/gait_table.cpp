#include "tools/krok-keys/gait_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "contacts/loop_steps.h"
#include "contacts/slide_speed.h"
#include "core/numbers.h"
#include "core/text.h"
#include "formats/csv/field.h"
#include "formats/io/open_motion.h"
#include "tools/cli/file_name.h"
#include "tools/cli/output_set.h"
#include "tools/shared/keys_sidecar.h"

namespace krok::cli::keys {

namespace {

constexpr const char* kHeader =
    "file,duration [s],cycles,steps,speed [m/s],cadence [1/min],stride_length [m],"
    "step_length_left [m],step_length_right [m],step_width [m],stance_left [%],stance_right [%],"
    "double_support [%],slide_speed [mm/s],gait\n";

// Empty for what no step shows.
std::string row_of(const std::string& name, double duration, const GaitFacts& facts) {
  const auto& [gait, steps, slide] = facts;
  const auto if_known = [](double value, double factor = 1) {
    return value > 0 ? std::optional(value * factor) : std::nullopt;
  };
  const bool steps_known = gait.stance[0] > 0 && gait.stance[1] > 0;
  std::string row = fmt::format("{},{},{},{}", csv::field(to_utf8(name)), readable(duration, 6),
                                gait.cycles, steps.steps);
  for (const std::optional<double>& value : std::array<std::optional<double>, 10>{
           steps.speed, if_known(gait.cadence), steps.stride_length, steps.step_length[0],
           steps.step_length[1], steps.step_width, if_known(gait.stance[0], 100),
           if_known(gait.stance[1], 100),
           steps_known ? std::optional(100 * gait.double_support) : std::nullopt,
           facts.is_run() ? std::nullopt : std::optional(1000 * slide)}) {
    row += value ? "," + readable(*value, 4) : ",";
  }
  return fmt::format("{},{}\n", row, steps_known ? facts.name() : "");
}

using Rows = Result<std::string>(const std::string& path, const io::FindRoles& find_roles,
                                 ToolContext& context);

Result<std::string> gait_row(const std::string& path, const io::FindRoles& find_roles,
                             ToolContext& context) {
  const auto clip = io::open_motion(path, context);
  if (!clip) return clip.error();
  const auto roles = find_roles(clip->skeleton);
  if (!roles) return roles.error();
  const auto keys =
      choose_keys(KeysChoice::automatic, path, name_of_input(path), *clip, find_roles, context);
  if (!keys) return keys.error();
  const MotionKeys none;
  const MotionKeys& found = *keys ? **keys : none;
  return row_of(path, clip->duration(), gait_facts(*clip, *roles, found.keytimes));
}

Result<std::string> event_rows(const std::string& path, const io::FindRoles& find_roles,
                               ToolContext& context) {
  const auto clip = io::open_motion(path, context);
  if (!clip) return clip.error();
  const auto keys =
      choose_keys(KeysChoice::automatic, path, name_of_input(path), *clip, find_roles, context);
  if (!keys) return keys.error();
  std::string rows;
  if (!*keys) return rows;
  for (const Keytime& key : (*keys)->keytimes) {
    rows += fmt::format("{},{},{:.6f},{}\n", csv::field(to_utf8(path)), csv::field(key.name),
                        key.time, std::lround(key.time * clip->rate));
  }
  return rows;
}

// Motions that cannot be read are reported and left out.
Result<int> write_rows(const Options& options, const char* header, Rows* rows_of, const char* task,
                       const char* contents, const char* more, const std::string& output,
                       ToolContext& context) {
  const auto find_roles = io::open_role_map(options.map, context);
  if (!find_roles) return find_roles.error();
  std::string text = header;
  std::size_t motions = 0;
  context.progress->begin(task, options.inputs.size());
  for (const std::string& path : options.inputs) {
    const auto rows = [&] {
      const HiddenProgress hidden(context);
      return rows_of(path, *find_roles, context);
    }();
    if (rows) {
      text += *rows;
      ++motions;
    } else {
      Error error = rows.error();
      if (error.where.file.empty()) error.where.file = path;
      context.diagnose(error);
    }
    context.progress->advance(1);
  }
  context.progress->end();
  if (motions == 0) return Error("keys-table", "none of the motions can be read");
  const Status status = write_output(context, output, text);
  if (!status) return status.error();
  context.report.result["rows"] = std::ranges::count(text, '\n') - 1;
  context.log(fmt::format("{}: {} of {} of {}{}", output, contents, motions,
                          counted(std::ssize(options.inputs), "motion"), more));
  return motions == options.inputs.size() ? kExitDone : kExitPartly;
}

}  // namespace

GaitFacts gait_facts(const Clip& clip, const RoleMap& roles, const std::vector<Keytime>& keytimes) {
  const auto moving = travelling_on_feet(clip, roles);
  const double slide = slide_speed(moving ? *moving : clip, roles);
  const auto rounds = rounds_of(clip, roles);
  if (!rounds) {
    return {gait_metrics(keytimes), step_measures(moving ? *moving : clip, roles, keytimes), slide};
  }
  // Of a loop the steps of its circle, each counted once.
  const std::vector<Keytime> all = in_rounds(keytimes, *rounds);
  GaitFacts facts{gait_metrics(all), step_measures(rounds->clip, roles, all), slide};
  const auto strikes = std::ranges::count_if(all, [&](const Keytime& key) {
    return key.name.ends_with("_strike") && key.time * rounds->clip.rate < rounds->period;
  });
  facts.gait.cycles = std::min(facts.gait.cycles, static_cast<int>(strikes));
  facts.steps.steps = std::min(facts.steps.steps, static_cast<int>(strikes));
  return facts;
}

Result<int> write_gait_table(const Options& options, ToolContext& context) {
  return write_rows(options, kHeader, gait_row, "measuring gait", "gait", "", options.table,
                    context);
}

Result<int> write_event_table(const Options& options, ToolContext& context) {
  return write_rows(options, "file,event,time [s],frame\n", event_rows, "finding steps",
                    "strikes and toe-offs", "; --table OUT.csv has speed, cadence and steps",
                    context.output, context);
}

}  // namespace krok::cli::keys
