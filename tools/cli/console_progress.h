#pragma once

#include <cstddef>
#include <map>
#include <memory>
#include <string>

#include "core/progress.h"

namespace krok::cli {

enum class ProgressStyle { automatic, bar, plain, json, none };

// Progress and messages on standard error, without garbling each other.
class Console : public Progress {
 public:
  // Prints whole lines; clears a progress bar first.
  virtual void write(const std::string& text);
};

// Writes `text` to `console`, or to standard error if null.
// A message with colours for terminals: severities, hints and codes.
std::string in_colours(const std::string& text);

// "12 s left", "3:05 min left", "1:20 h left".
std::string time_left(double seconds);

void write_message(Console* console, const std::string& text);

// automatic: a bar on a terminal, otherwise nothing. plain: a line at the start and every 10 %.
// json: one {"progress": {"what", "done", "total"}} per line. The bar appears after half a second,
// so that short runs print nothing. NO_COLOR is honoured.
std::unique_ptr<Console> console_progress(ProgressStyle style);

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
