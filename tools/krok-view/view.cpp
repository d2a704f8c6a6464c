#include "tools/krok-view/view.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/numbers.h"
#include "draw/viewer_page.h"
#include "tools/common/one_of.h"
#include "tools/common/output_set.h"
#include "tools/krok-view/files.h"

namespace krok::view {

namespace {

std::string facts_of(const Clip& clip) {
  if (clip.frame_count() == 0) return fmt::format("{} joints, no motion", clip.joint_count());
  return fmt::format("{} joints, {} frames, {} fps, {} s", clip.joint_count(), clip.frame_count(),
                     readable(clip.rate), fmt::format("{:.2f}", clip.duration()));
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
    page.motions.push_back(std::move(viewed));
  }
  for (const Files::Glb& glb : files.glbs) {
    draw::ViewedGlb viewed;
    viewed.name = glb.name;
    viewed.visible = visible(page.motions.size() + page.files.size());
    viewed.bytes = glb.bytes;
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

}  // namespace

void declare(CommandOptions& command, Options& options) {
  command
      .add_option("inputs", options.inputs,
                  "Motions (.anim, or a capture such as BVH), models and characters "
                  "(.model, .character, animated by the motions of their skeleton), "
                  "cameras (.cam), glTF; for a folder, all motions, characters and "
                  "glTF in it")
      .type_name("IN")
      .required();
  command
      .add_option("--layout", options.layout,
                  "Layout of several characters: apart (side by side), together (at "
                  "their own positions), list (one at a time), or auto: apart for up "
                  "to four, otherwise list")
      .type_name("HOW")
      .transform(one_of<Layout>({{"auto", Layout::automatic},
                                 {"apart", Layout::apart},
                                 {"together", Layout::together},
                                 {"list", Layout::list}}))
      .default_str("auto");
  command.add_flag("--difference", options.difference,
                   "Show the first two characters together and colour joints of the same name by "
                   "their distance");
  add_body_option(command, options.body,
                  "Body for motions without a model: none, low (2,500 vertices), medium (10,000), "
                  "high (40,000), or auto: lower detail for more files, none for more than four");
  command
      .add_option("--keys", options.keys,
                  "Contacts and keytimes to mark on the timeline: auto (from the sidecar "
                  "NAME.keys.json), find (detected as in krok-keys), none")
      .type_name("WHICH")
      .transform(one_of<KeysChoice>({{"auto", KeysChoice::automatic},
                                     {"find", KeysChoice::find},
                                     {"none", KeysChoice::none}}))
      .default_str("auto");
  command.add_option("--title", options.title, "The page's title; default: the first file's name")
      .type_name("WORDS");
}

Result<int> run(const Options& options, ToolContext& context) {
  const auto files = read_files(options, context);
  if (!files) return files.error();
  const std::size_t actors = files->motions.size() + files->glbs.size();
  if (options.difference && files->motions.size() < 2) {
    return Error("usage", "--difference needs two motions");
  }
  Layout layout = options.layout;
  if (options.difference && layout == Layout::automatic) layout = Layout::together;
  if (layout == Layout::automatic) layout = actors > 4 ? Layout::list : Layout::apart;
  if (actors < 2) layout = Layout::together;

  auto html = draw::write_viewer_page(page_of(*files, options, layout));
  if (!html) return html.error();
  const Status status =
      write_output(context, context.output, [&](OutputFile& file) { return file.write(*html); });
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
                     {"keytimes", motion.keys.keytimes.size()}});
  }
  context.report.result["motions"] = std::move(shown);
  context.report.result["files"] = files->glbs.size();
  context.report.result["cameras"] = files->cameras.size();
  context.report.result["bytes"] = html->size();
  context.log(fmt::format("{}: {}, {:.1f} MB; open it in a browser", context.output,
                          actors == 1 ? "1 character" : fmt::format("{} characters", actors),
                          static_cast<double>(html->size()) / 1e6));
  return kExitDone;
}

}  // namespace krok::view
