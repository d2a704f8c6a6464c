#include "tools/krok-lint/options.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <memory>

#include "core/text.h"
#include "formats/io/formats.h"
#include "formats/registry/registry.h"
#include "lint/rules.h"

namespace krok::cli::lint {

namespace {

// One rule's id.
ValueKind<std::string> rule() {
  std::vector<std::string> ids;
  for (const auto& facts : krok::lint::rules()) ids.emplace_back(facts.id);
  ValueKind<std::string> kind = words(ids);
  kind.name = "rule";
  kind.read = [known = kind.read](const std::string& text) -> Result<std::string> {
    auto read = known(text);
    if (!read && text.find('=') != std::string::npos) {
      Error error = std::move(read).error();
      error.hint =
          "limits are those of --profile IN.json (formats/lint/SPEC.md); --rules prints them";
      return error;
    }
    return read;
  };
  return kind;
}

void declare(CommandOptions& command, Options& o) {
  command.add_option("inputs IN", o.inputs,
                     "Motions: .anim files, or captures and characters as krok-import reads them; "
                     ".model and .character, whose mesh is judged; folders stand for all of them "
                     "but .character");
  command.add_flag("--rules", o.list_rules, "Print the rules with their limits, and end");
  command.add("--only RULE", o.only, rule(), "Use this rule alone; repeatable")
      .allow_extra_args(false);
  command.add("--ignore RULE", o.ignore, rule(), "Leave this rule out; repeatable")
      .allow_extra_args(false);
  command.add_option("--profile IN.json", o.profile,
                     "Rules and limits (formats/lint/SPEC.md), before --only and --ignore");
  command.add_option("--baseline IN.json", o.baseline,
                     "Known faults, of --save-baseline, do not count");
  add_map_option(command, o.map);
  command.group("What the motions are");
  add_ground_option(command, o.ground,
                    "Ground that the feet stand on, as for krok-walk: a mesh, a height field, or "
                    "stairs:rise=17cm,run=29cm, slope:12deg. Default: level, where they stand");
  command.add_flag("--treadmill", o.treadmill,
                   "The ground moves: foot-slide and drift do not apply");
  command.add_flag(
      "--loops", o.loops,
      "All motions repeat; otherwise those with loop in their name do, and short ones with cycle");
  command.add_flag("--self-intersection", o.self_intersection,
                   "Also use the rule self-intersection, which is slow");
  command.group("Output");
  command.add("--table OUT.csv", o.table, output({".csv"}), "A table with a row for each fault");
  command.add("--sarif OUT.sarif", o.sarif, output({".sarif", ".json"}),
              "SARIF 2.1.0, as GitHub and editors read it");
  command.add("--junit OUT.xml", o.junit, output({".xml"}), "JUnit XML, as CI servers read it");
  command.add("--html OUT.html", o.html, output({".html"}),
              "A page of all faults, with images of each file's worst moment");
  command.add("--save-pages OUT_DIR", o.save_pages, output({}),
              "With --html: pages that play the worst 100 files, to which its times lead");
  command.add("--fix OUT_DIR", o.fix, output({}),
              "Write mended motions (.anim) to this folder: without spikes, and with feet that "
              "stand where they stand, each only if fewer faults are left; says what was changed "
              "and what left out");
  command.add("--save-baseline OUT.json", o.save_baseline, output({".json"}),
              "The faults of now, for --baseline: then only new ones fail");
}

Status check_options(const Options& o) {
  if (o.inputs.empty() && !o.fix.empty()) {
    return usage(
        fmt::format("no input given; {} is the folder of --fix", shown(o.fix)),
        fmt::format("--fix OUT_DIR is for mended motions: krok-lint {} --fix mended", o.fix));
  }
  if (!o.save_pages.empty() && o.html.empty()) {
    return usage("--save-pages is for pages that --html leads to", "give --html faults.html, too");
  }
  if (o.list_rules && !o.inputs.empty()) {
    return usage("--rules prints the rules, and checks nothing",
                 "krok-lint IN... --only RULE checks for one; leave the inputs out for the list");
  }
  if (o.inputs.empty() && !o.list_rules) return usage("no input given", "see krok-lint --help");
  return {};
}

}  // namespace

ToolSpec make_spec() {
  const auto options = std::make_shared<Options>();
  ToolSpec spec = spec_of<Options>("krok-lint", options, declare, check_options, run);
  spec.summary = "Finds faults of motions (sliding feet, pops) and meshes (weights, bind pose)";
  spec.details =
      "One line for each fault, the worst file first. NAME.lint.json beside a motion says which of "
      "its faults are accepted, and why.";
  spec.inputs = "IN...";
  spec.examples = {
      {"krok-lint captures", "all motions of a folder"},
      {"krok-lint captures --table faults.csv --ignore ground", "also as a table, without a rule"},
      {"krok-lint stairs.bvh --ground stairs:rise=17cm,run=29cm", "a walk that is not on a level"},
      {"krok-lint --rules", "the rules and their limits"}};
  spec.exit_done = "no fault";
  spec.exit_no = "faults were found";
  spec.exit_partly = "some files could not be read";
  spec.folder_endings = io::motion_endings();
  std::ranges::copy(registry::endings_of(registry::Kind::model),
                    std::back_inserter(spec.folder_endings));
  spec.has_output = false;
  return spec;
}

}  // namespace krok::cli::lint
