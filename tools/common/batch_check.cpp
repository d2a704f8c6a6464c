#include "tools/common/batch_check.h"

#include <fmt/format.h>

#include <map>
#include <unordered_map>

#include "tools/common/paths.h"

namespace krok {

namespace {

class Check {
 public:
  Check(const CommandLine& line, const BatchList& list, Diagnostics& errors)
      : line_(line), list_(list), errors_(errors) {}

  std::map<FileNumber, std::string> run() {
    for (const BatchFile& file : list_.files) note_read(file.input);
    for (const std::string& path : line_.fixed_positionals) note_read(path);
    if (line_.manifest != "-") note_read(line_.manifest);
    for (const OptionSet& set : list_.option_sets) {
      for (const GivenOption& option : set.options) {
        if (!option.names_input) continue;
        for (const std::string& path : option.values) note_read(path);
      }
    }
    if (!line_.json_path.empty() && line_.json_path != "-") check(line_.json_path, kReport);
    for (std::size_t i = 0; i < list_.files.size(); ++i) {
      const BatchFile& file = list_.files[i];
      check(file.output, i);
      for (const GivenOption& option : list_.option_sets[file.options].options) {
        if (!option.names_output) continue;
        for (const std::string& value : option.values) {
          if (value == "-") {
            fail(i, fmt::format("--{} -: the results of many files cannot go to standard output",
                                option.name));
            continue;
          }
          check(expanded(value, file, line_.out_dir), i, value.find("{name}") == std::string::npos);
        }
      }
    }
    return std::move(read_);
  }

 private:
  static constexpr std::size_t kReport = static_cast<std::size_t>(-1);

  std::string name_of(std::size_t who) const {
    return who == kReport ? "the report" : list_.files[who].input;
  }

  void fail(std::size_t who, std::string message, std::string hint = {}) {
    Error error("usage", std::move(message), std::move(hint));
    if (who != kReport) error.where = list_.files[who].line;
    errors_.push_back(std::move(error));
  }

  void note_read(const std::string& path) {
    if (path.empty()) return;
    if (path == "-") {
      errors_.push_back(Error("usage",
                              "standard input can be read only once, and here are many files",
                              "name a file for what all of them take"));
      return;
    }
    if (const auto number = file_number(path)) read_.emplace(*number, path);
  }

  void check(const std::string& path, std::size_t who, bool lacks_placeholder = false) {
    const auto number = file_number(path);
    if (number) {
      if (const auto found = read_.find(*number); found != read_.end()) {
        return fail(who,
                    fmt::format("{} is read and would be replaced by the result of {}",
                                found->second, name_of(who)),
                    "choose another folder or name");
      }
    }
    auto [first, is_new] = written_.emplace(absolute_path(path), who);
    if (is_new && number) {
      const auto same = written_numbers_.emplace(*number, who);
      if (!same.second) {
        is_new = false;
        first->second = same.first->second;
      }
    }
    if (is_new) return;
    fail(who,
         fmt::format("{} and {} would both be written to {}", name_of(first->second), name_of(who),
                     path),
         lacks_placeholder ? "put {name} into it, which stands for the name of each result"
                           : "--base keeps more of their folders; a --manifest names each result");
  }

  const CommandLine& line_;
  const BatchList& list_;
  Diagnostics& errors_;
  std::map<FileNumber, std::string> read_;
  std::unordered_map<std::string, std::size_t> written_;
  std::map<FileNumber, std::size_t> written_numbers_;
};

}  // namespace

void check_batch(const CommandLine& line, BatchList& list, Diagnostics& errors) {
  list.read_files = Check(line, list, errors).run();
}

}  // namespace krok
