#include <memory>

#include "tools/common/one_of.h"
#include "tools/common/option_kinds.h"
#include "tools/krok-skin/skin.h"

namespace {

void declare(CLI::App& app, krok::SkinOptions& options) {
  using krok::SkinAs;
  using krok::SkinMethod;
  app.add_option("model", options.model, "The skinned mesh")->type_name("IN.model")->required();
  app.add_option("motion", options.motion, "The motion")->type_name("IN.anim")->required();
  app.add_option("--as", options.as,
                 "What to write. clip: the motion baked, a morph target a frame. pose: one mesh. "
                 "rig: joints, weights and the animation, for the viewer's own skinning. frames: "
                 "one file a frame, OUT_0000.glb, OUT_0001.glb, ... for -o OUT.glb")
      ->type_name("WHAT")
      ->transform(krok::one_of<SkinAs>({{"clip", SkinAs::clip},
                                        {"pose", SkinAs::pose},
                                        {"rig", SkinAs::rig},
                                        {"frames", SkinAs::frames}}))
      ->default_str("clip");
  app.add_option("--time", options.time, "For --as pose: when, as 1.5s, 250ms or 120f")
      ->type_name("T")
      ->default_str("0");
  app.add_option("--from", options.from,
                 "Where the part to write begins, as for --time; not for pose")
      ->type_name("T");
  app.add_option("--to", options.to, "Where it ends, that frame included")->type_name("T");
  krok::add_whole(app, "--every", options.every, "Take every Nth frame only", 1, 1000000)
      ->default_str("1");
  app.add_option("--method", options.method,
                 "How vertices follow the joints. linear: linear blend, as viewers do it; thins "
                 "out where a joint twists. dual-quaternion: keeps the volume there. rigid: each "
                 "its strongest joint alone")
      ->type_name("METHOD")
      ->transform(krok::one_of<SkinMethod>({{"linear", SkinMethod::linear},
                                            {"dual-quaternion", SkinMethod::dual_quaternion},
                                            {"rigid", SkinMethod::rigid}}))
      ->default_str("linear");
}

krok::ToolSpec make_spec() {
  const auto options = std::make_shared<krok::SkinOptions>();
  krok::ToolSpec spec;
  spec.name = "krok-skin";
  spec.summary = "Moves a mesh by a skeleton's motion and writes it as glTF";
  spec.inputs = "IN.model IN.anim";
  spec.examples = {
      {"krok-skin body.model walk.anim -o walk.glb", "the motion baked, for viewers without skins"},
      {"krok-skin body.model walk.anim --as rig -o walk.glb", "a rig for a game engine or Blender"},
      {"krok-skin body.model walk.anim --as pose --time 1.5s -o pose.glb", "one moment"}};
  spec.batch = {{".anim"}, krok::always(".glb")};
  spec.declare = [options](CLI::App& app) { declare(app, *options); };
  spec.check = [options] { return krok::check(*options); };
  spec.run = [options](krok::ToolContext& context) { return krok::run_skin(*options, context); };
  return spec;
}

}  // namespace

int main(int argc, char** argv) {
  return krok::run_tool(make_spec, argc, argv);
}
