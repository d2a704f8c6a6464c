#include "tools/common/role_input.h"

#include <memory>

#include "formats/role_map/role_map.h"

namespace krok {

CommandOption add_map_option(CommandOptions& command, std::string& path, const std::string& name,
                             const std::string& description) {
  return command.add_option(name, path, description).type_name("IN.json");
}

Result<FindRoles> open_role_map(const std::string& path, ToolContext& context) {
  if (path.empty()) {
    return FindRoles(
        [](const Skeleton& skeleton) { return Result<RoleMap>(find_roles(skeleton)); });
  }
  auto opened = context.open_input(path);
  if (!opened) return opened.error();
  const auto file = std::make_shared<const InputFile>(std::move(*opened));
  return FindRoles([file](const Skeleton& skeleton) {
    return role_map::read(file->text(), file->path(), skeleton);
  });
}

}  // namespace krok
