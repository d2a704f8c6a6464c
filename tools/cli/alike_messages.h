#pragma once

#include <cstddef>
#include <map>
#include <string>

namespace krok::cli {

// Counts messages of many files by code, so that only those of the first few files are printed.
class AlikeMessages {
 public:
  // Whether a message of a file is printed: always if it has no code.
  bool is_shown(const std::string& code, const std::string& file);
  // Lines that name the codes whose messages were not all printed, and in how many files.
  std::string more() const;

 private:
  struct Said {
    std::size_t files = 0;
    std::string last;  // the file that was counted last
  };
  std::map<std::string, Said> by_code_;
};

}  // namespace krok::cli
