#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "core/result.h"

// Names of joints: what the file has made unique and UTF-8.

namespace krok::bvh {

// A joint's name as the file has it (raw bytes, empty for End Sites and nameless joints), to be
// replaced in place.
struct JointName {
  std::string* name;
  int parent;  // index into the same list, -1 for none
  bool end_site;
  std::size_t offset;  // where the name stands in the text
};

// Makes all names unique, not empty and UTF-8. A name that is given again gets "_2", "_3", ...;
// End Sites become <parent>_end; a nameless joint becomes "joint". Bytes that are not UTF-8 are
// read as Latin-1. What changed a name of the file is a warning.
void make_names_unique(std::vector<JointName>& places, std::string_view text,
                       const std::string& file_name, Diagnostics& diagnostics);

// For messages: as shown() has it; a joint's name may be empty.
std::string readable_name(std::string_view name);

}  // namespace krok::bvh
