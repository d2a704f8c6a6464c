#pragma once

#include <string>
#include <utility>
#include <vector>

namespace krok {

// The origin of data and what was done to it. Written into Krok's files, so it contains nothing
// that differs between two runs on the same input: base names only, no timestamps.
struct Provenance {
  std::string tool;     // "krok-import"
  std::string version;  // "0.2.0"
  struct Source {
    std::string name;  // base name of the file
    std::string xxh3;  // sixteen hexadecimal digits
  };
  std::vector<Source> sources;
  std::vector<std::pair<std::string, std::string>> options;  // as given, in a fixed order
  std::vector<std::string> conversions;  // "unit: centimetres to metres (detected, certain)"
  std::vector<std::string> warnings;     // messages with their codes
};

}  // namespace krok
