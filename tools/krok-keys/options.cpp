#include "tools/krok-keys/options.h"

#include <fmt/format.h>

#include <memory>

#include "formats/io/formats.h"
#include "tools/cli/one_of.h"
#include "tools/cli/usage.h"
#include "tools/krok-keys/run.h"
#include "tools/shared/role_input.h"

namespace krok::cli::keys {

namespace {

// The text before and after the last `mark`.
struct Halves {
  std::string before, after;
  bool split = false;
};
Halves halves_at(const std::string& text, const std::string& mark) {
  const auto place = text.rfind(mark);
  if (place == std::string::npos) return {text, {}, false};
  return {text.substr(0, place), text.substr(place + mark.size()), true};
}

Result<ClipTime> time_of(const std::string& text, const std::string& option) {
  auto time = parse_clip_time(text);
  if (time) return time;
  Error error = std::move(time).error();
  error.message = fmt::format("{}: {}", option, error.message);
  return error;
}

Result<KeytimeChange> parse_keytime(const std::string& text, const std::string& mark,
                                    const std::string& option, bool needs_time) {
  const Halves halves = halves_at(text, mark);
  if (halves.before.empty() || (needs_time && !halves.split)) {
    return usage(fmt::format("{}: '{}' needs a name and a time", option, text),
                 fmt::format("for example {} left_strike{}1.25s", option, mark));
  }
  KeytimeChange change{halves.before, {}};
  if (!halves.split) return change;
  const auto time = time_of(halves.after, option);
  if (!time) return time.error();
  change.time = *time;
  return change;
}

Result<ContactChange> parse_contact(const std::string& text) {
  const Halves parts = halves_at(text, "=");
  const Halves times = halves_at(parts.after, "..");
  if (parts.before.empty() || !times.split) {
    return usage(fmt::format("--add-contact: '{}' needs a joint and a time range", text),
                 "for example --add-contact LeftFoot=1.2s..1.8s");
  }
  const auto from = time_of(times.before, "--add-contact");
  if (!from) return from.error();
  const auto to = time_of(times.after, "--add-contact");
  if (!to) return to.error();
  return ContactChange{parts.before, *from, *to};
}

}  // namespace

void declare(CommandOptions& command, Options& options) {
  command
      .add_option("input IN", options.input,
                  "Motion: a .anim file, or a capture, read with the defaults of krok-import")
      .required();
  add_map_option(command, options.map);
  command
      .add_option("--find WHAT", options.find,
                  "steps (detect contacts and keytimes, keep manual edits), none (use the existing "
                  "file), or auto: none if the file was edited by hand, otherwise steps")
      .transform(
          one_of<Find>({{"auto", Find::automatic}, {"steps", Find::steps}, {"none", Find::none}}))
      .default_str("auto");
  command.add_option(
      "--keys IN.json", options.keys,
      "Initial keytime file (default: the one given by -o, or else the one beside the motion)");
  command.add_flag("--discard-edits", options.discard_edits,
                   "Detect everything again and discard manual edits");
  command.add_option(
      "--plot OUT.svg", options.plot,
      "Plot (SVG) of heights and speeds of the feet over time, with contacts and keytimes");
  command.group("Manual edits");
  const auto list = [&](const char* name, std::vector<std::string>& values, const char* help) {
    command.add_option(name, values, help).delimiter(',').one_each_time();
  };
  list("--set NAME=TIME", options.set,
       "Move the keytime of that name within 0.15 s to this time, or add one; several separated by "
       "commas, or repeat the option. Times: 1.25s, 250ms, or 120f (frame)");
  command.add_flag("--new", options.new_names,
                   "Allow --set to add a keytime of a name that is neither a gait event nor in the "
                   "file, such as clap");
  list("--remove NAME[@TIME]", options.remove, "Remove a keytime, or all with that name");
  list("--add-contact JOINT=TIME..TIME", options.add_contact,
       "Add a contact of a joint, replacing those it overlaps; its position is that of the joint "
       "during that time");
  list("--remove-contact JOINT@TIME", options.remove_contact,
       "Remove a joint's contact at that time");
}

Result<Changes> changes_of(const Options& options) {
  Changes changes;
  changes.new_names = options.new_names;
  for (const std::string& text : options.set) {
    auto change = parse_keytime(text, "=", "--set", true);
    if (!change) return change.error();
    changes.set.push_back(std::move(*change));
  }
  for (const std::string& text : options.remove) {
    auto change = parse_keytime(text, "@", "--remove", false);
    if (!change) return change.error();
    changes.remove.push_back(std::move(*change));
  }
  for (const std::string& text : options.add_contact) {
    auto change = parse_contact(text);
    if (!change) return change.error();
    changes.add_contact.push_back(std::move(*change));
  }
  for (const std::string& text : options.remove_contact) {
    const auto change = parse_keytime(text, "@", "--remove-contact", true);
    if (!change) return change.error();
    changes.remove_contact.push_back({change->name, *change->time, *change->time});
  }
  return changes;
}

Status check(const Options& options) {
  const auto changes = changes_of(options);
  if (!changes) return changes.error();
  if (options.discard_edits && options.find == Find::none) {
    return usage("--discard-edits and --find none exclude each other", "choose one of them");
  }
  return {};
}

ToolSpec make_spec() {
  const auto options = std::make_shared<Options>();
  ToolSpec spec = spec_of("krok-keys", options, declare, check, run);
  spec.summary = "Detects foot contacts and gait keytimes; shows and saves them";
  spec.details = "They are written to an editable file beside the motion.";
  spec.inputs = "IN.anim|IN.bvh|IN.amc";
  spec.examples = {
      {"krok-keys walk.anim", "prints what is detected, or walk.keys.json if that was edited"},
      {"krok-keys walk.anim -o walk.keys.json --plot walk.svg",
       "writes the file beside the motion, and a plot of the feet for checking"},
      {"krok-keys walk.anim -o walk.keys.json --set left_strike=1.25s,right_off=1.31s",
       "moves two keytimes; they are kept when the file is rebuilt"},
      {"krok-keys motions --out-dir motions", "for all motions of a folder, beside them"}};
  spec.exit_no = "--find steps was given and no step was found";
  spec.needs_output = false;
  spec.batch = {io::motion_endings(), always(".keys.json")};
  return spec;
}

}  // namespace krok::cli::keys
