#include "tools/krok-fit/library_input.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>
#include <utility>

#include "contacts/contacts.h"
#include "contacts/gait_keytimes.h"
#include "core/numbers.h"
#include "motion/cut.h"
#include "parametric/thin_out.h"
#include "tools/common/glob.h"
#include "tools/common/keys_sidecar.h"
#include "tools/common/motion_input.h"
#include "tools/common/paths.h"
#include "tools/common/role_input.h"

namespace krok::fit_tool {

namespace {

using library::ExampleEntry;
using library::LibraryDescription;
using library::ParameterEntry;
using parametric::Library;

constexpr double kUsualSpacing = 0.15;
constexpr double kSmoothedSpacing = 0.01;
constexpr double kUsualTolerance = 0.1;  // of what a parameter's usually is: refining is cheap

// A motion of the list, with the entry that named it.
struct Motion {
  const ExampleEntry* entry = nullptr;
  std::string path;
  std::string name;  // for people
  Clip clip;
  bool has_keys = false;  // beside the motion, or named
  MotionKeys keys;
  std::optional<FoundContacts> found;
};

Error at_entry(Error error, const Location& place) {
  if (error.where.file.empty()) error.where = place;
  return error;
}

void thin_out(LibraryInput& input, double spacing) {
  std::vector<parametric::Example> chosen;
  for (const int i : parametric::thin_out(input.library, spacing)) {
    chosen.push_back(std::move(input.library.examples[static_cast<std::size_t>(i)]));
  }
  input.library.examples = std::move(chosen);
}

void count_mirrored(LibraryInput& input) {
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
                "leave the parameter out, or add examples in which it differs"),
          entry.place);
    }
    input.lower.push_back(entry.least.value_or(least));
    input.upper.push_back(entry.most.value_or(most));
  }
  return {};
}

// Where the keytimes of a step are in a walk.
std::string name_in_walk(const std::string& keytime, FootSide swing) {
  const bool stance = keytime.starts_with("stance_");
  const bool left = (swing == FootSide::left) != stance;
  return (left ? "left_" : "right_") + keytime.substr(keytime.find('_') + 1);
}

class Reader {
 public:
  Reader(std::string path, bool keep_going, ToolContext& context)
      : path_(std::move(path)), keep_going_(keep_going), context_(context) {}

  Result<LibraryInput> read() {
    Status done = read_description();
    if (done) done = read_motions();
    if (done) done = keep_one_skeleton();
    if (done) done = find_all_keys();
    if (done) done = make_library();
    if (done) done = choose();
    if (done) done = find_range(input_);
    if (!done) return done.error();
    return std::move(input_);
  }

 private:
  const LibraryDescription& description() const { return input_.description; }
  FootSide swing() const {
    return description().swing == library::Side::left ? FootSide::left : FootSide::right;
  }
  std::string place_of(const std::string& name) const {
    return below(std::filesystem::path(path_).parent_path().string(), name);
  }

  Status read_description() {
    const auto file = context_.open_input(path_);
    if (!file) return file.error();
    auto description = library::read(file->text(), path_);
    if (!description) return description.error();
    input_.description = *std::move(description);
    return {};
  }

  // A clip that does not fit ends the run, or is told and left out.
  Status refuse(const Motion& motion, Error error) {
    if (error.where.file.empty()) error.where.file = motion.path;
    if (!keep_going_) {
      error.hint += fmt::format("{}--keep-going leaves it out", error.hint.empty() ? "" : "; ");
      return error;
    }
    Diagnostic told = error;
    told.severity = Severity::warning;
    told.hint = "it is left out";
    context_.tell(std::move(told));
    input_.refused.push_back({motion.path, std::move(error)});
    return {};
  }

  Status read_motions() {
    for (const ExampleEntry& entry : description().examples) {
      std::vector<std::string> paths = {place_of(entry.clip)};
      if (entry.automatic && has_wildcards(entry.clip)) {
        auto found = find_files(paths.front());
        if (!found) return found.error();
        paths = *std::move(found);
        // The keytimes that stand beside motions are none.
        std::erase_if(paths, [](const std::string& path) { return path.ends_with(".json"); });
        if (paths.empty()) {
          return at_entry(Error("library-clip", fmt::format("no file fits '{}'", entry.clip),
                                "paths are relative to this file"),
                          entry.place);
        }
      }
      for (const std::string& path : paths) {
        Motion motion;
        motion.entry = &entry;
        motion.path = path;
        motion.name = entry.name.empty() ? base_name(path) : entry.name;
        if (Status read = read_clip(motion); !read) {
          if (Status gone_on = refuse(motion, read.error()); !gone_on) return gone_on;
          continue;
        }
        motions_.push_back(std::move(motion));
      }
    }
    if (!motions_.empty()) return {};
    return Error("library-examples", "no motion is left").in_file(path_);
  }

