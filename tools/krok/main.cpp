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

#include "tools/common/tool.h"

// krok VERB ... runs krok-VERB ..., the one beside this program or else the one on the PATH.

namespace {

struct Verb {
  std::string_view name;
  std::string_view does;
};

constexpr std::array kVerbs = {
    Verb{"import", "captures to .anim and .model"},
    Verb{"export", ".anim to BVH, glTF/GLB or CSV of world positions"},
    Verb{"info", "what is in a file"},
    Verb{"body", "a smooth skinned body for any skeleton"},
    Verb{"skin", "a model and a motion to glTF: a rig, a baked clip, a pose"},
    Verb{"morph", "morph targets: packed, taken out, over time; key-frame meshes"},
    Verb{"retarget", "a motion on another skeleton"},
    Verb{"edit", "cut, clean, mirror, loop, join, scale and place a motion"},
    Verb{"keys", "contacts of the feet and keytimes of a gait, found, shown, edited"},
    Verb{"blend", "the motion between motions, by weights and keytimes"},
    Verb{"mix", "a timeline: motions one after the other, changes between them, layers"},
    Verb{"cam", "cameras: from keys, following, orbiting, still"},
    Verb{"fit", "a step library from example motions"},
    Verb{"synth", "the motion for given parameters, from a step library"},
    Verb{"view", "a page that plays motions in a browser"},
    Verb{"plot", "charts of motions and tables"},
    Verb{"diff", "how far two files are apart, and where"},
};

std::string help() {
  std::string text =
      "Usage: krok VERB [options] ...\n       krok VERB --help\n\n"
      "Motion captures to character animation, one verb a job.\n\nVerbs:\n";
  for (const Verb& verb : kVerbs) text += fmt::format("  {:<10}{}\n", verb.name, verb.does);
  text +=
      "\nExamples:\n"
      "  krok import walk.bvh -o walk.anim\n      a capture to Krok's own format\n"
      "  krok skin hero.model walk.anim -o walk.glb --as rig\n      a character that moves\n"
      "\nExit codes:\n  those of the verb; 2 for a verb that does not exist\n";
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
    return krok::print_and_end("krok", help());
  }
  if (verb == "--version") {
    return krok::print_and_end("krok", fmt::format("krok {}\n", krok::version()));
  }
  if (!is_verb(verb)) {
    fmt::print(stderr, "krok: error: {} [usage]\n  hint: see krok --help\n",
               verb.empty() ? "no verb given" : fmt::format("'{}' is no verb of krok", verb));
    return krok::kExitTrouble;
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
             "krok: error: {} cannot be run: {} [usage]\n  hint: the tools belong into the folder "
             "of krok\n",
             program, std::strerror(errno));
  return krok::kExitTrouble;
}
