#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include "core/file.h"
#include "formats/anim/anim.h"
#include "formats/bvh/bvh_reader.h"
#include "guided/targets.h"
#include "guided/tool_runs.h"
#include "support/human_skeleton.h"
#include "tools/krok-blend/options.h"
#include "tools/krok-body/options.h"
#include "tools/krok-cam/options.h"
#include "tools/krok-diff/options.h"
#include "tools/krok-edit/options.h"
#include "tools/krok-export/options.h"
#include "tools/krok-ik/options.h"
#include "tools/krok-info/options.h"
#include "tools/krok-keys/options.h"
#include "tools/krok-plot/options.h"
#include "tools/krok-retarget/options.h"
#include "tools/krok-skin/options.h"
#include "tools/krok-view/options.h"

namespace krok::guided {

namespace {

// Takes choices from the input, from its front or from its end backwards; zeros once it is used up.
class Choices {
 public:
  enum class From : unsigned char { front, back };
  Choices(std::span<const std::byte> input, From from) : input_(input), from_(from) {}

  std::size_t below(std::size_t count) { return byte() % count; }
  bool one_in(std::size_t count) { return below(count) == 0; }

  double number() {
    constexpr double kNumbers[] = {0,     1,      0.5,          2,       3,    10,   30,     45,
                                   90,    100,    180,          360,     1e-3, 1e-6, 1e-12,  1e-30,
                                   1e-44, 1e-158, 1e-300,       5e-324,  1e3,  1e4,  1e5,    1e6,
                                   1e7,   1e9,    2147483648.0, 1e15,    1e19, 1e30, 3.4e38, 3.5e38,
                                   1e150, 1e300,  1.7e308,      0.999999};
    const std::size_t choice = below(2 * std::size(kNumbers) + 64);
    if (choice < 2 * std::size(kNumbers)) {
      return choice % 2 == 0 ? kNumbers[choice / 2] : -kNumbers[choice / 2];
    }
    return (static_cast<double>(byte()) - 128) / 16;
  }

 private:
  unsigned byte() {
    if (at_ == input_.size()) return 0;
    const std::size_t place = from_ == From::front ? at_ : input_.size() - 1 - at_;
    ++at_;
    return static_cast<unsigned>(input_[place]);
  }