  Status read_clip(Motion& motion) {
    // A jump from a rest pose is in no step that is found.
    auto clip = read_motion(motion.path, context_,
                            motion.entry->automatic ? RestFrameTold::note : RestFrameTold::warning);
    if (!clip) return clip.error();
    if (clip->frame_count() < 2) {
      return Error("library-examples", fmt::format("{} has no motion in it", motion.name));
    }
    const ExampleEntry& entry = *motion.entry;
    auto sidecar = read_sidecar(motion, *clip);
    if (!sidecar) return sidecar.error();
    const int last_frame = clip->frame_count() - 1;
    const auto frame_of = [&](const std::optional<ClipTime>& time, int otherwise) {
      if (!time) return otherwise;
      return static_cast<int>(std::lround(
          std::min(time->seconds(clip->rate) * clip->rate, static_cast<double>(last_frame))));
    };
    const int first = frame_of(entry.from, 0), last = frame_of(entry.to, last_frame);
    if (first >= last) {
      return Error("library-examples",
                   fmt::format("the part from {} s to {} s holds no motion",
                               readable(first / clip->rate), readable(last / clip->rate)));
    }
    if (*sidecar) {
      motion.has_keys = true;
      motion.keys = part_of((*sidecar)->keys, first / clip->rate, last / clip->rate);
    }
    motion.clip = first == 0 && last == last_frame ? *std::move(clip) : cut(*clip, first, last);
    return {};
  }

  // The skeleton that is named, or the one that most motions have; what has another one is refused.
  Status keep_one_skeleton() {
    if (description().skeleton.empty()) {
      skeleton_ = most_common_skeleton();
    } else {
      auto named = read_motion(place_of(description().skeleton), context_);
      if (!named) return named.error();
      skeleton_ = std::move(named->skeleton);
    }
    std::vector<Motion> kept;
    for (Motion& motion : motions_) {
      Status same = parametric::same_skeleton(skeleton_, motion.clip.skeleton);
      if (same) {
        kept.push_back(std::move(motion));
        continue;
      }
      Error error = std::move(same).error();
      error.hint = "krok-retarget brings the motion on the library's skeleton";
      if (Status gone_on = refuse(motion, std::move(error)); !gone_on) return gone_on;
    }
    motions_ = std::move(kept);
    if (motions_.empty()) {
      return Error("library-examples", "no motion is of the library's skeleton").in_file(path_);
    }
    const auto find_roles =
        open_role_map(description().map.empty() ? "" : place_of(description().map), context_);
    if (!find_roles) return find_roles.error();
    auto roles = (*find_roles)(skeleton_);
    if (!roles) return roles.error();
    input_.roles = *std::move(roles);
    return {};
  }

  Skeleton most_common_skeleton() const {
    std::size_t best = 0;
    int most = 0;
    for (std::size_t i = 0; i < motions_.size(); ++i) {
      const auto alike = std::ranges::count_if(motions_, [&](const Motion& other) {
        return parametric::same_skeleton(motions_[i].clip.skeleton, other.clip.skeleton).ok();
      });
      if (alike <= most) continue;
      most = static_cast<int>(alike);
      best = i;
    }
    return motions_[best].clip.skeleton;
  }

  Status find_all_keys() {
    for (Motion& motion : motions_) {
      if (!motion.entry->keytimes.empty()) continue;
      if (Status found = find_keys_of(motion); !found) return found;
    }
    return {};
  }

  Status find_keys_of(Motion& motion) {
    if (motion.entry->automatic) {
      auto contacts = find_contacts(motion.clip, input_.roles);
      if (!contacts) return std::move(contacts).error().in_file(motion.path);
      motion.found = *std::move(contacts);
    }
    if (motion.has_keys) return {};
    if (!motion.found) {
      auto keys = krok::find_keys(motion.clip, input_.roles, context_);
      if (!keys) return std::move(keys).error().in_file(motion.path);
      motion.keys = *std::move(keys);
      return {};
    }
    Gait gait = find_gait(motion.clip, input_.roles, *motion.found);
    for (Diagnostic& warning : gait.warnings) {
      if (warning.where.file.empty()) warning.where.file = motion.path;
    }
    context_.tell(gait.warnings);
    motion.keys = {motion.found->contacts, std::move(gait.keytimes)};
    return {};
  }

