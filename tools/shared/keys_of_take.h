#pragma once

#include <optional>
#include <string>

#include "tools/shared/keys_sidecar.h"

// Keys of motions that are read in parts.

namespace krok::cli {

// As choose_keys() for a file of `bytes` bytes: of a long take, kLongTake, those that krok-keys
// detects in parts; otherwise, and for a motion in place, whose contacts are those of the motion as
// it travels, the frames are loaded. Codes: those of the frames as well.
Result<std::optional<MotionKeys>> choose_keys(KeysChoice choice, const std::string& path,
                                              std::size_t bytes, const FrameSource& frames,
                                              const Provenance& provenance,
                                              const io::FindRoles& find_roles, ToolContext& context,
                                              bool contacts_alone = false);

}  // namespace krok::cli
