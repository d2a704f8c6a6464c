#include "formats/io/open_role_map.h"

#include <memory>

#include "formats/role_map/role_map.h"

namespace krok::io {

Result<FindRoles> open_role_map(const std::string& path, Inputs& inputs) {
  if (path.empty()) {
    return FindRoles(
        [](const Skeleton& skeleton) { return Result<RoleMap>(find_roles(skeleton)); });
  }
  auto opened = inputs.open_input(path);
  if (!opened) return opened.error();
  const auto file = std::make_shared<const InputFile>(std::move(*opened));
  return FindRoles([file](const Skeleton& skeleton) {
    return role_map::read(file->text(), file->path(), skeleton);
  });
}

}  // namespace krok::io
