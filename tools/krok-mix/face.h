#pragma once

#include <string>
#include <vector>

#include "core/result.h"
#include "formats/timeline/timeline_file.h"
#include "ik/gaze.h"
#include "roles/roles.h"
#include "scene/character.h"
#include "scene/clip.h"
#include "scene/morph_set.h"
#include "tools/cli/tool.h"

// The face and the gaze of a timeline.

namespace krok::cli::mix {

// Turns head and eyes of the mixed motion; nothing without keys of the gaze. Codes: those of
// gaze_eyes() and apply_gaze().
Result<std::vector<krok::ik::GazeFacts>> add_gaze(const timeline_file::Document& document,
                                                  const Actor& character, const RoleMap& roles,
                                                  Clip& clip);

// The weights of the character's expressions at the frames of the motion. Files are relative to the
// folder of the timeline at `path`. Codes: those of the readers of its files, timeline-target (no
// such expression), timeline-shape (no shape for a viseme).
Result<MorphWeights> face_of(const timeline_file::Document& document, const std::string& path,
                             const Actor& character, const Clip& clip, ToolContext& context);

}  // namespace krok::cli::mix
