#pragma once

#include "formats/keys/keys.h"
#include "scene/clip.h"
#include "tools/krok-keys/options.h"

namespace krok::cli::keys {

// Within so many seconds keytimes of a name are one.
inline constexpr double kSameKeytime = 0.15;

// Merges detected keys with manual edits: detected keytimes of the same name within kSameKeytime
// and detected contacts of the same joint that overlap are replaced.
krok::keys::Sidecar with_edits(MotionKeys found, const krok::keys::Sidecar& before);

// Applies the edits from the options. Codes: keys-none (nothing to remove), keys-joint, keys-time.
Status change(const Changes& changes, const Clip& clip, krok::keys::Sidecar& sidecar);

}  // namespace krok::cli::keys
