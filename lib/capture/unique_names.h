#pragma once

#include <string>
#include <string_view>
#include <unordered_map>
#include <unordered_set>

namespace krok {

// A set of names in use.
class UniqueNames {
 public:
  // Claims a name without changing it; false if it is taken.
  bool claim(const std::string& name) { return taken_.insert(name).second; }

  // Claims the first free one of name, name_2, name_3, ...
  std::string make(const std::string& name);

 private:
  std::unordered_set<std::string> taken_;
  std::unordered_map<std::string, int> numbers_;
};

// Converts a joint name to valid UTF-8 (other text is read as Latin-1) and replaces each
// control character except tab by '_'.
std::string readable_joint_name(std::string_view bytes);

}  // namespace krok
