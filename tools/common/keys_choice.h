#pragma once

#include <optional>
#include <string>

#include "scene/clip.h"
#include "scene/motion_keys.h"
#include "tools/common/role_input.h"
#include "tools/common/tool.h"

// --keys: where a tool that puts motions together has their contacts and keytimes from, and where
// those of the result go.

namespace krok {

enum class KeysChoice : unsigned char { automatic, sidecar, none };

CommandOption add_keys_option(CommandOptions& command, KeysChoice& choice);

// The keys of a motion that was read from `path`: those beside it; where none are, found if that is
// wanted. Nothing where it is told so, or where none can be found, which is a warning (code
// keys-none). `name` is for messages. Codes: keys-missing, and those of reading them.
Result<std::optional<MotionKeys>> choose_keys(KeysChoice choice, const std::string& path,
                                              const std::string& name, const Clip& clip,
                                              const FindRoles& find_roles, ToolContext& context);

// Where the keys of a result go that is written to `motion_path`: beside it, unless a person wrote
// there (code keys-edited). Empty where there are none, or no place for them.
Result<std::string> place_for_keys(const MotionKeys& keys, const Skeleton& skeleton,
                                   const std::string& motion_path);

}  // namespace krok
