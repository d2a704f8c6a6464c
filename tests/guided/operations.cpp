#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "core/file.h"
#include "formats/anim/anim.h"
#include "formats/bvh/bvh_reader.h"
#include "formats/csv/table.h"
#include "formats/gltf/gltf_reader.h"
#include "guided/targets.h"
#include "support/human_skeleton.h"
#include "tools/cli/tool.h"
#include "tools/krok-edit/options.h"
#include "tools/krok-export/options.h"
#include "tools/krok-info/options.h"
#include "tools/krok-keys/options.h"
#include "tools/krok-plot/options.h"

namespace krok::guided {

namespace {

namespace fs = std::filesystem;

// Takes choices from the input; zeros once it is used up.
class Choices {
 public:
  explicit Choices(std::span<const std::byte> input) : input_(input) {}

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
    return static_cast<unsigned>(input_[at_++]);
  }

  std::span<const std::byte> input_;
  std::size_t at_ = 0;
};

Skeleton chosen_skeleton(Choices& choices) {
  if (choices.one_in(2)) return test::human_skeleton();
  Skeleton skeleton;
  const std::size_t joints = 1 + choices.below(6);
  for (std::size_t j = 0; j < joints; ++j) {
    Transform transform;
    transform.position = Vec3(choices.number(), choices.number(), choices.number());
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
        const Quat turned(choices.number(), choices.number(), choices.number(), choices.number());
        if (turned.norm() > 1e-30 && turned.norm() < 1e30) joint.orientation = turned.normalized();
      }
    }
    clip.set_pose(f, pose);
  }
  return clip;
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
                                       "--order=" + value(choices)});
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
        options.push_back("--speed=" + value(choices));
        break;
      case 11:
        options.push_back("--resample=" + value(choices));
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
        options.push_back(fmt::format("--move={}m,{}m,{}m", choices.number(), choices.number(),
                                      choices.number()));
        break;
      default:
        options.push_back(choices.one_in(2) ? "--ground" : "--plant");
        break;
    }
  }
  return options;
}

std::string text_of(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

std::span<const std::byte> bytes_of(const std::string& text) {
  return std::as_bytes(std::span(text));
}

// The program's folder for files, removed with it.
class Folder {
 public:
  Folder() : path_(fs::temp_directory_path() / fmt::format("krok-targets-{}", getpid())) {
    fs::create_directories(path_);
  }
  ~Folder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  std::string file(const std::string& name) const { return (path_ / name).string(); }
  // An earlier input's file must not be taken for a result.
  void clear() const {
    for (const auto& entry : fs::directory_iterator(path_)) fs::remove_all(entry.path());
  }

 private:
  fs::path path_;
};

// Returns whether the tool has done its work.
bool run_tool(const cli::MakeToolSpec& make_spec, std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), "tool");
  arguments.insert(arguments.end(), {"--jobs=1", "--quiet", "--progress=none"});
  std::vector<char*> argv;
  for (std::string& argument : arguments) argv.push_back(argument.data());
  const int code = cli::run_tool(make_spec, static_cast<int>(argv.size()), argv.data());
  if (code != cli::kExitDone && code != cli::kExitNo && code != cli::kExitTrouble) {
    fail(fmt::format("exit code {}", code));
  }
  return code != cli::kExitTrouble;
}

void judge_report(const std::string& path) {
  if (!nlohmann::json::accept(text_of(path))) fail("a report that is not JSON");
}

void judge_table(const std::string& text) {
  const auto table = csv::Table::read(text, "out.csv");
  if (!table) return;  // without frames, a header alone
  for (std::size_t c = 0; c < table->columns().size(); ++c) {
    if (table->numeric()[c] == 0) continue;
    const std::size_t columns[] = {c};
    const auto numbers = table->numbers(columns);
    if (!numbers) fail("a table that does not read back: " + numbers.error().message);
    if (!std::ranges::all_of(numbers->front(), [](double x) { return std::isfinite(x); })) {
      fail("a table with numbers that are not finite");
    }
  }
}

