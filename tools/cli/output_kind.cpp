#include "tools/cli/output_kind.h"

#include <fmt/format.h>

#include "core/file.h"
#include "core/text.h"

namespace krok::cli {

using registry::Kind;

namespace {

// Hint which tool creates files of this kind; empty if none does.
std::string maker_of(Kind kind, Kind from) {
  switch (kind) {
    case Kind::glb:
    case Kind::gltf:
      return from == Kind::anim ? "krok-export converts .anim files to glTF"
                                : "krok-skin creates glTF from a .model and a .anim file";
    case Kind::bvh:
      return "krok-export converts .anim files to BVH";
    case Kind::character:
      return "krok-import --character writes one of a GLB or FBX file";
    case Kind::model:
      return "krok-body creates a .model file for a .anim file";
    case Kind::anim:
      return "krok-import converts captures to .anim files";
    default:
      return {};
  }
}

}  // namespace

Status check_output_kind(const std::string& path, const std::string& option, Kind written) {
  const Kind named = registry::kind_of_name(path);
  if (named == written) return {};
  const std::string_view own = registry::kind_name(written);
  if (named == Kind::unknown) {
    // Devices and names without an extension are taken as they are.
    const std::string ending = extension(path);
    if (ending.empty()) return {};
    return Error(
        "usage",
        fmt::format("{} {}: the output is a .{} file, not {}", option, path, own, shown(ending)),
        fmt::format("use the extension .{}", own));
  }
  const std::string maker = maker_of(named, written);
  return Error("usage",
               fmt::format("{} {}: the output is a .{} file, not .{}", option, path, own,
                           registry::kind_name(named)),
               fmt::format("use the extension .{}{}{}", own, maker.empty() ? "" : "; ", maker));
}

}  // namespace krok::cli
