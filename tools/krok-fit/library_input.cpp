#include "tools/krok-fit/library_input.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <utility>

#include "formats/io/formats.h"
#include "math/transform.h"
#include "parametric/thin_out.h"
#include "rbf/weight_function.h"
#include "tools/cli/usage.h"

namespace krok::cli::fit {

namespace {

using library::LibraryDescription;
using library::ParameterEntry;
using parametric::Library;

constexpr double kUsualTolerance = 0.1;  // relative to the usual tolerance: refining is cheap

void keep_examples(LibraryInput& input, const std::vector<int>& kept) {
  std::vector<parametric::Example> chosen;
  for (const int i : kept) {
    chosen.push_back(std::move(input.library.examples[static_cast<std::size_t>(i)]));
  }
  input.library.examples = std::move(chosen);
  input.mirrored = static_cast<int>(
      std::ranges::count_if(input.library.examples, &parametric::Example::mirrored));
}

Status find_range(LibraryInput& input) {
  const Library& library = input.library;
  input.lower.clear();
  input.upper.clear();
  for (std::size_t d = 0; d < library.parameters.size(); ++d) {
    const ParameterEntry& entry = input.description.parameters[d];
    double least = INFINITY, most = -INFINITY;
    for (const parametric::Example& example : library.examples) {
      least = std::min(least, example.parameters[d]);
      most = std::max(most, example.parameters[d]);
    }
    if (!(most > least)) {
      return at_entry(
          Error("library-examples", fmt::format("'{}' is the same in all examples", entry.name),
                "leave out the parameter, or add examples that vary it"),
          entry.place);
    }
    input.lower.push_back(entry.least.value_or(least));
    input.upper.push_back(entry.most.value_or(most));
  }
  return {};
}

// The name of a step's keytime in a walk.
std::string name_in_walk(const std::string& keytime, FootSide swing) {
  const bool stance = keytime.starts_with("stance_");
  const bool left = (swing == FootSide::left) != stance;
  return (left ? "left_" : "right_") + keytime.substr(keytime.find('_') + 1);
}

parametric::StepGait gait_of(library::StepKind kind) {
  using enum parametric::StepGait;
  constexpr std::array kGaits = {walk,     run,  start,        stop, stand,
                                 backward, side, side_closing, turn, turn_closing};  // [StepKind]
  return kGaits[static_cast<std::size_t>(kind)];
}

class Reader {
 public:
  Reader(const std::vector<std::string>& inputs, bool keep_going, ToolContext& context)
      : inputs_(inputs), keep_going_(keep_going), context_(context) {}

  Result<LibraryInput> read() {
    Status status = find_description();
    if (status) status = read_motions();
    if (status) status = make_library();
    // Motions with no step of a walk, or few, may be runs.
    const bool rather_runs = status ? mostly_runs() : status.error().code == "parametric-none";
    if (path_.empty() && rather_runs) {
      input_.description.kind = library::StepKind::runs;
      if (make_library()) {
        status = {};
      } else if (status) {
        input_.description.kind = library::StepKind::walks;
        status = make_library();
      }
    }
    if (status && path_.empty()) status = leave_out_what_hardly_varies();
    if (status) status = choose();
    if (status) status = find_range(input_);
    if (!status) return status.error();
    return std::move(input_);
  }

 private:
  const LibraryDescription& description() const { return input_.description; }
  FootSide swing() const {
    return description().swing == library::Side::left ? FootSide::left : FootSide::right;
  }

  // Whether more steps were left out as those of runs than were taken.
  bool mostly_runs() const {
    const auto runs = std::ranges::count_if(input_.dropped, [](const auto& step) {
      return step.reason.starts_with(parametric::kOfARun);
    });
    return runs > static_cast<std::ptrdiff_t>(input_.library.examples.size());
  }

  Status find_description() {
    if (inputs_.size() > 1) return describe_motions();
    const auto file = context_.open_input(inputs_.front());
    if (!file) return file.error();
    if (io::is_motion(*file)) return describe_motions();
    path_ = inputs_.front();
    return read_description(*file);
  }

  // What one would write of walks of which nothing else is known.
  Status describe_motions() {
    LibraryDescription& made = input_.description;
    made.mirror = true;
    for (const auto& [name, measures] :
         {std::pair("length", "step.length"), std::pair("turn", "step.path_turn")}) {
      ParameterEntry& parameter = made.parameters.emplace_back();
      parameter.name = name;
      parameter.measures = measures;
    }
    for (const std::string& path : inputs_) {
      if (path.ends_with(".json")) {
        return usage("a library description is the only input",
                     "it names its motions: \"examples\": [{\"clip\": \"takes/*.bvh\"}]");
      }
      library::ExampleEntry& example = made.examples.emplace_back();
      example.clip = path;
      example.automatic = true;
    }
    return {};
  }

