#include "tools/krok-blend/options.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <memory>

#include "core/numbers.h"
#include "formats/csv/table.h"
#include "formats/io/formats.h"
#include "tools/shared/shared_options.h"

namespace krok::cli::blend {

namespace {

// Code: usage for an invalid weight.
Result<WeightedInput> parse_weighted_input(const std::string& word) {
  const std::size_t colon = word.rfind(':');
  const auto wrong = [&](const std::string& what) {
    return Error("usage", what,
                 "give each motion a weight: walk.anim:0.5 or "
                 "walk.anim:@weights.csv");
  };
  WeightedInput input;
  if (parse_finite(word)) return wrong(fmt::format("'{}' is a weight without a motion", word));
  if (colon == std::string::npos) {
    const std::size_t equals = word.rfind('=');
    if (equals != std::string::npos && parse_finite(word.substr(equals + 1))) {
      return wrong(fmt::format("'{}' has '=' before its weight, not ':'", word));
    }
    input.path = word;
    return input;
  }
  if (colon == 0) return wrong(fmt::format("'{}' names no motion", word));
  input.path = word.substr(0, colon);
  const std::string weight = word.substr(colon + 1);
  if (weight.size() > 1 && weight[0] == '@') {
    input.curve = weight.substr(1);
    return input;
  }
  input.weight = parse_finite(weight);
  if (!input.weight)
    return wrong(
        fmt::format("invalid weight '{}'{}", weight,
                    weight.ends_with('%') ? ", a share of 1 is written 0.3 for 30 %" : ""));
  return input;
}

void declare(CommandOptions& command, Options& options) {
  command
      .add("inputs IN:WEIGHT", options.inputs,
           ValueKind<WeightedInput>{"input", "IN:WEIGHT", parse_weighted_input, {}},
           "Motions on the same skeleton (.anim, or captures such as BVH), each with a "
           "weight: a number, or @FILE.csv with columns generic and weight")
      .required();
  command.group("Time");
  add_keys_option(command, options.keys);
  command.add(
      "--warp HOW", options.warp,
      choice<WarpChoice>(
          {{"pchip", WarpChoice::pchip}, {"linear", WarpChoice::linear}, {"dtw", WarpChoice::dtw}}),
      "Time warp: pchip (between keytimes, continuous speed), linear (between keytimes), or dtw "
      "(aligns similar poses, without keytimes)",
      "pchip");
  command.add("--rate", options.rate, rate(), "Frames per second (default: the first motion's)");
  command.group("Space");
  command.add(
      "--match-root HOW", options.align,
      choice<AlignChoice>({{"auto", AlignChoice::automatic},
                           {"root", AlignChoice::root},
                           {"stance", AlignChoice::stance},
                           {"none", AlignChoice::none}}),
      "Root motion: root (blended relative to the heading, so that turns blend), stance (the same, "
      "and planted feet are locked), auto (stance if all motions have contacts, otherwise root), "
      "none (root transforms are blended in world space)",
      "auto");
  add_plant_flag(command, options.plant);
  command.add_flag("--modifier", options.modifier,
                   "Allow weights that do not sum to 1, for additive motions");
  add_map_option(command, options.map);
  command.group("Output");
  command.add("--save-warp OUT.csv", options.save_warp, output({".csv"}),
              "Write the time warp: the source time in each motion for every frame");
  add_orientation_option(command, options.orientation);
}

}  // namespace

ToolSpec make_spec() {
  const auto options = std::make_shared<Options>();
  ToolSpec spec = spec_of<Options>("krok-blend", options, declare, nullptr, run);
  spec.summary = "Blends motions: a weighted sum, time-aligned by keytimes";
  spec.inputs = "IN.anim:WEIGHT...";
  spec.writes = registry::Kind::anim;
  spec.folder_endings = io::motion_endings();
  spec.examples = {
      {"krok-blend slow.anim:0.3 fast.anim:0.7 -o brisk.anim", "a blend of two walks"},
      {"krok-blend walks -o mean.anim", "the mean of all motions of a folder"},
      {"krok-blend walk.anim:@out.csv run.anim:@in.csv -o start.anim --save-warp warp.csv",
       "a transition from walk to run, with weight curves over generic time (columns generic, "
       "weight)"},
      {"krok-blend a.anim:0.5 b.anim:0.5 -o c.anim --warp dtw",
       "motions without keytimes, aligned by the similarity of their poses"}};
  return spec;
}

Result<krok::blend::WeightCurve> read_weight_curve(const std::string& path, ToolContext& context) {
  const auto file = context.open_input(path);
  if (!file) return file.error();
  const auto table = csv::Table::read(file->text(), path);
  if (!table) return table.error();
  std::array<std::size_t, 2> columns{};
  for (std::size_t i = 0; i < columns.size(); ++i) {
    auto column = table->find(i == 0 ? "generic" : "weight");
    if (!column) {
      return std::move(column).error().in_file(path);
    }
    columns[i] = *column;
  }
  auto numbers = table->numbers(columns);
  if (!numbers) return numbers.error();
  krok::blend::WeightCurve curve{std::move((*numbers)[0]), std::move((*numbers)[1])};
  for (std::size_t row = 0; row < curve.generic.size(); ++row) {
    const bool sound = std::isfinite(curve.generic[row]) && std::isfinite(curve.weights[row]) &&
                       (row == 0 || curve.generic[row] > curve.generic[row - 1]);
    if (sound) continue;
    return Error("weight-curve",
                 fmt::format(
                     "row {} of the table is not after the previous one, or has a missing value",
                     row + 1),
                 "generic time must rise, and each row needs a weight")
        .in_file(path);
  }
  return curve;
}

}  // namespace krok::cli::blend
