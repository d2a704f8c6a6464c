#pragma once

#include <cstddef>
#include <memory>
#include <mutex>
#include <vector>

#include "tools/cli/command_line.h"
#include "tools/cli/tool.h"

namespace krok::cli::batch {

// A tool and its declared options, ready to parse one file of a batch.
struct ReadyLine {
  explicit ReadyLine(const MakeToolSpec& make_spec)
      : spec(make_spec()), line(spec, CommandLine::Form::one_file) {}

  ToolSpec spec;
  CommandLine line;
};

// Pool of ReadyLines. Declaring options is slower than parsing them, so files with the same option
// set reuse a line. Sets must not be mixed: an option that is not given keeps its previous value.
// Running a tool does not change its options.
class ReadyLines {
 public:
  // Keeps at most `most` lines, one per thread, for any number of option sets.
  ReadyLines(MakeToolSpec make_spec, std::size_t most)
      : make_spec_(std::move(make_spec)), most_(most) {}

  // Takes a line for an option set. Thread-safe, as is put_back().
  std::unique_ptr<ReadyLine> take(std::size_t set);
  void put_back(std::size_t set, std::unique_ptr<ReadyLine> ready);

 private:
  struct Kept {
    std::size_t set;
    std::unique_ptr<ReadyLine> ready;
  };
  MakeToolSpec make_spec_;
  std::size_t most_;
  std::mutex mutex_;
  std::vector<Kept> kept_;  // most recently returned last
};

}  // namespace krok::cli::batch
