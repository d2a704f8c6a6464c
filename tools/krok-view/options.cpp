#include "tools/krok-view/options.h"

#include <memory>

#include "formats/io/formats.h"
#include "terrain/spec.h"
#include "tools/cli/file_name.h"
#include "tools/shared/shared_options.h"

namespace krok::cli::view {

namespace {

void declare(CommandOptions& command, Options& options) {
  command
      .add_option("inputs IN", options.inputs,
                  "Motions (.anim, or a capture such as BVH), models and characters (.model, "
                  ".character, animated by the motions of their skeleton), cameras (.cam), glTF; "
                  "for a folder, all motions, characters and glTF in it")
      .required();
  command.add("--layout HOW", options.layout,
              choice<Layout>({{"auto", Layout::automatic},
                              {"apart", Layout::apart},
                              {"together", Layout::together},
                              {"list", Layout::list}}),
              "Layout of several characters: apart (side by side), together (at their own "
              "positions), list (one at a time), or auto: apart for up to four, otherwise list",
              "auto");
  command.add_flag(
      "--difference", options.difference,
      "Show the first two characters together: the second coloured by its distance from "
      "the first, with a legend, the first as a ghost");
  add_body_option(
      command, options.body,
      "Body for motions without a model: none, low (2,500 vertices), medium (10,000), "
      "high (40,000), or auto: medium, low for more than two actors. Motions of one skeleton "
      "share a body");
  command.add("--contacts WHICH", options.keys,
              contacts_choice<KeysChoice>({{"auto", KeysChoice::automatic},
                                           {"find", KeysChoice::find},
                                           {"none", KeysChoice::none}}),
              "Contacts and keytimes to mark on the timeline: auto (from the sidecar "
              "NAME.keys.json), find (detected as in krok-keys), none",
              "auto");
  command.add_option("--goals IN.json", options.goals,
                     "Show the goals of a krok-ik file (formats/goals/SPEC.md) on all motions: "
                     "places, chains of joints, and by how much each is missed");
  add_ground_option(command, options.ground,
                    "Show this ground, as for krok-walk: a height field (.exr, 16-bit .png), a "
                    "mesh (.gltf, .glb, .obj), or " +
                        std::string(terrain::kSpecForms));
  command.add_option(
      "--clip NAME", options.clip,
      "Animation of glTF files that plays first [the first that moves at least half as "
      "many joints as any other]. All others can be chosen on the page");
  add_prints_option(command, options.prints,
                    "Show footprints (formats/prints/SPEC.md) on the ground, as krok-walk "
                    "--save-prints writes them; those that a foot stands on are marked");
  command.add_option(
      "--bodies IN.ragdoll.json", options.bodies,
      "Show the rigid bodies of a krok-ragdoll file (formats/ragdoll/SPEC.md) on all "
      "motions, translucent");
  command.add_option("--title WORDS", options.title,
                     "The page's title; default: the first file's name");
}

}  // namespace

ToolSpec make_spec() {
  const auto options = std::make_shared<Options>();
  ToolSpec spec = spec_of<Options>("krok-view", options, declare, nullptr, run);
  spec.keeps_going = true;
  spec.summary = "Makes an HTML page that plays motions offline in any browser";
  spec.details = "It shows characters and cameras, too, on any ground with footprints.";
  spec.inputs = "IN...";
  spec.folder_endings = io::endings([](const io::Format& format) {
    return format.reads_motion() || format.kind == registry::Kind::character;
  });
  spec.output_endings = {".html", ".htm"};
  spec.default_output = [options] { return beside(options->inputs.front(), ".html"); };
  spec.examples = {{"krok-view walk.bvh -o walk.html", "a capture, with a generated body"},
                   {"krok-view before.anim after.anim --difference -o change.html",
                    "two motions at the same position, the first coloured by its "
                    "distance from the second"},
                   {"krok-view hero.model walk.anim shot.cam -o shot.html",
                    "an animated model, viewed through a recorded camera"},
                   {"krok-view walk.anim reach.anim --goals goals.json -o goals.html",
                    "a motion before and after krok-ik, with its goals"},
                   {"krok-view walk.anim --ground stairs:rise=17cm,run=29cm --prints prints.csv "
                    "-o stairs.html",
                    "a walk of krok-walk on its ground, with its footprints"},
                   {"krok-view hero.character walk.anim -o hero.html",
                    "an animated character with its materials; without a motion, in "
                    "its reference pose"}};
  return spec;
}

}  // namespace krok::cli::view
