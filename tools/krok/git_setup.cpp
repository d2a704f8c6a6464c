#include "tools/krok/krok.h"

#include <fmt/format.h>

#include <array>
#include <cstdio>
#include <filesystem>

#include "core/file.h"
#include "core/text.h"
#include "formats/io/formats.h"
#include "tools/cli/tool.h"

namespace krok::cli {

namespace {

namespace fs = std::filesystem;

constexpr const char* kHelp =
    "Usage: krok git-setup [--hook]\n\n"
    "Lets git show and merge motions: .gitattributes, diff.krok.textconv, merge.krok.driver.\n\n"
    "  --hook    also a pre-commit hook that runs krok lint on the motions of a commit\n\n"
    "Exit codes:\n  0 done; 2 no git repository, or a file that cannot be written\n";

// Refuses to merge; %P is the file's path, quoted by git.
constexpr const char* kMergeDriver =
    "printf 'krok: %s: both sides changed this motion; choose one: git checkout --ours FILE or "
    "git checkout --theirs FILE, then git add FILE\\n' %P >&2; exit 1";

constexpr const char* kHook = R"(#!/bin/sh
# Written by krok git-setup: lints the motions of a commit. With the faults that are there already in
# krok-lint.json (krok lint . --save-baseline krok-lint.json) only new ones count.
baseline=
[ ! -f krok-lint.json ] || baseline=--baseline=krok-lint.json
git diff --cached --name-only -z --diff-filter=ACM -- {} |
  xargs -0 -r krok lint $baseline && exit 0
echo 'krok: not committed for these faults; git commit --no-verify commits them all the same' >&2
exit 1
)";

// What a command prints, and whether it ends with 0.
struct Ran {
  bool good = false;
  std::string text;
};
Ran run(const std::vector<std::string>& words) {
  std::string command;
  for (const std::string& word : words) {
    std::string quoted = "'";
    for (const char c : word) quoted += c == '\'' ? "'\\''" : std::string(1, c);
    command += quoted + "' ";
  }
  Ran ran;
  FILE* pipe = popen((command + "2>/dev/null").c_str(), "r");
  if (pipe == nullptr) return ran;
  std::array<char, 4096> buffer{};
  while (std::fgets(buffer.data(), buffer.size(), pipe) != nullptr) ran.text += buffer.data();
  ran.good = pclose(pipe) == 0;
  while (!ran.text.empty() && ran.text.back() == '\n') ran.text.pop_back();
  return ran;
}

int fail(const std::string& message) {
  fmt::print(stderr, "krok: error: {} [git-setup]\n", message);
  return kExitTrouble;
}

Status write_text(const std::string& path, const std::string& text) {
  auto file = OutputFile::create(path);
  if (!file) return file.error();
  if (Status status = file->write(text); !status) return status;
  return file->commit();
}

// The patterns of motions in .gitattributes and in the hook.
std::vector<std::string> patterns() {
  std::vector<std::string> all;
  for (const std::string& ending : io::motion_endings()) all.push_back("*" + ending);
  return all;
}

Status add_attributes(const std::string& path) {
  std::string text;
  std::error_code ignored;
  if (fs::exists(path, ignored)) {
    const auto file = InputFile::open(path);
    if (!file) return file.error();
    text = file->text();
    if (!text.empty() && text.back() != '\n') text += '\n';
  }
  const std::string before = text;
  for (const std::string& pattern : patterns()) {
    const std::string begin = pattern + " ";
    if (text.starts_with(begin) || text.find("\n" + begin) != std::string::npos) continue;
    text += pattern + " diff=krok merge=krok\n";
  }
  return text == before ? Status() : write_text(path, text);
}

Status add_hook(const std::string& path) {
  std::error_code ignored;
  if (fs::exists(path, ignored)) {
    return Error("git-setup", path + " is there already", "add krok lint to it by hand");
  }
  std::string list;
  for (const std::string& pattern : patterns()) list += "'" + pattern + "' ";
  if (!list.empty()) list.pop_back();
  fs::create_directories(fs::path(path).parent_path(), ignored);
  if (Status status = write_text(path, fmt::format(kHook, list)); !status) return status;
  fs::permissions(path, fs::perms::owner_exec | fs::perms::group_exec | fs::perms::others_exec,
                  fs::perm_options::add, ignored);
  return {};
}

}  // namespace

int git_setup(const std::vector<std::string>& arguments) {
  bool hook = false;
  for (const std::string& argument : arguments) {
    if (argument == "--help" || argument == "-h") return print_and_end("krok git-setup", kHelp);
    if (argument != "--hook") return fail(fmt::format("unknown option '{}'", shown(argument)));
    hook = true;
  }
  const Ran top = run({"git", "rev-parse", "--show-toplevel"});
  if (!top.good || top.text.empty())
    return fail("this folder is in no git repository: go to one, or make it one by git init");
  if (Status status = add_attributes(top.text + "/.gitattributes"); !status) {
    return fail(status.error().message);
  }
  // git keeps texts as commits of its own; without an identity `git diff` would end with an error.
  const bool keeps = run({"git", "var", "GIT_COMMITTER_IDENT"}).good;
  for (const auto& [key, value] : std::array<std::pair<const char*, const char*>, 4>{
           {{"diff.krok.textconv", "krok info --textconv"},
            {"diff.krok.cachetextconv", keeps ? "true" : "false"},
            {"merge.krok.name", "motions are not merged"},
            {"merge.krok.driver", kMergeDriver}}}) {
    if (!run({"git", "config", key, value}).good) {
      return fail(fmt::format("git config {} failed", key));
    }
  }
  if (hook) {
    const Ran path =
        run({"git", "rev-parse", "--path-format=absolute", "--git-path", "hooks/pre-commit"});
    if (!path.good) return fail("git has no place for hooks");
    if (Status status = add_hook(path.text); !status) return fail(status.error().message);
  }
  return print_and_end("krok git-setup",
                       fmt::format(".gitattributes, diff.krok and merge.krok are set{}\n",
                                   hook ? ", and the pre-commit hook" : ""));
}

}  // namespace krok::cli
