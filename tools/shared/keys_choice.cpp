#include "tools/shared/keys_choice.h"

#include <fmt/format.h>

#include <filesystem>
#include <utility>

#include "formats/io/open_role_map.h"
#include "tools/shared/keys_sidecar.h"

namespace krok::cli {

Result<std::optional<MotionKeys>> choose_keys(KeysChoice choice, const std::string& path,
                                              const std::string& name, const Clip& clip,
                                              const io::FindRoles& find_roles,
                                              ToolContext& context) {
  std::optional<MotionKeys> none;
  if (choice == KeysChoice::none) return none;
  auto sidecar = read_keys_beside(path, clip, context);
  if (!sidecar) return sidecar.error();
  if (*sidecar) return std::optional(std::move((*sidecar)->keys));
  if (choice == KeysChoice::sidecar) {
    return Error("keys-missing",
                 fmt::format("{} is missing beside it", base_name(keys_sidecar_path(path))),
                 "create it with krok-keys, or use --contacts auto to detect keytimes")
        .in_file(path);
  }
  const auto roles = find_roles(clip.skeleton);
  if (!roles) return roles.error();
  auto found = find_keys(path, clip, *roles, context);
  if (!found) {
    context.warn("keys-none", fmt::format("{}: {}", name, found.error().message));
    return none;
  }
  return std::optional(std::move(*found));
}

Result<std::string> place_for_keys(const MotionKeys& keys, const std::string& motion_path) {
  const std::string path = keys_sidecar_path(motion_path);
  if (keys.empty() || path.empty()) return std::string();
  std::error_code unknown;
  if (!std::filesystem::exists(path, unknown)) return path;
  const auto file = InputFile::open(path);
  if (!file) return file.error();
  if (!krok::keys::has_edits(file->text())) return path;
  return Error("keys-edited", "was edited by hand, or is not a keytime file",
               "the result's keytimes would overwrite it: move it away, or choose another name for "
               "the result")
      .in_file(path);
}

}  // namespace krok::cli
