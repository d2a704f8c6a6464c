#pragma once

#include <optional>
#include <span>
#include <string>

#include "formats/container/packed_orientation.h"
#include "formats/io/open_motion.h"
#include "formats/keys/keys.h"
#include "roles/roles.h"
#include "scene/clip.h"
#include "scene/frame_source.h"
#include "scene/motion_keys.h"
#include "tools/cli/output_set.h"
#include "tools/cli/tool.h"

// Sidecars: the contacts and keytimes of a motion, stored beside it as NAME.keys.json.

namespace krok::cli {

// Bytes of a file whose steps are found in parts, find_in_long_take().
inline constexpr std::size_t kLongTake = std::size_t{64} << 20;

// "takes/walk.keys.json" for "takes/walk.anim". Empty for standard input.
std::string keys_sidecar_path(const std::string& motion_path);

// Reads the file `path`, opened by context.open_input. Warns (code keys-stale) if the file was made
// for a motion of another duration, or if its contacts are elsewhere than the motion's joints (the
// median by over 50 mm).
Result<krok::keys::Sidecar> read_keys_file(const std::string& path, const FrameSource& motion,
                                           ToolContext& context);
inline Result<krok::keys::Sidecar> read_keys_file(const std::string& path, const Clip& clip,
                                                  ToolContext& context) {
  return read_keys_file(path, frames_of(clip), context);
}

// Reads the sidecar of a motion read from `motion_path`; empty if there is none, and with a warning
// (keys-stale) if it was made for another motion (see read_keys_file(), or other joints, or times
// outside the motion) and was not edited by hand. One that was is used, or an error.
Result<std::optional<krok::keys::Sidecar>> read_keys_beside(const std::string& motion_path,
                                                            const FrameSource& motion,
                                                            ToolContext& context);
inline Result<std::optional<krok::keys::Sidecar>> read_keys_beside(const std::string& motion_path,
                                                                   const Clip& clip,
                                                                   ToolContext& context) {
  return read_keys_beside(motion_path, frames_of(clip), context);
}

// Detects contacts and keytimes as krok-keys does, with warnings for doubtful results; as
// find_steps() finds them. Warnings name `path`, the motion's. Code:
// contacts-feet.
Result<MotionKeys> find_keys(const std::string& path, const Clip& clip, const RoleMap& roles,
                             ToolContext& context);

// Names and times for the report.
Json to_json(std::span<const Keytime> keytimes);

// Warns (code motion-in-place) of a motion in place that is combined with others, as the speed at
// which an engine moves it is not the result's.
void warn_of_lost_speed(const std::string& name, const Clip& clip, ToolContext& context);

// --contacts: where a tool that combines motions gets their contacts and keytimes, and where it
// writes those of the result.

enum class KeysChoice : unsigned char { automatic, sidecar, none };

// The keys of a motion read from `path`: from its sidecar, or detected if there is none and
// `choice` allows it. Empty for KeysChoice::none, or with a warning (code keys-none) if detection
// fails. `name` is for messages. Codes: keys-missing, and those of reading the sidecar.
Result<std::optional<MotionKeys>> choose_keys(KeysChoice choice, const std::string& path,
                                              const std::string& name, const Clip& clip,
                                              const io::FindRoles& find_roles,
                                              ToolContext& context);

// Adds the keys of a result that is written to `motion_path` to its outputs, beside it; does
// nothing if there are none or the motion has no path. Fails (code keys-edited) if that file was
// edited by hand.
Status add_keys(const MotionKeys& keys, const Skeleton& skeleton, double duration,
                const std::string& motion_path, OutputSet& outputs);

// Adds a motion and its keys to the outputs.
Status add_motion(const Clip& clip, const MotionKeys& keys, OrientationEncoding orientation,
                  const std::string& path, int jobs, OutputSet& outputs);

// Keys of motions that are read in parts.

// As choose_keys() for a file of `bytes` bytes: of a long take, kLongTake, those that krok-keys
// detects in parts; otherwise, and for a motion in place, whose contacts are those of the motion as
// it travels, the frames are loaded. Codes: those of the frames as well.
Result<std::optional<MotionKeys>> choose_keys(KeysChoice choice, const std::string& path,
                                              std::size_t bytes, const FrameSource& frames,
                                              const Provenance& provenance,
                                              const io::FindRoles& find_roles, ToolContext& context,
                                              bool contacts_alone = false);

}  // namespace krok::cli