  Status read_description(const InputFile& file) {
    const char* const hint =
        "give motions, or a description (.json) of them, see formats/library/SPEC.md: "
        "{\"schema\": \"krok.library/1\", \"steps\": \"auto\", \"parameters\": [...], "
        "\"examples\": [{\"clip\": \"takes/*.bvh\"}]}";
    if (const auto kind = registry::kind_of_content(file.bytes());
        kind != registry::Kind::unknown && !file.text().starts_with('{')) {
      return Error("fit-description",
                   fmt::format("is {}, not a library description",
                               registry::describe_content(file.bytes())),
                   kind == registry::Kind::steps
                       ? "to go on with it: krok-fit EXAMPLES --resume IN.steps --refine N"
                       : hint)
          .in_file(path_);
    }
    auto description = library::read(file.text(), path_);
    if (!description) return description.error();
    input_.description = *std::move(description);
    return {};
  }

  Status read_motions() {
    auto read = read_example_motions(description(), path_, keep_going_, context_);
    if (!read) return std::move(read).error();
    motions_ = std::move(read->motions);
    skeleton_ = std::move(read->skeleton);
    input_.roles = std::move(read->roles);
    input_.refused = std::move(read->refused);
    return {};
  }

  // Of walks that all go straight on, the turn says nothing.
  Status leave_out_what_hardly_varies() {
    constexpr double kMinTurn = 1 * kRadiansPerDegree, kMinLength = 0.01;  // metres
    std::vector<ParameterEntry>& entries = input_.description.parameters;
    std::vector<ParameterEntry> kept;
    for (std::size_t d = 0; d < entries.size(); ++d) {
      const auto value = [d](const parametric::Example& e) { return e.parameters[d]; };
      const auto [least, most] = std::ranges::minmax(input_.library.examples, {}, value);
      const bool turn = entries[d].name == "turn";
      if (value(most) - value(least) > (turn ? kMinTurn : kMinLength)) {
        kept.push_back(entries[d]);
      }
    }
    if (kept.size() == entries.size()) return {};
    if (kept.empty()) {
      return Error("library-examples", "all steps have the same length and turn",
                   "add motions that vary them, or describe other parameters "
                   "(formats/library/SPEC.md)");
    }
    entries = std::move(kept);
    return make_library();
  }

  std::vector<std::string> measures() const {
    std::vector<std::string> names;
    for (const ParameterEntry& entry : description().parameters) names.push_back(entry.measures);
    return names;
  }

  // Detected steps come first, then clips with one example each.
  Status make_library() {
    Library& library = input_.library;
    const bool any_steps =
        std::ranges::any_of(motions_, [](const ExampleMotion& m) { return m.entry->automatic; });
    if (any_steps) {
      if (!description().keytimes.empty()) {
        return Error("library-keytimes", "detected steps have fixed keytimes",
                     "leave out \"keytimes\" or \"steps\": \"auto\"")
            .in_file(path_);
      }
      if (Status status = cut_walks(); !status) return status;
    } else if (Status status = begin_library(); !status) {
      return status;
    }
    if (Status status = take_parameters(); !status) return status;
    if (description().rate) library.rate = *description().rate;
    for (const ExampleMotion& motion : motions_) {
      if (motion.entry->automatic) continue;
      if (Status status = add_example(motion); !status) return status;
    }
    if (library.examples.empty()) {
      return Error("library-examples", "the library has no examples").in_file(path_);
    }
    library.ground = parametric::ground_of(library);
    return parametric::check(library);
  }

  Status cut_walks() {
    std::vector<parametric::Walk> walks;
    for (const ExampleMotion& motion : motions_) {
      if (!motion.entry->automatic) continue;
      walks.push_back({motion.name, &motion.clip, &motion.keys,
                       motion.found ? &*motion.found : nullptr, motion.entry->style});
    }
    parametric::CutOptions options;
    options.swing = swing();
    options.gait = gait_of(description().kind);
    options.mirror = description().mirror;
    if (description().outlier_deviations) options.outlier = *description().outlier_deviations;
    auto cut = parametric::cut_steps(walks, input_.roles, measures(), options);
    if (!cut) return std::move(cut).error().in_file(path_);
    input_.library = std::move(cut->library);
    input_.dropped = std::move(cut->dropped);
    return {};
  }

