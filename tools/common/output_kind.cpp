#include "tools/common/output_kind.h"

#include <fmt/format.h>

namespace krok {

using registry::Kind;

namespace {

// Which tool makes a file of this kind; empty where none does.
std::string maker_of(Kind kind, Kind from) {
  switch (kind) {
    case Kind::glb:
    case Kind::gltf:
      return from == Kind::anim ? "krok-export makes glTF of a .anim file"
                                : "krok-skin makes glTF of a .model file and a .anim file";
    case Kind::bvh:
      return "krok-export makes BVH of a .anim file";
    case Kind::model:
      return "krok-body makes a .model file for a .anim file";
    case Kind::anim:
      return "krok-import makes a .anim file of a capture";
    default:
      return {};
  }
}

}  // namespace

Status check_output_kind(const std::string& path, const std::string& option, Kind written) {
  const Kind named = registry::kind_of_name(path);
  if (named == Kind::unknown || named == written) return {};
  const std::string_view own = registry::kind_name(written);
  const std::string maker = maker_of(named, written);
  return Error("usage",
               fmt::format("{} {}: what is written there is a .{} file, not .{}", option, path, own,
                           registry::kind_name(named)),
               fmt::format("call it .{}{}{}", own, maker.empty() ? "" : "; ", maker));
}

}  // namespace krok
