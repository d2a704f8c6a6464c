#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/result.h"
#include "timeline/timeline.h"

// A timeline as a text file that people write; SPEC.md describes it.

namespace krok::timeline_file {

struct SourceFile {
  std::string name;       // by which items call it
  std::string path;       // of the motion, as written: relative to the timeline's folder
  std::string sequences;  // of a file that names parts of it; may be empty
  Location where;
};

struct Document {
  std::vector<SourceFile> sources;  // in the file's order; items count them
  timeline::Timeline timeline;      // parts of motions by name, not looked up
};

// `path` is for messages, and for the places that the timeline keeps. What hangs on the motions is
// not checked. Codes, each with line and column: json-syntax, json-limit, timeline-structure (a key
// that is missing or not known), timeline-value.
Result<Document> read(std::string_view text, const std::string& path);

}  // namespace krok::timeline_file
