#include "tools/krok-keys/gait_table.h"

#include <fmt/format.h>

#include <array>
#include <optional>
#include <utility>

#include "contacts/slide_speed.h"
#include "core/numbers.h"
#include "core/text.h"
#include "formats/csv/field.h"
#include "formats/io/open_motion.h"
#include "formats/io/open_role_map.h"
#include "tools/cli/file_name.h"
#include "tools/cli/output_set.h"
#include "tools/shared/keys_choice.h"

namespace krok::cli::keys {

namespace {

constexpr const char* kHeader =
    "file,duration [s],cycles,steps,speed [m/s],cadence [1/min],stride_length [m],"
    "step_length_left [m],step_length_right [m],step_width [m],stance_left [%],stance_right [%],"
    "double_support [%],slide_speed [mm/s]\n";

// Empty for what no step shows.
std::string row_of(const std::string& name, double duration, const GaitFacts& facts) {
  const auto& [gait, steps, slide] = facts;
  const auto if_known = [](double value, double factor = 1) {
    return value > 0 ? std::optional(value * factor) : std::nullopt;
  };
  const bool walks = gait.stance[0] > 0 && gait.stance[1] > 0;
  std::string row = fmt::format("{},{},{},{}", csv::field(to_utf8(name)), readable(duration, 6),
                                gait.cycles, steps.steps);
  for (const std::optional<double>& value : std::array<std::optional<double>, 10>{
           steps.speed, if_known(gait.cadence), steps.stride_length, steps.step_length[0],
           steps.step_length[1], steps.step_width, if_known(gait.stance[0], 100),
           if_known(gait.stance[1], 100),
           walks ? std::optional(100 * gait.double_support) : std::nullopt, 1000 * slide}) {
    row += value ? "," + readable(*value, 4) : ",";
  }
  return row + "\n";
}

Result<std::string> row_of(const std::string& path, const io::FindRoles& find_roles,
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

}  // namespace

GaitFacts gait_facts(const Clip& clip, const RoleMap& roles, const std::vector<Keytime>& keytimes) {
  return {gait_metrics(keytimes), step_measures(clip, roles, keytimes), slide_speed(clip, roles)};
}

Result<int> write_gait_table(const Options& options, ToolContext& context) {
  const auto find_roles = io::open_role_map(options.map, context);
  if (!find_roles) return find_roles.error();
  std::string text = kHeader;
  std::size_t rows = 0;
  context.progress->begin("measuring gait", options.inputs.size());
  for (const std::string& path : options.inputs) {
    if (auto row = row_of(path, *find_roles, context)) {
      text += *row;
      ++rows;
    } else {
      Error error = row.error();
      if (error.where.file.empty()) error.where.file = path;
      context.diagnose(error);
    }
    context.progress->advance(1);
  }
  context.progress->end();
  if (rows == 0) return Error("keys-table", "none of the motions can be read");
  const Status status =
      write_output(context, options.table, [&](OutputFile& file) { return file.write(text); });
  if (!status) return status.error();
  context.report.result["rows"] = rows;
  context.log(fmt::format("{}: {} of {} motions", options.table, rows, options.inputs.size()));
  return rows == options.inputs.size() ? kExitDone : kExitPartly;
}

}  // namespace krok::cli::keys
