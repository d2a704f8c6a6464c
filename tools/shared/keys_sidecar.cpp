#include "tools/shared/keys_sidecar.h"

#include <fmt/format.h>

#include <cmath>
#include <filesystem>

#include "contacts/gait_keytimes.h"
#include "core/numbers.h"

namespace krok::cli {

std::string keys_sidecar_path(const std::string& motion_path) {
  if (motion_path == "-" || motion_path.empty()) return {};
  return std::filesystem::path(motion_path).replace_extension(".keys.json").string();
}

Result<krok::keys::Sidecar> read_keys_file(const std::string& path, const Clip& clip,
                                           ToolContext& context) {
  const auto input = context.open_input(path);
  if (!input) return input.error();
  auto sidecar = krok::keys::read_sidecar(input->text(), path, clip.skeleton, clip.duration());
  // Half a frame: more than rounding errors, less than any cut.
  if (sidecar && sidecar->duration > 0 &&
      std::abs(sidecar->duration - clip.duration()) > 0.5 / clip.rate) {
    Diagnostic stale =
        make_warning("keys-stale",
                     fmt::format("made for a motion of {} s, but this one has {} s",
                                 readable(sidecar->duration), readable(clip.duration())),
                     "if the motion was cut or retimed, run krok-keys again");
    stale.where.file = path;
    context.diagnose(std::move(stale));
  }
  return sidecar;
}

Result<std::optional<krok::keys::Sidecar>> read_keys_beside(const std::string& motion_path,
                                                            const Clip& clip,
                                                            ToolContext& context) {
  const std::string path = keys_sidecar_path(motion_path);
  if (path.empty()) return std::optional<krok::keys::Sidecar>();
  context.depends_on_neighbours(motion_path, base_name(path));
  std::error_code ignored;
  if (!std::filesystem::exists(path, ignored)) return std::optional<krok::keys::Sidecar>();
  auto sidecar = read_keys_file(path, clip, context);
  if (!sidecar) return std::move(sidecar).error();
  return std::optional<krok::keys::Sidecar>(std::move(*sidecar));
}

Result<MotionKeys> find_keys(const Clip& clip, const RoleMap& roles, ToolContext& context) {
  auto contacts = find_contacts(clip, roles);
  if (!contacts) return std::move(contacts).error();
  context.diagnose(contacts->warnings);
  Gait gait = find_gait(clip, roles, *contacts);
  context.diagnose(gait.warnings);
  return MotionKeys{std::move(contacts->contacts), std::move(gait.keytimes)};
}

Json to_json(std::span<const Keytime> keytimes) {
  Json list = Json::array();
  for (const Keytime& key : keytimes) list.push_back({{"name", key.name}, {"time", key.time}});
  return list;
}

}  // namespace krok::cli