  std::span<const std::byte> input_;
  From from_;
  std::size_t at_ = 0;
};

Skeleton chosen_skeleton(Choices& choices) {
  if (choices.one_in(2)) return test::human_skeleton();
  Skeleton skeleton;
  const std::size_t joints = 1 + choices.below(6);
  for (std::size_t j = 0; j < joints; ++j) {
    Transform transform;
    transform.position = Vec3{choices.number(), choices.number(), choices.number()};
    const int parent = j == 0 ? -1 : static_cast<int>(choices.below(j));
    skeleton.add(fmt::format("{}{}", choices.one_in(2) ? "LeftFoot" : "joint", j), parent,
                 transform, j > 0 && choices.one_in(4));
  }
  return skeleton;
}

// A clip that may hold or not.
Clip chosen_clip(Choices& choices) {
  constexpr double kRates[] = {30, 120, 24, 1, 0.001, 0.01, 59.94, 1000, 1e5};
  Clip clip;
  clip.skeleton = chosen_skeleton(choices);
  clip.rate = choices.one_in(8) ? choices.number() : kRates[choices.below(std::size(kRates))];
  clip.resize(static_cast<int>(choices.below(4) == 0 ? choices.below(3) : choices.below(64)));
  std::vector<Transform> pose = clip.skeleton.reference;
  for (int f = 0; f < clip.frame_count(); ++f) {
    const std::size_t changes = choices.below(4);
    for (std::size_t k = 0; k < changes; ++k) {
      Transform& joint = pose[choices.below(pose.size())];
      if (choices.one_in(2)) {
        joint.position[static_cast<int>(choices.below(3))] = choices.number();
      } else {
        const Quat turned{choices.number(), choices.number(), choices.number(), choices.number()};
        if (turned.norm() > 1e-30 && turned.norm() < 1e30) joint.orientation = turned.normalized();
      }
    }
    clip.set_pose(f, pose);
  }
  return clip;
}

std::string place(Choices& choices) {
  const double numbers[] = {choices.number(), choices.number(), choices.number()};
  return fmt::format("{}m,{}m,{}m", numbers[0], numbers[1], numbers[2]);
}

std::string value(Choices& choices, const char* unit = "") {
  return fmt::format("{}{}", choices.number(), unit);
}

std::vector<std::string> edit_options(Choices& choices, const std::string& input) {
  std::vector<std::string> options;
  const std::size_t count = choices.below(5);
  for (std::size_t k = 0; k < count; ++k) {
    switch (choices.below(24)) {
      case 0:
        options.push_back("--spikes");
        break;
      case 1:
        options.insert(options.end(), {"--spikes", "--spike-threshold=" + value(choices)});
        break;
      case 2:
        options.push_back("--filter=butterworth");
        break;
      case 3:
        options.insert(options.end(), {"--filter=butterworth", "--cutoff=" + value(choices, "Hz")});
        break;
      case 4:
        options.push_back("--filter=savgol");
        break;
      case 5:
        options.insert(options.end(), {"--filter=savgol", "--window=" + value(choices),
                                       "--filter-order=" + value(choices)});
        break;
      case 6:
        options.push_back("--from=" + value(choices, "s"));
        break;
      case 7:
        options.push_back("--to=" + value(choices, "s"));
        break;
      case 8:
        options.push_back("--from=" + value(choices, "f"));
        break;
      case 9:
        options.push_back("--mirror");
        break;
      case 10:
        options.push_back("--playback-speed=" + value(choices));
        break;
      case 11:
        options.push_back("--rate=" + value(choices));
        break;
      case 12:
        options.push_back("--append=" + input);
        break;
      case 13:
        options.insert(options.end(), {"--append=" + input, "--blend=" + value(choices, "s")});
        break;
      case 14:
        options.push_back("--loop");
        break;
      case 15:
        options.insert(options.end(), {"--loop", "--loop-blend=" + value(choices, "s")});
        break;
      case 16:
        options.insert(options.end(), {"--loop", "--loop-end=open",
                                       fmt::format("--rounds={}", choices.below(50))});
        break;
      case 17:
        options.push_back(choices.one_in(2) ? "--in-place" : "--treadmill");
        break;
      case 18:
        options.push_back("--scale=" + value(choices));
        break;
      case 19:
        options.push_back("--height=" + value(choices, "m"));
        break;
      case 20:
        options.push_back("--heading=" + value(choices, "deg"));
        break;
      case 21:
        options.push_back("--turn=" + value(choices, "deg"));
        break;
      case 22:
        options.push_back("--move=" + place(choices));
        break;
      default:
        options.push_back(choices.one_in(2) ? "--on-ground" : "--plant");
        break;
    }
  }
  return options;
}

// A number for an option, or nothing.
void maybe(Choices& choices, std::vector<std::string>& options, const char* name,
           const char* unit = "") {
  if (choices.one_in(3)) options.push_back(fmt::format("{}={}{}", name, choices.number(), unit));
}

// What a motion came from, and the motion itself after some edits.
struct Motions {
  std::string given, edited;
  std::vector<std::string> joints;
};

using Options = std::vector<std::string>;
using Use = void (*)(Choices& choices, const Motions& motions, Options options);

void export_bvh(Choices& choices, const Motions& motions, Options options) {
  const std::string out = scratch("out.bvh");
  options.insert(options.end(),
                 {motions.edited, "-o", out, fmt::format("--digits={}", 1 + choices.below(15))});
  if (!run_tool(cli::exporting::make_spec, options)) return;
  const auto back = bvh::read(content_of(out), "out.bvh");
  if (!back) fail("BVH that does not read back: " + back.error().message);
}

void export_gltf(Choices& choices, const Motions& motions, Options options) {
  const std::string out = scratch("out.glb");
  options.insert(options.end(), {motions.edited, "-o", out});
  if (choices.one_in(2)) options.push_back("--reduce=" + value(choices, "mm"));
  if (choices.one_in(2)) options.push_back("--no-bones");
  if (run_tool(cli::exporting::make_spec, options)) judge_gltf(out);
}

void export_table(Choices& /*choices*/, const Motions& motions, Options options) {
  const std::string out = scratch("out.csv");
  options.insert(options.end(), {motions.edited, "-o", out});
  if (run_tool(cli::exporting::make_spec, options)) judge_table(out);
}

void plot(Choices& choices, const Motions& motions, Options options) {
  const std::string svg = scratch("out.svg");
  options.insert(options.end(), {motions.edited, "-o", svg});
  if (choices.one_in(2)) options.push_back("--joint=*");
  if (choices.one_in(3)) options.push_back("--log-y");
  maybe(choices, options, "--from", "s");
  maybe(choices, options, "--to", "s");
  if (run_tool(cli::plot::make_spec, options)) judge_chart(svg);
}

void keys(Choices& /*choices*/, const Motions& motions, Options options) {
  options.insert(options.end(), {motions.edited, "-o", scratch("out.keys.json")});
  run_tool(cli::keys::make_spec, options);
}

void info(Choices& /*choices*/, const Motions& motions, Options options) {
  options.push_back(motions.edited);
  run_tool(cli::info::make_spec, options);
}

void blend(Choices& choices, const Motions& motions, Options options) {
  constexpr const char* kWarps[] = {"pchip", "linear", "dtw"};
  constexpr const char* kSpaces[] = {"auto", "root", "stance", "none"};
  const double weight = choices.number();
  const std::string out = scratch("out.anim"), warp = scratch("warp.csv");
  options.insert(options.end(),
                 {fmt::format("{}:{}", motions.given, weight),
                  fmt::format("{}:{}", motions.edited, choices.one_in(2) ? 1 - weight : weight),
                  "-o", out, "--save-warp=" + warp, "--modifier",
                  std::string("--warp=") + kWarps[choices.below(std::size(kWarps))],
                  std::string("--match-root=") + kSpaces[choices.below(std::size(kSpaces))]});
  if (choices.one_in(2)) options.push_back("--contacts=none");
  maybe(choices, options, "--rate");
  if (!run_tool(cli::blend::make_spec, options)) return;
  judge_motion(out);
  judge_table(warp);
}

void retarget(Choices& choices, const Motions& motions, Options options) {
  const std::string out = scratch("out.anim");
  const bool forth = choices.one_in(2);
  options.insert(options.end(), {forth ? motions.edited : motions.given, "--onto",
                                 forth ? motions.given : motions.edited, "-o", out});
  if (choices.one_in(2)) options.push_back("--feet=free");
  maybe(choices, options, "--scale");
  if (run_tool(cli::retarget::make_spec, options)) judge_motion(out);
}

void ik(Choices& choices, const Motions& motions, Options options) {
  constexpr const char* kMethods[] = {"least-squares", "ccd", "two-bone"};
  const std::string out = scratch("out.anim");
  std::string reach = "--reach=" + motions.joints[choices.below(motions.joints.size())];
  reach += "=" + place(choices);
  reach += "@" + value(choices, "s");
  options.insert(options.end(),
                 {motions.edited, "-o", out, reach,
                  std::string("--solver=") + kMethods[choices.below(std::size(kMethods))]});
  if (choices.one_in(3)) options.push_back("--root-moves");
  if (choices.one_in(3)) options.push_back("--limits=auto");
  if (choices.one_in(3)) options.push_back("--plant");
  maybe(choices, options, "--fade", "s");
  maybe(choices, options, "--tolerance", "mm");
  maybe(choices, options, "--limit-margin", "deg");
  if (run_tool(cli::ik::make_spec, options)) judge_motion(out);
}

void body(Choices& choices, const Motions& motions, Options options) {
  const std::string model = scratch("out.model"), baked = scratch("out.glb");
  options.insert(options.end(), {motions.edited, "--detail=low", "-o", model});
  if (choices.one_in(2)) options.push_back(fmt::format("--pose={}", choices.below(4)));
  if (!run_tool(cli::body::make_spec, options)) return;
  judge_model(model);
  constexpr const char* kKinds[] = {"rig", "pose", "clip"};
  constexpr const char* kMethods[] = {"linear", "dual-quaternion", "spherical", "rigid"};
  std::vector<std::string> skinning = {
      model,
      motions.edited,
      "-o",
      baked,
      "--every=8",
      std::string("--as=") + kKinds[choices.below(std::size(kKinds))],
      std::string("--method=") + kMethods[choices.below(std::size(kMethods))]};
  if (run_tool(cli::skin::make_spec, skinning)) judge_gltf(baked);
}

void view(Choices& choices, const Motions& motions, Options options) {
  options.insert(options.end(), {motions.edited, motions.given, "-o", scratch("out.html"),
                                 choices.one_in(4) ? "--body=low" : "--body=none"});
  run_tool(cli::view::make_spec, options);
}

void film(Choices& choices, const Motions& motions, Options options) {
  const std::string out = scratch("out.glb");
  options.insert(options.end(), {motions.edited, "-o", out});
  options.push_back(choices.one_in(3)   ? "--still"
                    : choices.one_in(2) ? "--orbit=" + value(choices, "s")
                                        : "--follow=" + motions.joints[0]);
  maybe(choices, options, "--distance", "m");
  maybe(choices, options, "--fov", "deg");
  maybe(choices, options, "--smooth", "s");
  maybe(choices, options, "--dead-zone", "m");
  maybe(choices, options, "--margin");
  if (run_tool(cli::cam::make_spec, options)) judge_gltf(out);
}

void compare(Choices& choices, const Motions& motions, Options options) {
  options.insert(options.end(), {motions.given, motions.edited});
  maybe(choices, options, "--tolerance", "mm");
  run_tool(cli::diff::make_spec, options);
}

constexpr Use kUses[] = {export_bvh, export_gltf, export_table, plot, keys, info,   blend,
                         retarget,   ik,          body,         view, film, compare};

}  // namespace

void run_operations(std::span<const std::byte> input) {
  clear_scratch();
  // What is done comes first and the motion from the other end, so that each changes by itself.
  Choices choices(input, Choices::From::front), shape(input, Choices::From::back);
  const Use use = kUses[choices.below(std::size(kUses))];
  const Clip clip = chosen_clip(shape);
  if (!check(clip)) return;
  Motions motions{scratch("in.anim"), scratch("in.anim"), clip.skeleton.names};
  auto file = OutputFile::create(motions.given, {.stored_later = true});
  if (!file || !anim::write(clip, {}, *file) || !file->commit()) return;

  const std::string report = scratch("report.json"), edited = scratch("edited.anim");
  std::vector<std::string> arguments = {motions.given, "-o", edited, "--json=" + report};
  for (std::string& option : edit_options(choices, motions.given)) {
    arguments.push_back(std::move(option));
  }
  if (run_tool(cli::edit::make_spec, arguments)) {
    judge_report(report);
    judge_motion(edited);
    motions.edited = edited;
  }
  std::filesystem::remove(report);
  use(choices, motions, {"--json=" + report});
  if (std::filesystem::exists(report)) judge_report(report);
}

}  // namespace krok::guided
