#pragma once

#include <gtest/gtest.h>

#include <cctype>
#include <fstream>
#include <sstream>
#include <string>

#include "support/this_build.h"

namespace krok::test {

inline const std::string kBvhFolder = test::corpus_folder() + "/bvh/";

inline std::string text_of_file(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

// A file of the corpus as the name of a test.
inline std::string name_of_file(const testing::TestParamInfo<const char*>& test_case) {
  std::string name = test_case.param;
  for (char& c : name) {
    if (!std::isalnum(static_cast<unsigned char>(c))) c = '_';
  }
  return name;
}

}  // namespace krok::test
