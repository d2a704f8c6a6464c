#pragma once

#include <optional>
#include <string>

#include "formats/io/open_role_map.h"
#include "scene/clip.h"
#include "scene/motion_keys.h"
#include "tools/cli/tool.h"

// --contacts: where a tool that combines motions gets their contacts and keytimes, and where it
// writes those of the result.

namespace krok::cli {

enum class KeysChoice : unsigned char { automatic, sidecar, none };

// The keys of a motion read from `path`: from its sidecar, or detected if there is none and
// `choice` allows it. Empty for KeysChoice::none, or with a warning (code keys-none) if detection
// fails. `name` is for messages. Codes: keys-missing, and those of reading the sidecar.
Result<std::optional<MotionKeys>> choose_keys(KeysChoice choice, const std::string& path,
                                              const std::string& name, const Clip& clip,
                                              const io::FindRoles& find_roles,
                                              ToolContext& context);

// The sidecar path for a result written to `motion_path`. Fails (code keys-edited) if that file was
// edited by hand. Empty if there are no keys or the motion has no path.
Result<std::string> place_for_keys(const MotionKeys& keys, const std::string& motion_path);

}  // namespace krok::cli