  Status begin_library() {
    Library& library = input_.library;
    library.skeleton = skeleton_;
    library.swing = swing();
    library.rate = motions_.front().clip.rate;
    library.keytimes = description().keytimes;
    if (library.keytimes.empty()) {
      library.keytimes = {"stance_strike", "swing_off", "swing_strike"};
    }
    std::vector<parametric::ClipContacts> clips;
    for (const ExampleMotion& motion : motions_) {
      clips.push_back({&motion.clip, motion.found ? &*motion.found : nullptr});
    }
    auto feet = parametric::find_foot_shapes(clips, input_.roles);
    if (!feet) return std::move(feet).error().in_file(path_);
    library.feet = *feet;
    library.given_roles = parametric::given_roles(input_.roles);
    return {};
  }

  // Parses the measured parameters; errors have their location in the description.
  Status take_parameters() {
    Library& library = input_.library;
    library.parameters.clear();
    for (const ParameterEntry& entry : description().parameters) {
      auto parameter =
          parametric::parse_parameter(entry.measures, library.skeleton, library.keytimes);
      if (!parameter) return at_entry(std::move(parameter).error(), entry.place);
      parameter->tolerance = entry.tolerance.value_or(kUsualTolerance * parameter->tolerance);
      library.parameters.push_back(*parameter);
    }
    return {};
  }

  Status add_example(const ExampleMotion& motion) {
    auto times = keytimes_of(motion);
    if (!times) return times.error();
    auto example = parametric::make_example(input_.library, motion.name, motion.clip,
                                            *std::move(times), motion.keys.contacts);
    if (!example) return at_entry(std::move(example).error(), motion.entry->place);
    example->style = motion.entry->style;
    input_.library.examples.push_back(*std::move(example));
    return {};
  }

  // Keytimes from the description or the motion's keys, by their names in the library or in a walk.
  // Each must occur exactly once.
  Result<std::vector<double>> keytimes_of(const ExampleMotion& motion) const {
    std::vector<double> times;
    for (const std::string& name : input_.library.keytimes) {
      const std::string in_walk =
          name.find('_') == std::string::npos ? name : name_in_walk(name, swing());
      std::vector<double> found;
      for (const library::KeytimeEntry& given : motion.entry->keytimes) {
        if (given.name == name) found.push_back(given.time.seconds(motion.clip.rate));
      }
      for (const Keytime& key : motion.keys.keytimes) {
        if (key.name == name || key.name == in_walk) found.push_back(key.time);
      }
      if (found.size() != 1) {
        return at_entry(
            Error(
                "library-keytimes",
                fmt::format("{} has {} at {} times, expected one", motion.name, name, found.size()),
                "give \"keytimes\" here, cut the motion with \"from\" and \"to\", or set them "
                "with krok-keys; \"steps\": \"auto\" cuts a walk into its steps"),
            motion.entry->place);
      }
      times.push_back(found.front());
    }
    return times;
  }

  // Thins out detected steps, and other examples if the description says so.
  Status choose() {
    Library& library = input_.library;
    input_.found = static_cast<int>(library.examples.size());
    const bool all_found =
        std::ranges::all_of(motions_, [](const ExampleMotion& m) { return m.entry->automatic; });
    if (all_found) {
      input_.exact_spacing = description().spacing.value_or(kUsualSpacing);
    } else {
      input_.exact_spacing = description().spacing.value_or(0);
    }
    if (all_found) {
      if (Status status = name_styles(input_, context_); !status) return status;
    }
    if (!description().spacing) input_.all_examples = library.examples;
    keep_examples(input_, parametric::thin_out(library, input_.exact_spacing, rbf::kMaxExamples));
    return {};
  }

  const std::vector<std::string>& inputs_;
  std::string path_;  // of the description; empty: none
  bool keep_going_;
  ToolContext& context_;
  LibraryInput input_;
  std::vector<ExampleMotion> motions_;
  Skeleton skeleton_;
};

}  // namespace

Result<LibraryInput> read_library(const std::vector<std::string>& inputs, bool keep_going,
                                  ToolContext& context) {
  return Reader(inputs, keep_going, context).read();
}

void take_examples(LibraryInput& input, double spacing) {
  if (input.all_examples.empty()) return;
  input.library.examples = input.all_examples;
  keep_examples(input, parametric::thin_out(input.library, spacing, rbf::kMaxExamples));
  // Cannot fail: thinning keeps the extremes of each parameter nearly as they are.
  (void)find_range(input).ok();
}

void take_smoothed_examples(LibraryInput& input) {
  if (input.all_examples.empty()) return;
  input.library.examples = input.all_examples;
  keep_examples(input, parametric::thin_out_smoothed(input.library));
  (void)find_range(input).ok();
}

}  // namespace krok::cli::fit