  // Its times are those of the whole motion.
  Result<std::optional<keys::Sidecar>> read_sidecar(const Motion& motion, const Clip& whole) {
    if (!motion.entry->keytimes.empty()) return std::optional<keys::Sidecar>();
    if (motion.entry->keys.empty()) return read_keys_beside(motion.path, whole, context_);
    auto sidecar = read_keys_file(place_of(motion.entry->keys), whole, context_);
    if (!sidecar) return std::move(sidecar).error();
    return std::optional<keys::Sidecar>(*std::move(sidecar));
  }

  std::vector<std::string> measures() const {
    std::vector<std::string> names;
    for (const ParameterEntry& entry : description().parameters) names.push_back(entry.measures);
    return names;
  }

  // Steps found in walks first, then what is one example a clip.
  Status make_library() {
    Library& library = input_.library;
    const bool any_steps =
        std::ranges::any_of(motions_, [](const Motion& m) { return m.entry->automatic; });
    if (any_steps) {
      if (!description().keytimes.empty()) {
        return Error("library-keytimes", "steps that are found have keytimes of their own",
                     "leave \"keytimes\" out, or \"steps\": \"auto\"")
            .in_file(path_);
      }
      if (Status cut = cut_walks(); !cut) return cut;
    } else if (Status begun = begin_library(); !begun) {
      return begun;
    }
    if (Status named = take_parameters(); !named) return named;
    if (description().rate) library.rate = *description().rate;
    for (const Motion& motion : motions_) {
      if (motion.entry->automatic) continue;
      if (Status added = add_example(motion); !added) return added;
    }
    if (library.examples.empty()) {
      return Error("library-examples", "the library has no examples").in_file(path_);
    }
    return parametric::check(library);
  }

  Status cut_walks() {
    std::vector<parametric::Walk> walks;
    for (const Motion& motion : motions_) {
      if (!motion.entry->automatic) continue;
      walks.push_back(
          {motion.name, &motion.clip, &motion.keys, motion.found ? &*motion.found : nullptr});
    }
    parametric::CutOptions options;
    options.swing = swing();
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
    for (const Motion& motion : motions_) {
      clips.push_back({&motion.clip, motion.found ? &*motion.found : nullptr});
    }
    auto feet = parametric::find_foot_shapes(clips, input_.roles);
    if (!feet) return std::move(feet).error().in_file(path_);
    library.feet = *feet;
    return {};
  }

  // What is measured, errors by the place in the description.
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

  Status add_example(const Motion& motion) {
    auto times = keytimes_of(motion);
    if (!times) return times.error();
    auto example = parametric::make_example(input_.library, motion.name, motion.clip,
                                            *std::move(times), motion.keys.contacts);
    if (!example) return at_entry(std::move(example).error(), motion.entry->place);
    input_.library.examples.push_back(*std::move(example));
    return {};
  }

  // As given by hand, or those of the motion's keys: by the library's names, or by the names that a
  // step's have in a walk; each must be there once.
  Result<std::vector<double>> keytimes_of(const Motion& motion) const {
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
            Error("library-keytimes",
                  fmt::format("{} has {} at {} moments, expected one", motion.name, name,
                              found.size()),
                  "give \"keytimes\" here, cut the motion with \"from\" and \"to\", or set them "
                  "with krok-keys"),
            motion.entry->place);
      }
      times.push_back(found.front());
    }
    return times;
  }

  // Of steps that were found, those that are not too close to each other.
  Status choose() {
    Library& library = input_.library;
    input_.found = static_cast<int>(library.examples.size());
    const bool all_found =
        std::ranges::all_of(motions_, [](const Motion& m) { return m.entry->automatic; });
    if (all_found) {
      if (!description().spacing) input_.all_steps = library.examples;
      thin_out(input_, description().spacing.value_or(kUsualSpacing));
    }
    count_mirrored(input_);
    return {};
  }

  std::string path_;
  bool keep_going_;
  ToolContext& context_;
  LibraryInput input_;
  std::vector<Motion> motions_;
  Skeleton skeleton_;
};

}  // namespace

Result<LibraryInput> read_library(const std::string& path, bool keep_going, ToolContext& context) {
  return Reader(path, keep_going, context).read();
}

void take_all_steps(LibraryInput& input) {
  if (input.all_steps.empty()) return;
  input.library.examples = std::move(input.all_steps);
  input.all_steps.clear();
  thin_out(input, kSmoothedSpacing);
  count_mirrored(input);
  // Fewer steps had a range in each parameter already.
  (void)find_range(input).ok();
}

}  // namespace krok::fit_tool
