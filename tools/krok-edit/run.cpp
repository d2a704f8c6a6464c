#include "tools/krok-edit/options.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <span>
#include <string_view>

#include "core/numbers.h"
#include "core/parallel.h"
#include "formats/anim/anim.h"
#include "formats/io/open_character.h"
#include "formats/io/open_motion.h"
#include "formats/sequences/sequences.h"
#include "motion/hips_root.h"
#include "scene/frame_source.h"
#include "tools/cli/output_set.h"
#include "tools/cli/paths.h"
#include "tools/cli/usage.h"
#include "tools/krok-edit/steps.h"
#include "tools/shared/keys_sidecar.h"
#include "tools/shared/planting.h"

namespace krok::cli::edit {

std::string in_degrees(double radians) {
  const double degrees = radians / kRadiansPerDegree;
  return std::abs(degrees) < 1e-4 ? "0 deg" : readable(degrees, 3) + " deg";
}

namespace {

constexpr std::string_view kSequencePlace = "{sequence}";

Json summary_of(const FrameSource& motion) {
  Json json;
  json["joints"] = motion.joint_count();
  json["frames"] = motion.frame_count;
  json["rate"] = motion.rate;
  json["duration"] = motion.duration();
  return json;
}

std::string summary_text(const FrameSource& motion) {
  return fmt::format("{} at {} fps ({} s)", counted(motion.frame_count, "frame"),
                     readable(motion.rate), readable(motion.duration(), 4));
}

// Keeps the provenance of earlier steps, newest last.
Provenance extended(const Provenance& before, Provenance now,
                    const std::vector<std::string>& done) {
  std::vector<Provenance::Source> sources = before.sources;
  sources.insert(sources.end(), now.sources.begin(), now.sources.end());
  now.sources = std::move(sources);
  std::vector<std::string> conversions = before.conversions;
  if (!before.tool.empty()) {
    std::string made = fmt::format("made by {} {}", before.tool, before.version);
    for (const auto& [name, value] : before.options) {
      made += value == "true" ? fmt::format(" --{}", name) : fmt::format(" --{} {}", name, value);
    }
    conversions.push_back(std::move(made));
  }
  conversions.insert(conversions.end(), done.begin(), done.end());
  now.conversions = std::move(conversions);
  std::vector<std::string> warnings = before.warnings;
  warnings.insert(warnings.end(), now.warnings.begin(), now.warnings.end());
  now.warnings = std::move(warnings);
  now.removed_root_motion = before.removed_root_motion;
  return now;
}

Result<sequences::SequenceFile> read_sequences(const std::string& path, ToolContext& context) {
  const auto input = context.open_input(path);
  if (!input) return input.error();
  auto file = sequences::read(input->text());
  if (!file) return std::move(file.error()).in_file(path);
  return file;
}

Result<int> list_sequences(const Options& options, ToolContext& context) {
  const auto file = read_sequences(options.sequences, context);
  if (!file) return file.error();
  Json list = Json::array();
  std::string text;
  for (const sequences::Sequence& sequence : file->sequences) {
    text += fmt::format("{}: frames {} to {}", sequence.name, sequence.first, sequence.last);
    if (sequence.speed != 1) text += fmt::format(", speed {}", readable(sequence.speed));
    if (sequence.loop) text += ", loop";
    text += "\n";
    Json entry;
    entry["name"] = sequence.name;
    entry["first"] = sequence.first;
    entry["last"] = sequence.last;
    entry["speed"] = sequence.speed;
    entry["loop"] = sequence.loop;
    list.push_back(std::move(entry));
  }
  context.report.result["rate"] = file->rate > 0 ? Json(file->rate) : Json();
  context.report.result["sequences"] = std::move(list);
  context.print(text);
  return kExitDone;
}

Status find_carrier(const io::FindRoles& find_roles, Edit& edit) {
  auto roles = find_roles(edit.clip.skeleton);
  if (!roles) return roles.error();
  edit.roles = std::move(*roles);
  edit.carrier = carrying_joint(edit.roles);
  return {};
}

// What a motion is settled on, and the mesh that is.
Status read_surroundings(const Options& options, ToolContext& context, Edit& edit) {
  if (options.settle) {
    auto ground = options.ground.open(context);
    if (!ground) return ground.error();
    edit.ground = *std::move(ground);
  }
  if (!options.model.empty()) {
    auto actor =
        io::open_actor(options.model, context, {.with_materials = false, .with_motions = false});
    if (!actor) return actor.error();
    if (!actor->motions.empty()) {
      return Error("edit-model", "is a motion, not a model", "krok-body makes a model for a motion")
          .in_file(options.model);
    }
    edit.model = std::make_shared<Model>(std::move(actor->model));
  }
  return {};
}

bool needs_keytimes(const Options& o) {
  const auto is_event = [](const std::optional<CutTime>& time) { return time && time->event; };
  return is_event(o.from) || is_event(o.to) || o.cycle != CycleFoot::none;
}

Status take_sequences(const Options& options, ToolContext& context, Edit& edit) {
  edit.sequence = options.sequence;
  if (options.sequences.empty()) return {};
  auto file = read_sequences(options.sequences, context);
  if (!file) return file.error();
  edit.sequences = std::move(*file);
  return {};
}

// Reads all inputs, each opened once.
Result<Edit> read_inputs(const InputFile& input, Options& options, ToolContext& context) {
  Edit edit;
  auto clip = io::open_motion(input, context);
  if (!clip) return clip.error();
  edit.clip = std::move(*clip);
  const auto find_roles = io::open_role_map(options.map, context);
  if (!find_roles) return find_roles.error();
  if (Status status = find_carrier(*find_roles, edit); !status) return status.error();
  complete_game_loop(options, edit);
  if (options.plant) {
    auto contacts =
        read_planting_contacts(options.contacts, options.input, frames_of(edit.clip), context);
    if (!contacts) return contacts.error();
    edit.contacts = std::move(*contacts);
  }
  if (needs_keytimes(options)) {
    auto keys = choose_keys(KeysChoice::automatic, options.input, name_of_input(options.input),
                            edit.clip, *find_roles, context);
    if (!keys) return keys.error();
    if (*keys) edit.keytimes = std::move((*keys)->keytimes);
  }
  if (Status status = take_sequences(options, context, edit); !status) return status.error();
  for (const std::string& path : options.append) {
    auto next = io::open_motion(path, context);
    if (!next) return next.error();
    const auto kept = std::make_shared<const Clip>(*std::move(next));
    FrameSource frames = frames_of(*kept);
    frames.read = [kept, read = std::move(frames.read)](auto... block) { return read(block...); };
    edit.appended.push_back(std::move(frames));
  }
  if (Status status = read_surroundings(options, context, edit); !status) return status.error();
  return edit;
}

// The result for one part of the input.
struct Edited {
  Json result;                     // for the report
  std::vector<std::string> lines;  // for display
};

// Applies the steps and adds the result to the outputs. `source_provenance`: of a long take, as
// complete as it is when its frames are written.
Result<Edited> edit_one(const Options& options, Edit edit, const std::string& output,
                        ToolContext& context, OutputSet& outputs,
                        const std::function<Provenance()>& source_provenance = {}) {
  const std::string before = summary_text(edit.source());
  // The order given in the help.
  for (const auto step : {clean, cut_out, mirror_sides, change_timing, append_motions, make_loop,
                          take_out_travel, change_size, change_place, settle_on_ground}) {
    if (Status status = step(options, context, edit); !status) {
      return std::move(status.error()).in_file(options.input);
    }
  }
  const auto provenance = [&] {
    if (edit.when_written) edit.when_written(edit);
    if (source_provenance) {
      edit.clip.provenance.conversions = source_provenance().conversions;
    }
    return extended(edit.clip.provenance, context.provenance(), edit.lines);
  };
  anim::WriteOptions writing;
  writing.orientation = options.orientation;
  writing.jobs = thread_count(context.jobs);
  const Status status = outputs.add(output, [&](OutputFile& file) {
    if (edit.frames) return anim::write(*edit.frames, provenance, writing, file);
    edit.clip.provenance = provenance();
    return anim::write(edit.clip, writing, file);
  });
  if (!status) return status.error();
  Edited edited;
  edited.lines.push_back(fmt::format("{}: {} -> {}: {}", name_of_input(options.input), before,
                                     output, summary_text(edit.source())));
  for (const std::string& line : edit.lines) edited.lines.push_back("  " + line);
  edited.result = summary_of(edit.source());
  edited.result["steps"] = std::move(edit.steps);
  return edited;
}

// One file per sequence; cleaning is done once for all.
Result<Edited> edit_all_sequences(const Options& options, Edit source, ToolContext& context,
                                  OutputSet& outputs,
                                  const std::function<Provenance()>& source_provenance = {}) {
  const std::string& pattern = context.output;
  const std::size_t place = pattern.rfind(kSequencePlace);
  if (place == std::string::npos) {
    return Error("usage", "several sequences need distinct names",
                 "select one with --sequence NAME, or use {sequence} for their names: -o "
                 "'take_{sequence}.anim'");
  }
  if (Status status = check_sequences(options, source); !status) return status.error();
  if (Status status = clean(options, context, source); !status) {
    return std::move(status.error()).in_file(options.input);
  }
  Options cleaned_already = options;
  cleaned_already.spikes = false;
  cleaned_already.filter = Filter::none;
  cleaned_already.joints = {};
  cleaned_already.plant = false;
  Edited all;
  all.result["sequences"] = Json::array();
  for (const sequences::Sequence& sequence : source.sequences->sequences) {
    Edit edit = source;
    edit.sequence = sequence.name;
    std::string output = pattern;
    output.replace(place, kSequencePlace.size(), sequence.name);
    auto edited =
        edit_one(cleaned_already, std::move(edit), output, context, outputs, source_provenance);
    if (!edited) return edited.error();
    Json entry;
    entry["name"] = sequence.name;
    entry["output"] = output;
    entry.update(edited->result);
    all.result["sequences"].push_back(std::move(entry));
    all.lines.insert(all.lines.end(), edited->lines.begin(), edited->lines.end());
  }
  return all;
}

// Inputs of fewer bytes are read whole, which takes less time than a second pass.
constexpr std::size_t kLongBytes = std::size_t{16} << 20;

Result<int> report(Edited edited, Json input_summary, OutputSet& outputs, ToolContext& context) {
  if (Status status = outputs.finish(); !status) return status.error();
  for (const std::string& line : edited.lines) context.log(line);
  context.report.result = std::move(edited.result);
  context.report.result["input"] = std::move(input_summary);
  return kExitDone;
}

struct Appended {
  std::vector<FrameSource> motions;
  std::vector<const InputFile*> files;
};

// Calls `use` with the motions to append, none of which is held in memory. They are opened within
// each other: a capture that proves damaged on the way is opened again, see io::stream_motion().
Status use_appended(const Options& options, ToolContext& context, Appended& appended,
                    const std::function<Status()>& use) {
  if (appended.motions.size() == options.append.size()) return use();
  const auto file = context.open_long_input(options.append[appended.motions.size()]);
  if (!file) return file.error();
  const io::ChecksumAtEnd checksum(*file, context);
  const auto read = io::stream_motion(*file, context, [&](const FrameSource& frames) {
    appended.motions.push_back(frames);
    appended.files.push_back(&*file);
    Status status = use_appended(options, context, appended, use);
    appended.motions.pop_back();
    appended.files.pop_back();
    return status;
  });
  return read ? Status() : Status(read.error());
}

// A long take, whose frames are written as they are read.
Result<int> edit_stream(const InputFile& input, const Options& options, ToolContext& context) {
  const auto find_roles = io::open_role_map(options.map, context);
  if (!find_roles) return find_roles.error();
  std::optional<OutputSet> outputs;
  Edited edited;
  Json input_summary;
  std::function<Provenance()> provenance;
  Appended appended;
  const auto complete = [&] {
    context.note_checksum(input);
    for (const InputFile* file : appended.files) context.note_checksum(*file);
    return provenance();
  };
  const auto use_with = [&](const FrameSource& frames) -> Status {
    Edit edit;
    edit.frames = frames;
    edit.appended = appended.motions;
    if (Status status = edit.take(frames); !status) return status;
    edit.clip.provenance = provenance();
    input_summary = summary_of(frames);
    if (Status status = find_carrier(*find_roles, edit); !status) return status;
    if (options.plant) {
      auto contacts = read_planting_contacts(options.contacts, options.input, frames, context);
      if (!contacts) return contacts.error();
      edit.contacts = *std::move(contacts);
    }
    if (needs_keytimes(options)) {
      auto keys = choose_keys(KeysChoice::automatic, input.path(), input.bytes().size(), frames,
                              provenance(), *find_roles, context);
      if (!keys) return keys.error();
      if (*keys) edit.keytimes = std::move((*keys)->keytimes);
    }
    if (Status status = take_sequences(options, context, edit); !status) return status;
    if (Status status = read_surroundings(options, context, edit); !status) return status;
    outputs.emplace(context);
    const bool all = edit.sequences && edit.sequence.empty();
    auto made =
        all ? edit_all_sequences(options, std::move(edit), context, *outputs, complete)
            : edit_one(options, std::move(edit), context.output, context, *outputs, complete);
    if (!made) return made.error();
    edited = *std::move(made);
    return {};
  };
  const auto use = [&](const FrameSource& frames) {
    Status result;  // kept aside, as an error is none of the file that is appended
    Status opened = use_appended(options, context, appended, [&] {
      result = use_with(frames);
      return Status();
    });
    return opened ? result : opened;
  };
  const auto read = io::stream_motion(input, context, use, {.provenance = &provenance});
  if (!read) return read.error();
  return report(std::move(edited), std::move(input_summary), *outputs, context);
}

bool is_long(std::span<const std::string> paths) {
  return std::ranges::any_of(paths, [](const std::string& path) {
    std::error_code unknown;  // of a file that is missing, which is reported where it is opened
    const auto bytes = std::filesystem::file_size(path, unknown);
    return !unknown && bytes >= kLongBytes;
  });
}

// Whether an option is given that is a step, or stores orientations otherwise.
bool has_step(const ToolContext& context) {
  return std::ranges::any_of(context.result_options.items(), [](const auto& option) {
    return option.key() != "input" && option.key() != "map";
  });
}

}  // namespace

Status Edit::take(Result<FrameSource> made) {
  if (!made) return made.error();
  Provenance kept = std::move(clip.provenance);
  auto made_clip = load(frames ? part_of(*made, 0, std::min(made->frame_count, 1)) : *made, 1);
  if (!made_clip) return made_clip.error();
  clip = *std::move(made_clip);
  clip.provenance = std::move(kept);
  if (frames) frames = *std::move(made);
  return {};
}

bool is_streamed(const Options& o) {
  const bool loops = o.game_loop || o.cycle != CycleFoot::none || o.loop || o.rounds;
  // A sequence may be a loop, whose feet are planted as those of the whole motion.
  return !loops && !o.interpolation.hermite && !(o.plant && !o.sequences.empty());
}

Status Edit::hold(int jobs) {
  if (!frames) return {};
  auto whole = load(*frames, jobs);
  if (!whole) return whole.error();
  whole->provenance = std::move(clip.provenance);
  clip = *std::move(whole);
  frames.reset();
  return {};
}

void Edit::note(const char* step, Json metrics, std::string line) {
  Json entry;
  entry["step"] = step;
  entry["did"] = line;
  for (auto& [key, value] : metrics.items()) entry[key] = std::move(value);
  steps.push_back(std::move(entry));
  lines.push_back(std::move(line));
}

void Edit::complete_note(std::function<std::string(Edit&, Json& metrics)> complete) {
  when_written = [before = std::move(when_written), complete = std::move(complete),
                  number = lines.size() - 1](Edit& written) {
    if (before) before(written);
    Json& step = written.steps[number];
    written.lines[number] = complete(written, step);
    step["did"] = written.lines[number];
  };
}

Result<int> run(const Options& given, ToolContext& context) {
  Options options = given;
  if (options.list_sequences) return list_sequences(options, context);
  if (context.output.empty()) return no_output_for(options.input);
  if (!has_step(context)) {
    return usage("no step is requested, so the motion would be copied",
                 "krok-edit -h lists the steps; krok-import converts captures to .anim");
  }
  const auto input = context.open_long_input(options.input);
  if (!input) return input.error();
  if (is_streamed(options) && (input->bytes().size() >= kLongBytes || is_long(options.append))) {
    return edit_stream(*input, options, context);
  }
  context.note_checksum(*input);
  auto source = read_inputs(*input, options, context);
  if (!source) return source.error();
  Json input_summary = summary_of(frames_of(source->clip));
  const bool all_sequences = source->sequences && source->sequence.empty();
  OutputSet outputs(context);
  auto edited = all_sequences
                    ? edit_all_sequences(options, std::move(*source), context, outputs)
                    : edit_one(options, std::move(*source), context.output, context, outputs);
  if (!edited) return edited.error();
  return report(*std::move(edited), std::move(input_summary), outputs, context);
}

}  // namespace krok::cli::edit
