#include <fmt/format.h>

#include <memory>
#include <optional>
#include <utility>

#include "compare/scene_difference.h"
#include "core/numbers.h"
#include "draw/viewer_page.h"
#include "formats/gltf/gltf_reader.h"
#include "formats/io/formats.h"
#include "nodes/scene_of.h"
#include "terrain/spec.h"
#include "tools/cli/output_set.h"
#include "tools/cli/paths.h"
#include "tools/cli/tool.h"
#include "tools/krok-view/files.h"
#include "tools/krok-view/options.h"
#include "tools/shared/shared_options.h"
#include "tools/shared/shown_ground.h"

namespace krok::cli::view {

namespace {

// The file with the animation alone that it plays first.
Result<Scene> scene_of_glb(const Files::Glb& glb) {
  auto read = gltf::read(glb.bytes);
  if (!read) return std::move(read).error().in_file(glb.path);
  auto made = scene_of(std::make_shared<const nodes::Scene>(*std::move(read)));
  if (!made) return std::move(made).error().in_file(glb.path);
  if (made->animations.empty()) return made;
  const int shown = glb.animation;
  const Scene::Animation animation = made->animations[static_cast<std::size_t>(shown)];
  made->animations.assign(1, animation);
  made->evaluate = [inner = std::move(made->evaluate), shown](int chosen, double time,
                                                              SceneState& state) {
    inner(chosen < 0 ? chosen : shown, time, state);
  };
  made->place = nullptr;  // which way triangles face does not count here
  return made;
}

// How far the vertices of `file` are from those of `other`, in the animations that both play first,
// as krok-diff compares them. None if they have no vertices to compare, or
// too many times.
Result<std::optional<draw::ViewedDifference>> difference_of(const Files::Glb& other,
                                                            const Files::Glb& file,
                                                            ToolContext& context) {
  const auto first = scene_of_glb(other);
  if (!first) return first.error();
  const auto second = scene_of_glb(file);
  if (!second) return second.error();
  const auto found = compare::difference(*first, *second, {}, context.jobs, *context.progress);
  if (!found) return std::optional<draw::ViewedDifference>();  // the page measures by itself
  draw::ViewedDifference difference{file.animation, other.animation, {}, {}, 0, 0};
  const bool moving = !first->animations.empty() && !second->animations.empty();
  for (const compare::MomentDifference& moment : found->moments) {
    if (moment.positions.mesh < 0 || (moment.animation < 0) == moving) continue;
    const float distance = moment.positions.largest;
    difference.times.push_back(moment.time);
    difference.distances.push_back(distance);
    if (distance <= difference.distance) continue;
    difference.distance = distance;
    difference.time = moment.time;
  }
  std::optional<draw::ViewedDifference> result;
  if (!difference.times.empty()) result = std::move(difference);
  return result;
}

draw::ViewerPage page_of(const Files& files, const Options& options, Layout layout) {
  draw::ViewerPage page;
  page.apart = layout == Layout::apart;
  page.difference = options.difference;
  // In a list one file is visible at a time, initially the first.
  const auto visible = [&](std::size_t place) { return layout != Layout::list || place == 0; };
  for (const Files::Motion& motion : files.motions) {
    draw::ViewedMotion viewed;
    viewed.name = motion.name;
    viewed.facts = facts_of(motion.clip);
    viewed.visible = visible(page.motions.size());
    viewed.clip = &motion.clip;
    viewed.body = motion.body;
    viewed.materials = motion.materials;
    viewed.keys = motion.keys;
    viewed.goals = motion.goals;
    page.motions.push_back(std::move(viewed));
  }
  for (const Files::Glb& glb : files.glbs) {
    draw::ViewedGlb viewed;
    viewed.name = glb.name;
    viewed.visible = visible(page.motions.size() + page.files.size());
    if (!glb.rates.empty()) {
      viewed.facts = fmt::format(
          "{}{} fps", glb.rates.size() > 1 ? fmt::format("{} clips, ", glb.rates.size()) : "",
          readable(glb.rates[static_cast<std::size_t>(glb.animation)]));
    }
    viewed.bytes = glb.bytes;
    viewed.animation = glb.animation;
    viewed.rates = glb.rates;
    page.files.push_back(std::move(viewed));
  }
  for (const Files::Camera& camera : files.cameras) {
    page.cameras.push_back(
        {camera.name,
         fmt::format("{} frames, {} fps", camera.track.frame_count(), readable(camera.track.rate)),
         &camera.track});
  }
  page.title = options.title;
  if (page.title.empty()) {
    page.title = !page.motions.empty() ? page.motions.front().name
                 : !page.files.empty() ? page.files.front().name
                                       : page.cameras.front().name;
    const std::size_t all = page.motions.size() + page.files.size() + page.cameras.size();
    if (all > 1) page.title += fmt::format(" and {} more", all - 1);
  }
  return page;
}

Status check_layout(const Options& options, const Files& files) {
  if (options.ground.empty() && options.prints.empty()) return {};
  if (options.layout == Layout::apart) {
    return Error("usage", "--ground and --prints are for motions at their own positions",
                 "leave out --layout apart");
  }
  if (!files.motions.empty()) return {};
  return Error("usage", "--ground and --prints need a motion",
               "give the .anim that krok-walk wrote");
}

Status add_walk(const Options& options, ToolContext& context, draw::ViewerPage& page) {
  const auto ground = options.ground.open(context);
  if (!ground) return ground.error();
  std::vector<gait::Print> prints;
  if (!options.prints.empty()) {
    auto opened = open_prints(options.prints, context);
    if (!opened) return opened.error();
    prints = *std::move(opened);
  }
  Status status = add_ground(ground->get(), prints, page, context);
  if (!status && status.error().code.starts_with("walk-")) {
    return std::move(status).error().in_file(options.prints);
  }
  return status;
}

}  // namespace

Result<int> run(const Options& options, ToolContext& context) {
  const auto files = read_files(options, context);
  if (!files) return files.error();
  const std::size_t actors = files->motions.size() + files->glbs.size();
  if (options.difference && files->motions.size() < 2 && files->glbs.size() < 2) {
    return Error("usage", "--difference needs two motions, or two glTF files");
  }
  if (Status status = check_layout(options, *files); !status) return status.error();
  Layout layout = options.layout;
  const bool on_ground = !options.ground.empty() || !options.prints.empty();
  if ((options.difference || on_ground) && layout == Layout::automatic) layout = Layout::together;
  if (layout == Layout::automatic) layout = actors > 4 ? Layout::list : Layout::apart;
  if (actors < 2) layout = Layout::together;

  draw::ViewerPage page = page_of(*files, options, layout);
  if (Status status = add_walk(options, context, page); !status) return status.error();
  if (options.difference && files->motions.size() < 2) {
    auto difference = difference_of(files->glbs[0], files->glbs[1], context);
    if (!difference) return difference.error();
    page.files[1].difference = *std::move(difference);
  }
  auto html = draw::write_viewer_page(page);
  if (!html) return html.error();
  const Status status = write_output(context, context.output, *html);
  if (!status) return status.error();

  Json shown = Json::array();
  for (const Files::Motion& motion : files->motions) {
    shown.push_back({{"name", motion.name},
                     {"joints", motion.clip.joint_count()},
                     {"frames", motion.clip.frame_count()},
                     {"rate", motion.clip.rate},
                     {"vertices", motion.body ? motion.body->vertex_count() : 0},
                     {"materials", motion.materials.size()},
                     {"contacts", motion.keys.contacts.size()},
                     {"keytimes", motion.keys.keytimes.size()},
                     {"goals", motion.goals.size()}});
  }
  context.report.result["motions"] = std::move(shown);
  context.report.result["files"] = files->glbs.size();
  Json clips = Json::array();
  for (const Files::Glb& glb : files->glbs) {
    for (std::size_t i = 0; i < glb.rates.size(); ++i) {
      clips.push_back({{"file", glb.name}, {"name", glb.animations[i]}, {"rate", glb.rates[i]}});
    }
  }
  context.report.result["clips"] = std::move(clips);
  context.report.result["cameras"] = files->cameras.size();
  context.report.result["ground_triangles"] = page.ground.triangles.size();
  context.report.result["prints"] = page.prints.size();
  context.report.result["bytes"] = html->size();
  context.log(fmt::format("{}: {}, {:.1f} MB; open it in a browser", context.output,
                          actors == 1 ? "1 character" : fmt::format("{} characters", actors),
                          static_cast<double>(html->size()) / 1e6));
  return kExitDone;
}

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
