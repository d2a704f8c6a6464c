#pragma once

#include <list>
#include <vector>

#include "formats/timeline/timeline_file.h"
#include "tools/krok-mix/options.h"

namespace krok::cli::mix {

// The motions of a timeline; the sources point into it.
struct TimelineSources {
  struct Motion {
    Clip clip;
    MotionKeys keys;
  };
  std::list<Motion> motions;
  std::vector<timeline::Source> sources;
};

// Reads the motions, relative to the folder of the timeline at `path`, their named parts, and the
// keys of those in the base track.
Result<TimelineSources> read_sources(const timeline_file::Document& document,
                                     const std::string& path, const Options& options,
                                     const io::FindRoles& find_roles, ToolContext& context);

}  // namespace krok::cli::mix
