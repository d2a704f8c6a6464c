#include <fmt/format.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "core/file.h"
#include "core/nearest_name.h"
#include "tools/cli/report.h"
#include "tools/cli/tool.h"
#include "tools/krok/completion.h"

// krok VERB ... runs krok-VERB ... from this program's folder, or else from the PATH.

namespace {

struct Verb {
  std::string_view name;
  std::string_view does;
};

constexpr std::array kVerbs = {
    Verb{"import", "import captures and characters"},
    Verb{"export", "export .anim to BVH, glTF/GLB or CSV of world positions"},
    Verb{"info", "print the contents of a file"},
    Verb{"body", "generate a smooth skinned body for any skeleton"},
    Verb{"skin", "combine a model and a motion into glTF: a rig, a baked clip, a pose"},
    Verb{"morph", "pack, unpack and animate morph targets; key-frame meshes"},
    Verb{"retarget", "retarget a motion to another skeleton"},
    Verb{"ik", "bring joints of a motion to goals by inverse kinematics"},
    Verb{"ragdoll", "let a motion's character fall by physics"},
    Verb{"edit", "cut, clean, mirror, loop, join, scale and place motions"},
    Verb{"keys", "detect, print and edit foot contacts and gait keytimes"},
    Verb{"blend", "blend motions by weights and keytimes"},
    Verb{"mix", "mix a timeline of motions, transitions and layers"},
    Verb{"cam", "create cameras: keyframed, following, orbiting, static"},
    Verb{"fit", "fit a step library to example motions"},
    Verb{"synth", "synthesise motions from a step library for given parameters"},
    Verb{"walk", "walk a character along footprints, a way or to goals, on any ground"},
    Verb{"view", "create a web page that plays motions"},
    Verb{"render", "render films: mp4, gif, webp or PNG frames"},
    Verb{"plot", "plot charts of motions and tables"},
    Verb{"diff", "compare two files: differences and where they are"},
};

std::string help() {
  std::string text =
      "Usage: krok VERB [options] ...\n       krok VERB --help\n\n"
      "Motion processing, from motion capture to character animation.\n\nVerbs:\n";
  for (const Verb& verb : kVerbs) text += fmt::format("  {:<10}{}\n", verb.name, verb.does);
  text += "\nOther:\n  completion SHELL    print completion for bash, zsh or fish\n";
  text +=
      "\nExamples:\n"
      "  krok import walk.bvh -o walk.anim\n      converts a capture to Krok's format\n"
      "  krok skin hero.model walk.anim -o walk.glb\n      an animated character\n"
      "  source <(krok completion bash)\n      completes verbs, options and their values\n"
      "\nExit codes:\n  those of the verb; 2 for an unknown verb\n";
  return text;
}

bool is_verb(std::string_view name) {
  for (const Verb& verb : kVerbs) {
    if (verb.name == name) return true;
  }
  return false;
}

std::vector<std::string> verb_names() {
  std::vector<std::string> names;
  for (const Verb& verb : kVerbs) names.emplace_back(verb.name);
  return names;
}

// The folder of this program; empty if it is not known.
std::string own_folder() {
  std::error_code error;
  const auto self = std::filesystem::read_symlink("/proc/self/exe", error);
  return error ? std::string() : self.parent_path().string();
}

int fail(const std::string& message, const std::string& hint) {
  fmt::print(stderr, "krok: error: {} [usage]\n  hint: {}\n", message, hint);
  return krok::cli::kExitTrouble;
}

std::string hint_for(const std::string& verb) {
  // A usual word for what two verbs do.
  if (verb == "convert" || verb == "conv") {
    return "krok import reads captures and characters, krok export writes BVH, glTF and tables";
  }
  const std::string near = verb.empty() ? "" : krok::nearest_name(verb, verb_names());
  return near.empty() ? "see krok --help" : fmt::format("did you mean '{}'?", near);
}

// Where --json asks for a report: a path, "-", or empty.
std::string report_path(int argc, char** argv) {
  constexpr std::string_view kOption = "--json";
  for (int i = 1; i < argc; ++i) {
    const std::string_view one = argv[i];
    if (one == kOption) return "-";
    if (one.starts_with("--json=")) return std::string(one.substr(kOption.size() + 1));
  }
  return {};
}

krok::Status write_report(const std::string& path, const std::string& text) {
  if (path == "-") {
    fmt::print("{}", text);
    return {};
  }
  if (!krok::cli::only_a_report_stands_at(path)) return {};
  auto file = krok::OutputFile::create(path);
  if (!file) return file.error();
  if (krok::Status status = file->write(text); !status) return status;
  return file->commit();
}

// A script that asked for a report gets it from here, too.
int refuse_verb(const std::string& verb, int argc, char** argv) {
  const std::string message =
      verb.empty() ? "no verb given" : fmt::format("unknown verb '{}'", verb);
  const std::string hint = hint_for(verb);
  if (const std::string path = report_path(argc, argv); !path.empty()) {
    krok::cli::Report report;
    report.tool = "krok";
    report.version = krok::cli::version();
    report.issues.push_back(krok::Error("usage", message, hint));
    const krok::Status status = write_report(path, report.to_json().dump(2) + "\n");
    if (!status) fail(status.error().message, status.error().hint);
  }
  return fail(message, hint);
}

// What a program prints on standard output; empty if it fails.
std::string output_of(const std::string& program, const char* argument) {
  std::string command = "'";
  for (const char c : program) command += c == '\'' ? std::string("'\\''") : std::string(1, c);
  command += fmt::format("' {} 2>/dev/null", argument);
  FILE* pipe = popen(command.c_str(), "r");
  if (pipe == nullptr) return {};
  std::string text;
  std::array<char, 4096> room{};
  for (std::size_t count; (count = std::fread(room.data(), 1, room.size(), pipe)) > 0;) {
    text.append(room.data(), count);
  }
  return pclose(pipe) == 0 ? text : std::string();
}

int complete(const std::string& shell) {
  using krok::cli::Shell;
  if (shell != "bash" && shell != "zsh" && shell != "fish") {
    return fail(shell.empty() ? "no shell given" : fmt::format("unknown shell '{}'", shell),
                "krok completion bash, zsh or fish");
  }
  std::vector<krok::cli::CompletedVerb> verbs;
  for (const Verb& verb : kVerbs) {
    const std::string program = fmt::format("{}/krok-{}", own_folder(), verb.name);
    std::string options = output_of(program, "--list-options");
    // Tools may be installed in part.
    if (!options.empty()) {
      verbs.push_back({std::string(verb.name), std::string(verb.does), std::move(options)});
    }
  }
  const Shell chosen = shell == "bash" ? Shell::bash : shell == "zsh" ? Shell::zsh : Shell::fish;
  return krok::cli::print_and_end("krok", krok::cli::completion_script(chosen, verbs));
}

}  // namespace

int main(int argc, char** argv) {
  const std::string verb = argc > 1 ? argv[1] : "";
  if (verb == "--help" || verb == "-h" || verb == "help") {
    return krok::cli::print_and_end("krok", help());
  }
  if (verb == "--version") {
    return krok::cli::print_and_end("krok", fmt::format("krok {}\n", krok::cli::version()));
  }
  if (verb == "completion") return complete(argc > 2 ? argv[2] : "");
  if (!is_verb(verb)) {
    return refuse_verb(verb, argc, argv);
  }
  const std::string program = "krok-" + verb;
  const std::string folder = own_folder();
  std::vector<char*> arguments(argv + 1, argv + argc);
  arguments.push_back(nullptr);
  if (!folder.empty()) {
    const std::string beside = folder + "/" + program;
    std::string name = program;
    arguments[0] = name.data();
    execv(beside.c_str(), arguments.data());
  }
  execvp(program.c_str(), arguments.data());
  fmt::print(stderr,
             "krok: error: cannot run {}: {} [usage]\n  hint: the tools must be in the same folder "
             "as krok\n",
             program, std::strerror(errno));
  return krok::cli::kExitTrouble;
}
