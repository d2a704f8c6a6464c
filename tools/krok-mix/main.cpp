#include <memory>

#include "tools/krok-mix/mix_files.h"

namespace {

krok::ToolSpec make_spec() {
  const auto options = std::make_shared<krok::mix_tool::Options>();
  krok::ToolSpec spec;
  spec.name = "krok-mix";
  spec.summary =
      "Bakes a timeline to a motion: a sequence of motions, transitions between them, layers on "
      "top";
  spec.inputs = "IN.json";
  spec.examples = {
      {"krok-mix story.json -o story.anim --json=story.report.json",
       "story.json: {\"schema\": \"krok.timeline/1\", \"sources\": {\"walk\": \"walk.anim\", "
       "\"run\": \"run.anim\"}, \"base\": [{\"source\": \"walk\", \"loop\": 2}, {\"source\": "
       "\"run\", \"change\": {\"kind\": \"crossfade\", \"duration\": \"0.4s\"}}]}"},
      {"krok-mix wave.json -o wave.anim",
       "wave.json adds: \"layers\": [{\"mask\": [{\"below\": \"LeftShoulder\", \"soft\": "
       "2}], \"items\": [{\"source\": \"wave\", \"at\": \"1s\", \"fade_in\": \"0.3s\"}]}]"},
      {"krok-mix 'stories/scene_*.json' --out-dir out", "all timelines matching a pattern"}};
  spec.batch = {{".json"}, krok::always(".anim")};
  spec.declare = [options](krok::CommandOptions& command) { declare(command, *options); };
  spec.run = [options](krok::ToolContext& context) { return run(*options, context); };
  return spec;
}

}  // namespace

int main(int argc, char** argv) {
  return krok::run_tool(make_spec, argc, argv);
}
