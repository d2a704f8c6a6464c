#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/result.h"
#include "timeline/timeline.h"

// Reader for timeline files (JSON, hand-written); see SPEC.md.

namespace krok::timeline_file {

struct SourceFile {
  std::string name;       // used by items
  std::string path;       // of the motion, as written: relative to the timeline's folder
  std::string sequences;  // path of a sequences file; may be empty
  Location where;
};

struct Document {
  std::vector<SourceFile> sources;  // in file order; items refer to them by index
  timeline::Timeline timeline;      // sequences by name, not resolved
};

// `path` is for messages and for the locations stored in the timeline. Nothing is checked against
// the motions. Codes, each with line and column: json-syntax, json-limit, timeline-structure (a
// missing or unknown key), timeline-value.
Result<Document> read(std::string_view text, const std::string& path);

// The JSON Schema of such files.
std::string schema();

}  // namespace krok::timeline_file
