#include "tools/krok-mix/options.h"

#include <memory>

#include "tools/shared/shared_options.h"

namespace krok::cli::mix {

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
