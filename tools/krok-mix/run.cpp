#include "tools/krok-mix/options.h"

#include <fmt/format.h>

#include <array>
#include <filesystem>
#include <list>
#include <memory>
#include <optional>
#include <set>
#include <vector>

#include "core/numbers.h"
#include "core/text.h"
#include "formats/csv/csv_writer.h"
#include "formats/io/formats.h"
#include "formats/io/open_character.h"
#include "formats/io/open_motion.h"
#include "formats/sequences/sequences.h"
#include "formats/timeline/timeline_file.h"
#include "timeline/mix.h"
#include "tools/cli/output_set.h"
#include "tools/cli/paths.h"
#include "tools/cli/renamed_options.h"
#include "tools/krok-mix/face.h"
#include "tools/shared/keys_sidecar.h"
#include "tools/shared/planting.h"
#include "tools/shared/shared_options.h"

namespace krok::cli::mix {

namespace {

// The motions of a timeline; the sources point into it.
struct TimelineSources {
  struct Motion {
    Clip clip;
    MotionKeys keys;
  };
  std::list<Motion> motions;
  std::vector<timeline::Source> sources;
};

std::string beside(const std::string& path, const std::string& name) {
  if (path == "-") return name;
  return (std::filesystem::path(path).parent_path() / name).string();
}

Result<std::vector<timeline::Part>> read_parts(const std::string& path, double rate,
                                               ToolContext& context) {
  const auto file = context.open_input(path);
  if (!file) return file.error();
  const auto named = sequences::read(file->text());
  if (!named) return Error(named.error()).in_file(path);
  std::vector<timeline::Part> parts;
  const double counted_at = named->rate > 0 ? named->rate : rate;
  for (const sequences::Sequence& sequence : named->sequences) {
    parts.push_back({sequence.name,
                     {sequence.first / counted_at, false},
                     {sequence.last / counted_at, false},
                     sequence.speed,
                     sequence.loop});
  }
  return parts;
}

// Reads the motions, relative to the folder of the timeline at `path`, their named parts, and the
// keys of those in the base track.
Result<TimelineSources> read_sources(const timeline_file::Document& document,
                                     const std::string& path, const Options& options,
                                     const io::FindRoles& find_roles, ToolContext& context) {
  std::set<int> in_base;
  for (const timeline::BaseItem& item : document.timeline.base) in_base.insert(item.play.source);
  TimelineSources read;
  for (std::size_t i = 0; i < document.sources.size(); ++i) {
    const timeline_file::SourceFile& source = document.sources[i];
    const std::string motion_path = beside(path, source.path);
    auto clip = io::open_motion(motion_path, context);
    if (!clip) return clip.error();
    auto& motion = read.motions.emplace_back();
    motion.clip = std::move(*clip);
    warn_of_lost_speed(source.name, motion.clip, context);
    timeline::Source made{source.name, &motion.clip, nullptr, {}};
    if (in_base.contains(static_cast<int>(i))) {
      auto keys =
          choose_keys(options.keys, motion_path, source.name, motion.clip, find_roles, context);
      if (!keys) return keys.error();
      if (*keys) {
        motion.keys = std::move(**keys);
        made.keys = &motion.keys;
      }
    }
    if (!source.sequences.empty()) {
      auto parts = read_parts(beside(path, source.sequences), motion.clip.rate, context);
      if (!parts) return parts.error();
      made.parts = std::move(*parts);
    }
    read.sources.push_back(std::move(made));
  }
  return read;
}

using timeline::ChangeFacts;
using timeline::Event;
using timeline::ItemFacts;
using timeline::Mixed;

Result<timeline_file::Document> read_timeline(const Options& options, ToolContext& context) {
  const auto file = context.open_input(options.input);
  if (!file) return file.error();
  if (io::format_of(*file).reads_motion()) {
    return Error("mix-input",
                 fmt::format("is {}, not a timeline", registry::describe_content(file->bytes())),
                 too_many_hint("krok-mix", {}))
        .in_file(file->path());
  }
  return timeline_file::read(file->text(), file->path());
}

std::string joint_name(const Mixed& mixed, int joint) {
  return mixed.clip.skeleton.names[static_cast<std::size_t>(joint)];
}

std::string pace_in_words(const timeline::Pace& pace, timeline::PaceOf of,
                          const std::string& joint) {
  const bool speed = of == timeline::hips_speed || of == timeline::feet_speed;
  return fmt::format("{} {} {} {}", speed ? "moves" : "accelerates", joint, speed ? "at" : "by",
                     fmt::format("{:.2g} {}", pace.most, speed ? "m/s" : "m/s²"));
}

void warn_of_pops(const timeline::Timeline& timeline, const Mixed& mixed, ToolContext& context) {
  for (const ChangeFacts& change : mixed.changes) {
    if (!change.pops()) continue;
    const timeline::BaseItem& item = timeline.base[static_cast<std::size_t>(change.item)];
    Diagnostic diagnostic;
    diagnostic.severity = Severity::warning;
    diagnostic.code = "mix-pop";
    const auto pace = worst_pace(change.paces);
    diagnostic.joint = joint_name(mixed, pace ? change.paces[*pace].joint : change.fastest_joint);
    diagnostic.frame = pace ? change.paces[*pace].frame : change.fastest_frame;
    diagnostic.message = fmt::format(
        "the change ({}) into {} {} (frame {}); 99 % of the frames of the "
        "motions stay below {}",
        timeline::change_name(change.kind), shown(item.name),
        pace ? pace_in_words(change.paces[*pace], *pace, diagnostic.joint)
             : fmt::format("rotates {} at {:.0f} degrees per second", diagnostic.joint,
                           change.fastest / kRadiansPerDegree),
        diagnostic.frame,
        pace ? fmt::format("{:.2g}", change.paces[*pace].usual)
             : fmt::format("{:.0f}", change.usual / kRadiansPerDegree));
    diagnostic.hint = change.kind == timeline::ChangeKind::cut
                          ? "a change of kind inertial or crossfade is smooth"
                          : "use a longer duration or another time";
    diagnostic.where = item.where;
    context.diagnose(std::move(diagnostic));
  }
}

// Beside the motion, for krok-skin --weights.
std::string weights_path(const std::string& output) {
  return cli::beside(output, ".weights.csv");
}

Status write_results(const Options& options, const TimelineSources& motions, Mixed& mixed,
                     const MorphWeights& face, ToolContext& context) {
  mixed.clip.provenance = context.provenance();
  for (const timeline::Source& source : motions.sources) {
    for (const std::string& conversion : source.clip->provenance.conversions) {
      mixed.clip.provenance.conversions.push_back(fmt::format("{}: {}", source.name, conversion));
    }
  }
  OutputSet outputs(context);
  Status status = add_motion(mixed.clip, mixed.keys, options.orientation, context.output,
                             context.jobs, outputs);
  if (status && !face.values.empty()) {
    status = outputs.add(weights_path(context.output),
                         [&](OutputFile& file) { return csv::write(face, file); });
  }
  return status ? outputs.finish() : status;
}

// The file that the timeline names, or an empty one.
Result<Actor> read_character(const timeline_file::Document& document, const Options& options,
                             ToolContext& context) {
  if (document.character.empty()) return Actor();
  return io::open_actor(beside(options.input, document.character), context,
                        {.with_morphs = true, .with_motions = false});
}

Json gaze_report(const std::vector<krok::ik::GazeFacts>& gaze) {
  Json list = Json::array();
  for (const krok::ik::GazeFacts& shift : gaze) {
    list.push_back({{"amplitude", to_degrees(shift.amplitude)},
                    {"head", to_degrees(shift.head)},
                    {"missed", to_degrees(shift.missed)}});
  }
  return list;
}

Json layer_name(const timeline::Timeline& timeline, int layer) {
  return layer < 0 ? Json() : Json(timeline.layers[static_cast<std::size_t>(layer)].name);
}

Json items_report(const timeline::Timeline& timeline, const Mixed& mixed) {
  Json list = Json::array();
  for (const ItemFacts& item : mixed.items) {
    list.push_back({{"name", item.name},
                    {"layer", layer_name(timeline, item.layer)},
                    {"start", item.start},
                    {"end", item.end},
                    {"rounds", item.rounds},
                    {"skipped", item.skipped}});
  }
  return list;
}

Json paces_report(const Mixed& mixed, const ChangeFacts& change) {
  constexpr std::array<const char*, timeline::kPaces> kNames = {
      "hips_speed", "feet_speed", "hips_acceleration", "feet_acceleration"};
  Json paces;
  for (std::size_t of = 0; of < kNames.size(); ++of) {
    const timeline::Pace& pace = change.paces[of];
    paces[kNames[of]] = {{"largest", pace.most},
                         {"usual", pace.usual},
                         {"joint", joint_name(mixed, pace.joint)},
                         {"frame", pace.frame}};
  }
  return paces;
}

Json changes_report(const timeline::Timeline& timeline, const Mixed& mixed) {
  Json list = Json::array();
  for (const ChangeFacts& change : mixed.changes) {
    list.push_back({{"into", timeline.base[static_cast<std::size_t>(change.item)].name},
                    {"kind", timeline::change_name(change.kind)},
                    {"start", change.begin},
                    {"end", change.end},
                    {"in_step", change.in_step},
                    {"on_feet", change.on_feet},
                    {"angle", to_degrees(change.angle)},
                    {"angle_joint", joint_name(mixed, change.angle_joint)},
                    {"angular_velocity", to_degrees(change.fastest)},
                    {"angular_velocity_joint", joint_name(mixed, change.fastest_joint)},
                    {"angular_velocity_frame", change.fastest_frame},
                    {"usual_angular_velocity", to_degrees(change.usual)},
                    {"paces", paces_report(mixed, change)},
                    {"pops", change.pops()}});
  }
  return list;
}

Json events_report(const timeline::Timeline& timeline, const Mixed& mixed) {
  constexpr const char* kKinds[] = {"begin", "end", "loop", "mark"};
  Json list = Json::array();
  for (const Event& event : mixed.events) {
    Json entry = {{"time", event.time},
                  {"frame", event.time * mixed.clip.rate},
                  {"event", kKinds[static_cast<std::size_t>(event.kind)]},
                  {"item", event.item},
                  {"layer", layer_name(timeline, event.layer)}};
    if (event.kind == Event::Kind::mark) entry["name"] = event.name;
    if (event.round > 0) entry["round"] = event.round;
    list.push_back(std::move(entry));
  }
  return list;
}

void report(const timeline::Timeline& timeline, const Mixed& mixed, ToolContext& context) {
  Json& result = context.report.result;
  result["frames"] = mixed.clip.frame_count();
  result["rate"] = mixed.clip.rate;
  result["duration"] = mixed.clip.duration();
  result["items"] = items_report(timeline, mixed);
  result["changes"] = changes_report(timeline, mixed);
  result["events"] = events_report(timeline, mixed);
  result["keytimes"] = to_json(mixed.keys.keytimes);
  result["contacts"] = mixed.keys.contacts.size();
}

}  // namespace

Result<int> run(const Options& options, ToolContext& context) {
  const auto find_roles = io::open_role_map(options.map, context);
  if (!find_roles) return find_roles.error();
  const auto document = read_timeline(options, context);
  if (!document) return document.error();
  const timeline::Timeline& timeline = document->timeline;
  const auto motions = read_sources(*document, options.input, options, *find_roles, context);
  if (!motions) return motions.error();
  if (motions->sources.empty()) {
    return Error("timeline-empty", "has no motions").in_file(options.input);
  }
  const auto roles = (*find_roles)(motions->sources.front().clip->skeleton);
  if (!roles) return roles.error();
  auto mixed = timeline::mix(timeline, motions->sources, *roles, {.jobs = context.jobs});
  if (!mixed) return Error(mixed.error()).in_file(options.input);
  context.diagnose(mixed->warnings);
  warn_of_pops(timeline, *mixed, context);
  std::optional<PlantDrift> drift;
  if (options.plant) {
    auto planted = plant_result(mixed->clip, mixed->keys, *roles, context);
    if (!planted) return planted.error();
    drift = *planted;
  }
  const auto character = read_character(*document, options, context);
  if (!character) return character.error();
  const auto gaze = add_gaze(*document, *character, *roles, mixed->clip);
  if (!gaze) return Error(gaze.error()).in_file(options.input);
  MorphWeights face;
  if (!document->face.empty()) {
    auto made = face_of(*document, options.input, *character, mixed->clip, context);
    if (!made) return made.error();
    face = *std::move(made);
    if (context.output == "-") {
      return Error("usage", "the face's weights need a file beside the motion", "use -o OUT.anim");
    }
  }
  if (Status status = write_results(options, *motions, *mixed, face, context); !status) {
    return status.error();
  }
  report(timeline, *mixed, context);
  constexpr double kNothing = 0.01;  // seconds
  for (const ItemFacts& item : mixed->items) {
    if (item.skipped < kNothing) continue;
    if (item.skipped > item.end - item.start) {
      context.warn("timeline-skipped",
                   fmt::format("{}: of {} s its first {} s are left out, so that its steps meet "
                               "those before",
                               item.name, readable(item.skipped + item.end - item.start, 3),
                               readable(item.skipped, 3)),
                   "\"sync\": \"clock\" plays them; or let the item before it end elsewhere");
      continue;
    }
    context.log(fmt::format(
        "{}: its first {} s are left out, so that its steps meet those before (\"sync\": "
        "\"clock\" plays them)",
        item.name, readable(item.skipped, 3)));
  }
  if (!gaze->empty()) context.report.result["gaze"] = gaze_report(*gaze);
  if (!face.values.empty()) {
    context.report.result["face"] = face.names;
    context.log(fmt::format("{}: {} of the face", weights_path(context.output),
                            counted(std::ssize(face.names), "target")));
  }
  if (drift) {
    context.report.result["planted"] = to_json(*drift);
    context.log(text_of(*drift));
  }
  context.log(fmt::format(
      "{} -> {}: {} and {} on {}, {} at {} fps ({} s)", options.input, context.output,
      counted(timeline.base.size(), "item"), counted(timeline.layers.size(), "layer"),
      counted(motions->sources.size(), "motion"), counted(mixed->clip.frame_count(), "frame"),
      readable(mixed->clip.rate), readable(mixed->clip.duration(), 4)));
  return kExitDone;
}

namespace {

void declare(CommandOptions& command, Options& options) {
  command
      .add_option("input IN.json", options.input,
                  "Timeline (JSON): a sequence of motions, transitions, layers; see "
                  "formats/timeline/SPEC.md")
      .required();
  command.group("Time");
  add_keys_option(command, options.keys);
  command.group("Space");
  add_map_option(command, options.map);
  add_plant_flag(command, options.plant);
  add_orientation_option(command, options.orientation);
}

}  // namespace

ToolSpec make_spec() {
  const auto options = std::make_shared<Options>();
  ToolSpec spec = spec_of<Options>("krok-mix", options, declare, nullptr, run);
  spec.summary = "Bakes a timeline of motions, transitions and layers to one motion";
  spec.details =
      "Sequences, cross-fades, and layers for parts of the body; the face (expressions, speech, "
      "blinks) as weights beside the motion, OUT.weights.csv; eyes that look at things.";
  spec.inputs = "IN.json";
  spec.writes = registry::Kind::anim;
  spec.examples = {
      {"krok-mix story.json -o story.anim --json=story.report.json",
       "story.json: {\"schema\": \"krok.timeline/1\", \"sources\": {\"walk\": \"walk.anim\", "
       "\"run\": \"run.anim\"}, \"base\": [{\"source\": \"walk\", \"loop\": 2}, {\"source\": "
       "\"run\", \"change\": {\"kind\": \"crossfade\", \"duration\": \"0.4s\"}}]}"},
      {"krok-mix wave.json -o wave.anim",
       "wave.json adds: \"layers\": [{\"mask\": [{\"below\": \"LeftShoulder\", \"soft\": "
       "2}], \"items\": [{\"source\": \"wave\", \"at\": \"1s\", \"fade_in\": \"0.3s\"}]}]"},
      {"krok-mix talk.json -o talk.anim && krok-skin hero.character talk.anim --weights "
       "talk.weights.csv -o talk.glb",
       "talk.json adds: \"character\": \"hero.character\", \"face\": [{\"phonemes\": "
       "\"talk.TextGrid\"}, {\"blinks\": 26, \"target\": \"blink\"}], \"gaze\": [{\"at\": \"1s\", "
       "\"target\": [2, 1.6, 3]}]"},
      {"krok-mix 'stories/scene_*.json' --out-dir out", "all timelines matching a pattern"}};
  spec.batch = {{".json"}, always(".anim")};
  return spec;
}

}  // namespace krok::cli::mix
