#pragma once

#include <memory>
#include <string>

#include "core/progress.h"

namespace krok {

enum class ProgressStyle { automatic, bar, plain, json, none };

// Progress and messages on standard error, that do not get into each other's way.
class Console : public Progress {
 public:
  // A text of whole lines; a bar that stands there is taken away first.
  virtual void write(const std::string& text);
};

// `text` by `console`, or straight to standard error where that is null.
void write_message(Console* console, const std::string& text);

// A Console. automatic: a bar on a terminal, nothing elsewhere. plain: a line at
// the start and at every tenth. json: {"progress": {"what", "done", "total"}} a line. A bar appears
// after half a second only, so that short work leaves the terminal alone. NO_COLOR is honoured.
std::unique_ptr<Console> console_progress(ProgressStyle style);

}  // namespace krok
