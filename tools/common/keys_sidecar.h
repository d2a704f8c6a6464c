#pragma once

#include <optional>
#include <span>
#include <string>

#include "formats/keys/keys.h"
#include "roles/roles.h"
#include "scene/clip.h"
#include "tools/common/tool.h"

// The contacts and keytimes that stand beside a motion, in NAME.keys.json.

namespace krok {

// Where they stand: "takes/walk.keys.json" for "takes/walk.anim". Empty for standard input.
std::string keys_sidecar_path(const std::string& motion_path);

// Those in the file `path`, opened by context.open_input. Warns (code keys-stale) where the file
// was made for a motion of another length.
Result<keys::Sidecar> read_keys_file(const std::string& path, const Clip& clip,
                                     ToolContext& context);

// Those beside a motion that was read from `motion_path`; nothing where no such file stands there.
Result<std::optional<keys::Sidecar>> read_keys_beside(const std::string& motion_path,
                                                      const Clip& clip, ToolContext& context);

// Those of a motion as krok-keys finds them. What is doubtful is told. Code: contacts-feet.
Result<MotionKeys> find_keys(const Clip& clip, const RoleMap& roles, ToolContext& context);

// Names and times, for the report.
Json to_json(std::span<const Keytime> keytimes);

}  // namespace krok
