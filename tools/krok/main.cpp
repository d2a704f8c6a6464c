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

#include "tools/cli/tool.h"

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
    Verb{"plot", "plot charts of motions and tables"},
    Verb{"diff", "compare two files: differences and where they are"},
};

std::string help() {
  std::string text =
      "Usage: krok VERB [options] ...\n       krok VERB --help\n\n"
      "Motion processing, from motion capture to character animation.\n\nVerbs:\n";
  for (const Verb& verb : kVerbs) text += fmt::format("  {:<10}{}\n", verb.name, verb.does);
  text +=
      "\nExamples:\n"
      "  krok import walk.bvh -o walk.anim\n      converts a capture to Krok's format\n"
      "  krok skin hero.model walk.anim -o walk.glb --as rig\n      an animated character\n"
      "\nExit codes:\n  those of the verb; 2 for an unknown verb\n";
  return text;
}

bool is_verb(std::string_view name) {
  for (const Verb& verb : kVerbs) {
    if (verb.name == name) return true;
  }
  return false;
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
  if (!is_verb(verb)) {
    fmt::print(stderr, "krok: error: {} [usage]\n  hint: see krok --help\n",
               verb.empty() ? "no verb given" : fmt::format("unknown verb '{}'", verb));
    return krok::cli::kExitTrouble;
  }
  const std::string program = "krok-" + verb;
  std::error_code error;
  const auto self = std::filesystem::read_symlink("/proc/self/exe", error);
  std::vector<char*> arguments(argv + 1, argv + argc);
  arguments.push_back(nullptr);
  if (!error) {
    const std::string beside = (self.parent_path() / program).string();
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
