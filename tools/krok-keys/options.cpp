#include "tools/krok-keys/options.h"

#include <fmt/format.h>

#include <memory>

#include "core/text.h"
#include "formats/chart/chart_writer.h"
#include "formats/io/formats.h"
#include "tools/shared/shared_options.h"

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

// NAME and TIME with `mark` between; `example` has both.
ValueKind<KeytimeChange> keytime(const std::string& mark, bool needs_time,
                                 const std::string& example) {
  const auto read = [=](const std::string& text) -> Result<KeytimeChange> {
    const Halves halves = halves_at(text, mark);
    if (halves.before.empty() || (needs_time && !halves.split)) {
      return usage(fmt::format("'{}' needs a name and a time", shown(text)),
                   "for example " + example);
    }
    if (!halves.split) return KeytimeChange{halves.before, {}};
    const auto time = clip_time({}).read(halves.after);
    if (!time) return time.error();
    return KeytimeChange{halves.before, *time};
  };
  return {"keytime", "NAME" + mark + "TIME", read, {}};
}

Result<ContactChange> parse_contact(const std::string& text) {
  const Halves parts = halves_at(text, "=");
  const Halves times = halves_at(parts.after, "..");
  if (parts.before.empty() || !times.split) {
    return usage(fmt::format("'{}' needs a joint and a time range", shown(text)),
                 "for example --add-contact LeftFoot=1.2s..1.8s");
  }
  const auto from = clip_time({}).read(times.before), to = clip_time({}).read(times.after);
  if (!from || !to) return (from ? to : from).error();
  return ContactChange{parts.before, *from, *to};
}

void declare(CommandOptions& command, Options& o) {
  command
      .add_option("inputs IN", o.inputs,
                  "Motion: a .anim file, or a capture, read with the defaults of krok-import; for "
                  "--table several, or folders")
      .required();
  add_map_option(command, o.map);
  command.add(
      "--find WHAT", o.find,
      choice<Find>({{"auto", Find::automatic}, {"steps", Find::steps}, {"none", Find::none}}),
      "steps (detect contacts and keytimes, keep manual edits), none (use the existing file), or "
      "auto: none if the file was edited by hand, otherwise steps",
      "auto");
  command.add(
      "--contacts", o.keys, contacts_file("IN.json"),
      "Initial keytime file (default: the one given by -o, or else the one beside the motion)");
  command
      .add_flag("--discard-edits", o.discard_edits,
                "Detect everything again and discard manual edits")
      .not_with("--find none");
  command.add("--plot OUT.svg", o.plot, output(chart::endings()),
              "Plot (SVG, PDF, PNG) of heights and speeds of the feet over time, with contacts and "
              "keytimes");
  command
      .add(
          "--table OUT.csv", o.table, output({".csv"}),
          "A table of gait with a row for each motion: speed, cadence, lengths and width of steps, "
          "stance, foot skate")
      .not_with({"--output", "--plot", "--contacts", "--find none"});
  command.group("Manual edits");
  command
      .add("--keytime", o.changes.set, keytime("=", true, "--keytime left_strike=1.25s"),
           "Move the keytime of that name within 0.15 s to this time, or add one; several "
           "separated by commas, or repeat the option. Times: 1.25s, 250ms, or 120f (frame)")
      .delimiter(',');
  command.add_flag(
      "--new", o.changes.new_names,
      "Allow --keytime to add a keytime of a name that is neither a gait event nor in the "
      "file, such as clap");
  command
      .add("--remove NAME[@TIME]", o.changes.remove,
           keytime("@", false, "--remove left_strike@1.25s"),
           "Remove a keytime, or all with that name")
      .delimiter(',');
  command
      .add("--add-contact", o.changes.add_contact,
           ValueKind<ContactChange>{"contact", "JOINT=TIME..TIME", parse_contact, {}},
           "Add a contact of a joint, replacing those it overlaps; its position is that of the "
           "joint during that time")
      .delimiter(',');
  command
      .add("--remove-contact JOINT@TIME", o.changes.remove_contact,
           keytime("@", true, "--remove-contact LeftFoot@1.25s"),
           "Remove a joint's contact at that time")
      .delimiter(',');
}

}  // namespace

ToolSpec make_spec() {
  const auto options = std::make_shared<Options>();
  ToolSpec spec = spec_of<Options>("krok-keys", options, declare, nullptr, run);
  spec.keeps_going = true;
  spec.summary = "Detects foot contacts and gait keytimes; shows and saves them";
  spec.details =
      "They are written to an editable file beside the motion, or with -o OUT.csv as a table.";
  spec.inputs = "IN.anim|IN.bvh|IN.amc...";
  spec.examples = {
      {"krok-keys walk.anim", "prints what is detected, or walk.keys.json if that was edited"},
      {"krok-keys walk.anim -o walk.keys.json --plot walk.svg",
       "writes the file beside the motion, and a plot of the feet for checking"},
      {"krok-keys walk.anim -o walk.keys.json --keytime left_strike=1.25s,right_off=1.31s",
       "moves two keytimes; they are kept when the file is rebuilt"},
      {"krok-keys motions --out-dir motions", "for all motions of a folder, beside them"},
      {"krok-keys motions --table gait.csv", "a table of the gait of all motions of a folder"},
      {"krok-keys motions -o events.csv", "the strikes and toe-offs of all motions of a folder"}};
  spec.exit_no = "--find steps was given and no step was found";
  spec.folder_endings = io::motion_endings();
  spec.needs_output = false;
  spec.output_endings = {".json", ".csv"};
  spec.each_animation = [options](const std::string& output) {
    return !options->table.empty() || extension(output) == ".csv";
  };
  spec.batch = {io::motion_endings(), always(".keys.json")};
  return spec;
}

}  // namespace krok::cli::keys