void export_and_judge(Choices& choices, const Folder& folder, const std::string& motion) {
  const std::string bvh = folder.file("out.bvh"), glb = folder.file("out.glb");
  const std::string csv = folder.file("out.csv");
  switch (choices.below(4)) {
    case 0: {
      if (!run_tool(cli::exporting::make_spec,
                    {motion, "-o", bvh, fmt::format("--digits={}", 1 + choices.below(15))})) {
        return;
      }
      const auto back = bvh::read(text_of(bvh), "out.bvh");
      if (!back) fail("BVH that does not read back: " + back.error().message);
      break;
    }
    case 1:
    case 2: {
      std::vector<std::string> arguments = {motion, "-o", glb};
      if (choices.one_in(2)) arguments.push_back("--reduce=" + value(choices, "mm"));
      if (choices.one_in(2)) arguments.push_back("--no-bones");
      if (!run_tool(cli::exporting::make_spec, arguments)) return;
      const std::string written = text_of(glb);
      const auto back = gltf::read(bytes_of(written));
      if (!back) fail("glTF that does not read back: " + back.error().message);
      break;
    }
    default:
      if (run_tool(cli::exporting::make_spec, {motion, "-o", csv})) judge_table(text_of(csv));
      break;
  }
}

void plot_and_judge(Choices& choices, const Folder& folder, const std::string& motion) {
  const std::string svg = folder.file("out.svg");
  std::vector<std::string> arguments = {motion, "-o", svg};
  if (choices.one_in(2)) arguments.push_back("--joint=*");
  if (choices.one_in(3)) arguments.push_back("--from=" + value(choices, "s"));
  if (choices.one_in(3)) arguments.push_back("--to=" + value(choices, "s"));
  if (choices.one_in(3)) arguments.push_back("--log-y");
  if (!run_tool(cli::plot::make_spec, arguments)) return;
  const std::string drawn = text_of(svg);
  for (const char* wrong :
       {"\"nan", "\"inf", "\"-inf", " nan", " inf", ",nan", ",inf", ">inf", ">nan"}) {
    if (drawn.find(wrong) != std::string::npos) fail("a chart with numbers that are not finite");
  }
}

}  // namespace

void run_operations(std::span<const std::byte> input) {
  static const Folder folder;
  folder.clear();
  Choices choices(input);
  const Clip clip = chosen_clip(choices);
  if (!check(clip)) return;
  std::string motion = folder.file("in.anim");
  auto file = OutputFile::create(motion, {.stored_later = true});
  if (!file || !anim::write(clip, {}, *file) || !file->commit()) return;

  const std::string report = folder.file("report.json"), edited = folder.file("edited.anim");
  std::vector<std::string> arguments = {motion, "-o", edited, "--json=" + report};
  for (std::string& option : edit_options(choices, motion)) arguments.push_back(std::move(option));
  if (run_tool(cli::edit::make_spec, arguments)) {
    judge_report(report);
    const std::string written = text_of(edited);
    const auto result = anim::read(bytes_of(written));
    if (!result) fail("a motion that does not read back: " + result.error().message);
    if (const Status status = check(*result); !status) {
      fail("a motion that does not hold: " + status.error().message);
    }
    motion = edited;
  }
  switch (choices.below(4)) {
    case 0:
      if (run_tool(cli::keys::make_spec,
                   {motion, "-o", folder.file("out.keys.json"), "--json=" + report})) {
        judge_report(report);
      }
      break;
    case 1:
      plot_and_judge(choices, folder, motion);
      break;
    case 2:
      if (run_tool(cli::info::make_spec, {motion, "--json=" + report})) judge_report(report);
      break;
    default:
      export_and_judge(choices, folder, motion);
      break;
  }
}

}  // namespace krok::guided
