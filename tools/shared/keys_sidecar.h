#pragma once

#include <optional>
#include <span>
#include <string>

#include "formats/keys/keys.h"
#include "roles/roles.h"
#include "scene/clip.h"
#include "tools/cli/tool.h"

// Sidecars: the contacts and keytimes of a motion, stored beside it as NAME.keys.json.

namespace krok::cli {

// "takes/walk.keys.json" for "takes/walk.anim". Empty for standard input.
std::string keys_sidecar_path(const std::string& motion_path);

// Reads the file `path`, opened by context.open_input. Warns (code keys-stale) if the file was made
// for a motion of another duration, or if its contacts are elsewhere than the motion's joints (the
// median by over 50 mm).
Result<krok::keys::Sidecar> read_keys_file(const std::string& path, const Clip& clip,
                                           ToolContext& context);

// Reads the sidecar of a motion read from `motion_path`; empty if there is none, and with a warning
// (keys-stale) if it was made for another motion (see read_keys_file(), or other joints, or times
// outside the motion) and was not edited by hand. One that was is used, or an error.
Result<std::optional<krok::keys::Sidecar>> read_keys_beside(const std::string& motion_path,
                                                            const Clip& clip, ToolContext& context);

// Detects contacts and keytimes as krok-keys does, with warnings for doubtful results; in a motion
// in place, while it travels as it did before. Warnings name `path`, the motion's. Code:
// contacts-feet.
Result<MotionKeys> find_keys(const std::string& path, const Clip& clip, const RoleMap& roles,
                             ToolContext& context);

// Sets the places of contacts to where the motion has their joints halfway through: those of a
// motion in place move.
void place_contacts(const Clip& clip, std::span<Contact> contacts);

// Names and times for the report.
Json to_json(std::span<const Keytime> keytimes);

}  // namespace krok::cli
