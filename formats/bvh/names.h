#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "core/result.h"

// Makes joint names unique and valid UTF-8.

namespace krok::bvh {

// A joint name from the file (raw bytes, empty for End Sites and nameless joints), modified in
// place.
struct JointName {
  std::string* name;
  int parent;  // index into the same list, -1 for none
  bool end_site;
  std::size_t offset;  // of the name in the text
};

// Makes all names unique, non-empty and UTF-8. Duplicates get a suffix "_2", "_3", ...; End Sites
// become <parent>_end; a nameless joint becomes "joint". Names that are not UTF-8 are read as
// Latin-1. Each changed name is a warning, except for End Sites.
void make_names_unique(std::vector<JointName>& places, std::string_view text,
                       const std::string& file_name, Diagnostics& diagnostics);

// For messages: shown(name), or a description if the name is empty.
std::string readable_name(std::string_view name);

}  // namespace krok::bvh
