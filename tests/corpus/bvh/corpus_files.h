#pragma once

#include <fstream>
#include <sstream>
#include <string>

namespace krok::test {

inline const std::string kBvhFolder = std::string(KROK_CORPUS_DIR) + "/bvh/";

inline std::string text_of_file(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

}  // namespace krok::test
