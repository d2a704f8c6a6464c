#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <unordered_map>
#include <unordered_set>
#include <vector>

#include "core/result.h"

// Names of joints: what the file has made unique and UTF-8.

namespace krok::bvh {

// A joint's name as the file has it (raw bytes, empty for End Sites and nameless joints), to be
// replaced in place.
struct NamedPlace {
  std::string* name;
  int parent;  // index into the same list, -1 for none
  bool end_site;
  std::size_t offset;  // where the name stands in the text
};

// Makes all names unique, not empty and UTF-8. A name that is given again gets "_2", "_3", ...;
// End Sites become <parent>_end; a nameless joint becomes "joint". Bytes that are not UTF-8 are
// read as Latin-1. What changed a name of the file is a warning.
void make_names_unique(std::vector<NamedPlace>& places, std::string_view text,
                       const std::string& file_name, Diagnostics& diagnostics);

// Names that were given out already.
class UniqueNames {
 public:
  // Claims a name that must stay as it is; false if it is taken.
  bool claim(const std::string& name) { return taken_.insert(name).second; }

  // Claims the first free one of name, name_2, name_3, ...
  std::string make(const std::string& name);

 private:
  std::unordered_set<std::string> taken_;
  std::unordered_map<std::string, int> numbers_;
};

// For messages: short, without control characters or bytes that are not UTF-8.
std::string shown(std::string_view text);
// The same for a joint's name, which may be empty.
std::string readable_name(std::string_view name);

bool is_utf8(std::string_view text);
std::string latin1_to_utf8(std::string_view text);

}  // namespace krok::bvh
