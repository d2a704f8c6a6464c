#pragma once

#include <cstddef>
#include <memory>
#include <mutex>
#include <vector>

#include "tools/common/command_line.h"
#include "tools/common/tool.h"

namespace krok {

// The tool and its options, declared and ready to be parsed for one file of a batch.
struct ReadyLine {
  explicit ReadyLine(const MakeToolSpec& make_spec)
      : spec(make_spec()), line(spec, CommandLine::Form::one_file) {}

  ToolSpec spec;
  CommandLine line;
};

// To declare a tool's options takes longer than to parse them, so files with the same options are
// parsed for by the same lines, one after the other. Only these: an option that a file lacks would
// keep the value that it had for the file before. Running a tool does not change its options.
class ReadyLines {
 public:
  // Keeps at most `most`, one a thread, however many sets of options there are.
  ReadyLines(MakeToolSpec make_spec, std::size_t most)
      : make_spec_(std::move(make_spec)), most_(most) {}

  // A line for the files of a set of options. Can be called from several threads, as put_back().
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
  std::vector<Kept> kept_;  // the one put back last at the end
};

}  // namespace krok
