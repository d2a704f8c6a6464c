#pragma once

#include "formats/keys/keys.h"
#include "scene/clip.h"
#include "tools/krok-keys/options.h"

namespace krok::keys_tool {

// What was found, with what a person set before: found keytimes of the same name within 0.15 s and
// found contacts of the same joint that overlap give way.
keys::Sidecar with_edits(MotionKeys found, const keys::Sidecar& before);

// Does what the options ask for. Codes: keys-none (nothing there to take out), keys-joint,
// keys-time.
Status change(const Changes& changes, const Clip& clip, keys::Sidecar& sidecar);

}  // namespace krok::keys_tool
