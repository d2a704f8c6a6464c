#include "tools/krok/krok.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>

#include "core/file.h"
#include "core/text.h"
#include "tools/cli/command_line.h"
#include "tools/cli/report.h"
#include "tools/krok/program.h"

namespace krok::cli {

namespace {

std::string krok_help() {
  std::string text =
      "Usage: krok VERB [options] ...\n       krok help VERB\n\n"
      "Motion processing, from motion capture to character animation.\n\nVerbs:\n";
  for (const Command& command : commands()) {
    text += fmt::format("  {:<10}{}\n", command.verb, command.make_spec().summary);
  }
  text +=
      "\nOther:\n  help VERB           Print the help of a verb\n"
      "  completion SHELL    Print completion for bash, zsh or fish\n"
      "  git-setup           Let git show and merge motions\n";
  text +=
      "\nExamples:\n"
      "  krok import walk.bvh -o walk.anim\n      converts a capture to Krok's format\n"
      "  krok skin hero.model walk.anim -o walk.glb\n      an animated character\n"
      "  source <(krok completion bash)\n      completes verbs, options and their values\n"
      "\nExit codes:\n  those of the verb; 2 for an unknown verb\n";
  return text;
}

std::vector<std::string> verb_names() {
  std::vector<std::string> names;
  for (const Command& command : commands()) names.emplace_back(command.verb);
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
  return kExitTrouble;
}

std::string hint_for(const std::string& verb) {
  // Usual words for what a verb does by another name, or with an option.
  static constexpr std::pair<std::string_view, std::string_view> kWords[] = {
      {" convert conv ",
       "krok import reads captures and characters, krok export writes BVH, glTF and tables"},
      {" compare cmp test regress ", "krok diff compares files and folders"},
      {" sheet contact-sheet strip thumbnails ", "krok plot IN... --sheet OUT.png"},
      {" gait table events steps contacts stats statistics label strikes ",
       "krok keys FOLDER --table OUT.csv, or -o OUT.csv for events"},
      {" angles chart charts graph curves ",
       "krok plot IN... --show angles, or cycles for mean and deviation; krok export IN --what "
       "angles"},
      {" film movie video gif ", "krok render IN"},
      {" show open watch viewer play page ", "krok view IN"},
      {" check validate verify qa ", "krok lint IN..."},
      {" batch folder ", "most verbs take folders and patterns; see krok VERB --help"},
      {" trim cut crop clip slice split segment ",
       "krok edit IN --from TIME --to TIME -o OUT.anim"},
      {" resample downsample upsample decimate fps ", "krok edit IN --rate N -o OUT.anim"},
      {" filter smooth clean denoise despike ", "krok edit IN --filter auto -o OUT.anim"},
      {" mirror flip ", "krok edit IN --mirror -o OUT.anim"},
      {" loop cycle ", "krok edit IN --cycle auto -o OUT.anim, or --game-loop for an engine"},
      {" scale resize ", "krok edit IN --scale FACTOR or --height LENGTH -o OUT.anim"},
      {" rotate turn orient ", "krok edit IN --turn ANGLE or --re-orient -o OUT.anim"},
      {" move translate offset ", "krok edit IN --move X,Y,Z or --at-origin -o OUT.anim"},
      {" retime speed slow reverse ", "krok edit IN --playback-speed FACTOR -o OUT.anim"},
      {" plant unskate skate foot-lock footlock fix-feet ", "krok edit IN --plant -o OUT.anim"},
      {" rename name ",
       "krok skin MESH NAME=IN.anim -o OUT.glb names clips; files are named by -o"},
      {" pose snapshot ", "krok skin MESH IN --as pose --time 1s -o OUT.obj; krok plot --strip"},
      {" version ", "krok --version"},
      {" rig bake attach animate merge-clips character ",
       "krok skin hero.character IN... -o OUT.glb"},
      {" join concat append sequence layer merge combine ",
       "krok edit IN --append NEXT.anim, krok mix TIMELINE.json, or krok skin MESH IN... for clips "
       "in "
       "one file"},
      {" list tree inspect describe ls ", "krok info IN..."},
      {" optimize optimise compress quantize reduce shrink minify pack ",
       "krok skin IN.glb IN.glb -o OUT.glb --compress; krok export --reduce for motions"},
      {" reach look gaze eyes ", "krok ik IN --reach or --look-at"},
      {" talk speak speech lipsync visemes face ", "krok mix TIMELINE.json"},
      {" camera follow orbit ", "krok cam IN --follow hips"},
      {" remap map ", "krok retarget IN --onto hero.character"},
      {" fall push shove physics simulate dynamics ", "krok ragdoll IN"}};
  const auto is_word = [&](const auto& row) {
    return row.first.find(fmt::format(" {} ", verb)) != std::string_view::npos;
  };
  if (const auto row = std::ranges::find_if(kWords, is_word);
      !verb.empty() && row != std::end(kWords)) {
    return std::string(row->second);
  }
  const std::string near = verb.empty() ? "" : nearest_name(verb, verb_names());
  if (!near.empty()) return fmt::format("did you mean '{}'?", near);
  if (verb.find('/') != std::string::npos) return "see krok --help";  // a path
  std::string hint;
  for (const ToolOption& one : options_about(verb, "", options_of_all_tools(), 3)) {
    hint += fmt::format("{} has {}; ", one.tool, shown_option(one.facts));
  }
  return hint + "see krok --help";
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

Status write_report(const std::string& path, const std::string& text) {
  if (path == "-") {
    fmt::print("{}", text);
    return {};
  }
  if (!only_a_report_stands_at(path)) return {};
  auto file = OutputFile::create(path);
  if (!file) return file.error();
  if (Status status = file->write(text); !status) return status;
  return file->commit();
}

// A script that asked for a report gets it from here, too.
// "krok convert walk.bvh walk.npz" with the verb that writes such a file.
std::string hint_for_conversion(const std::string& in, const std::string& out) {
  const std::string ending = extension(out);
  const std::string words = fmt::format("{} -o {}", shown(in), shown(out));
  if (ending == ".anim") return "krok import " + words;
  for (const std::string_view one : {".bvh", ".glb", ".gltf", ".csv", ".npz", ".mot", ".sto"}) {
    if (ending != one) continue;
    const std::string from = extension(in);
    const bool mesh = ending.starts_with(".gl") && (from.starts_with(".gl") || from == ".fbx");
    return "krok export " + words +
           (mesh ? fmt::format("; with its mesh krok skin {} {}", shown(in), words) : "");
  }
  return {};
}

int refuse_verb(const std::string& verb, int argc, char** argv) {
  const std::string message =
      verb.empty() ? "no verb given" : fmt::format("unknown verb '{}'", verb);
  std::string hint = hint_for(verb);
  const bool option = verb.starts_with('-');  // "krok -i walk.bvh walk.glb"
  if (option) hint = "the verb comes first: krok VERB INPUT -o OUTPUT; see krok --help";
  if ((verb == "convert" || option) && argc > 3) {
    if (std::string wanted = hint_for_conversion(argv[2], argv[argc - 1]); !wanted.empty()) {
      hint = std::move(wanted);
    }
  }
  if (const std::string path = report_path(argc, argv); !path.empty()) {
    Report report;
    report.tool = "krok";
    report.version = version();
    report.issues.push_back(Error("usage", message, hint));
    const Status status = write_report(path, report.to_json().dump(2) + "\n");
    if (!status) fail(status.error().message, status.error().hint);
  }
  return fail(message, hint);
}

int complete(const std::string& shell) {
  if (shell != "bash" && shell != "zsh" && shell != "fish") {
    return fail(shell.empty() ? "no shell given" : fmt::format("unknown shell '{}'", shell),
                "krok completion bash, zsh or fish");
  }
  std::vector<CompletedVerb> verbs;
  for (const Command& command : commands()) {
    const ToolSpec spec = command.make_spec();
    verbs.push_back({std::string(command.verb), spec.summary,
                     CommandLine(spec, CommandLine::Form::single).options()});
  }
  const Shell chosen = shell == "bash" ? Shell::bash : shell == "zsh" ? Shell::zsh : Shell::fish;
  return print_and_end("krok", completion_script(chosen, verbs));
}

// A verb whose program is not this library's runs in its place.
int run_own_program(const std::string& verb, char** argv) {
  const std::string program = "krok-" + verb, beside = own_folder() + "/" + program;
  if (execv(beside.c_str(), argv) != 0) execvp(program.c_str(), argv);
  return fail(fmt::format("cannot run {}: {}", program, std::strerror(errno)),
              "it must be in the same folder as krok");
}

}  // namespace

int run_krok(int argc, char** argv) {
  std::vector<char*> arguments(argv + std::min(argc, 1), argv + argc);
  std::string help = "--help";
  const auto is = [&](std::size_t i, std::string_view word) {
    return i < arguments.size() && arguments[i] == word;
  };
  // `krok help VERB` and `krok VERB help` are `krok VERB --help`.
  if (is(0, "help") && arguments.size() > 1) std::swap(arguments[0], arguments[1]);
  if (arguments.size() == 2 && is(1, "help")) arguments[1] = help.data();
  const std::string verb = arguments.empty() ? "" : arguments[0];
  if (verb == "--help" || verb == "-h" || verb == "help") return print_and_end("krok", krok_help());
  if (verb == "--version")
    return print_and_end("krok", fmt::format("krok {}\n", version_of_build()));
  if (verb == "completion") return complete(arguments.size() > 1 ? arguments[1] : "");
  if (verb == "git-setup") return git_setup({arguments.begin() + 1, arguments.end()});
  const Command* command = find_command(verb);
  if (command == nullptr) return refuse_verb(verb, argc, argv);
  std::string name = "krok-" + verb;
  arguments[0] = name.data();
  arguments.push_back(nullptr);
  if (command->own_program) return run_own_program(verb, arguments.data());
  return run_program(verb.c_str(), static_cast<int>(arguments.size()) - 1, arguments.data());
}

}  // namespace krok::cli
