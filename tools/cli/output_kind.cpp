#include "tools/cli/output_kind.h"

#include <fmt/format.h>

#include "core/file.h"
#include "core/text.h"
#include "tools/cli/usage.h"

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
      return "krok-import --save-character writes one of a GLB or FBX file";
    case Kind::model:
      return "krok-import --save-model writes one of a GLB or FBX file, krok-body makes one for a "
             "motion";
    case Kind::anim:
      return "krok-import converts captures to .anim files";
    default:
      return registry::is_read_through_assimp(kind)
                 ? "that is only read; krok-export writes .glb and .bvh for other programs"
                 : "";
  }
}

}  // namespace

Status check_output_kind(const std::string& path, const std::string& option, Kind written) {
  const auto read = output_of(written).read(path);
  if (read) return {};
  return usage(fmt::format("{}: {}", option, read.error().message), read.error().hint);
}

ValueKind<std::string> output_of(Kind written) {
  const auto read = [written](const std::string& path) -> Result<std::string> {
    const Kind named = registry::kind_of_name(path);
    // Devices and names without an extension are taken as they are.
    if (named == written || (named == Kind::unknown && extension(path).empty())) return path;
    const std::string_view own = registry::kind_name(written);
    const std::string maker = named == Kind::unknown ? std::string() : maker_of(named, written);
    return usage(fmt::format("the output is a .{} file, not {}", own, shown(path)),
                 fmt::format("use the extension .{}{}{}", own, maker.empty() ? "" : "; ", maker));
  };
  return {"output", "OUT", read, {}};
}

}  // namespace krok::cli
