#include "tools/common/keys_choice.h"

#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <utility>

#include "tools/common/keys_sidecar.h"
#include "tools/common/option_kinds.h"

namespace krok {

CommandOption add_keys_option(CommandOptions& command, KeysChoice& choice) {
  return add_choice<KeysChoice>(
      command, "--keys", choice,
      {{"auto", KeysChoice::automatic},
       {"sidecar", KeysChoice::sidecar},
       {"none", KeysChoice::none}},
      "Keytimes: auto (the file NAME.keys.json beside a motion, otherwise "
      "found as krok-keys does), sidecar (that file alone), none (beginnings "
      "and ends)",
      "WHICH", "auto");
}

Result<std::optional<MotionKeys>> choose_keys(KeysChoice choice, const std::string& path,
                                              const std::string& name, const Clip& clip,
                                              const FindRoles& find_roles, ToolContext& context) {
  std::optional<MotionKeys> none;
  if (choice == KeysChoice::none) return none;
  auto sidecar = read_keys_beside(path, clip, context);
  if (!sidecar) return sidecar.error();
  if (*sidecar) return std::optional(std::move((*sidecar)->keys));
  if (choice == KeysChoice::sidecar) {
    return Error("keys-missing",
                 fmt::format("{} stands not beside it", base_name(keys_sidecar_path(path))),
                 "krok-keys makes it; --keys auto finds keytimes on the spot")
        .in_file(path);
  }
  const auto roles = find_roles(clip.skeleton);
  if (!roles) return roles.error();
  // What is doubtful is about this motion, of several.
  const Location before = std::exchange(context.subject, Location{.file = path});
  auto found = find_keys(clip, *roles, context);
  context.subject = before;
  if (!found) {
    context.warn("keys-none", fmt::format("{}: {}", name, found.error().message));
    return none;
  }
  return std::optional(std::move(*found));
}

Result<std::string> place_for_keys(const MotionKeys& keys, const Skeleton& skeleton,
                                   const std::string& motion_path) {
  const std::string path = keys_sidecar_path(motion_path);
  if (keys.empty() || path.empty()) return std::string();
  std::error_code unknown;
  if (!std::filesystem::exists(path, unknown)) return path;
  const auto file = InputFile::open(path);
  if (!file) return file.error();
  const auto before = keys::read_sidecar(file->text(), path, skeleton, HUGE_VAL);
  if (before && !before->has_edits()) return path;
  return Error("keys-edited", "holds what a person wrote, or no keytimes of such a motion",
               "the keytimes of the result would go there: move it away, or name the result "
               "otherwise")
      .in_file(path);
}

}  // namespace krok
