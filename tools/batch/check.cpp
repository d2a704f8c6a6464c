#include "tools/batch/list.h"

#include <fmt/format.h>

#include <filesystem>
#include <map>
#include <optional>
#include <unordered_map>
#include <vector>

#include "core/parallel.h"
#include "formats/io/inputs.h"
#include "tools/cli/paths.h"

namespace krok::cli::batch {

namespace {

class Check {
 public:
  Check(const CommandLine& line, const BatchList& list, Diagnostics& errors)
      : line_(line), list_(list), errors_(errors) {}

  std::map<FileNumber, std::string> run() {
    const std::size_t count = list_.files.size();
    // System calls take most of the time.
    std::vector<std::optional<FileNumber>> inputs(count), outputs(count);
    parallel_for(count, 64, line_.jobs, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        inputs[i] = file_number(io::address_of(list_.files[i].input).file);
        outputs[i] = file_number(list_.files[i].output);
      }
    });
    for (std::size_t i = 0; i < count; ++i) {
      note_read(list_.files[i].input, inputs[i]);
    }
    for (const std::string& path : line_.fixed_positionals) note_read(path);
    if (line_.manifest != "-") note_read(line_.manifest);
    for (const OptionSet& set : list_.option_sets) {
      for (const GivenOption& option : set.options) {
        if (!option.names_input) continue;
        for (const std::string& path : option.values) note_read(path);
      }
    }
    if (!line_.json_path.empty() && line_.json_path != "-") {
      check(line_.json_path, file_number(line_.json_path), kReport);
    }
    for (std::size_t i = 0; i < count; ++i) {
      const BatchFile& file = list_.files[i];
      check(file.output, outputs[i], i);
      for (const GivenOption& option : list_.option_sets[file.options].options) {
        if (!option.names_output) continue;
        for (const std::string& value : option.values) {
          if (value == "-") {
            fail(i, fmt::format("--{} -: standard output is not available in batch mode",
                                option.name));
            continue;
          }
          const std::string path = expanded(value, file, line_.out_dir);
          check(path, file_number(path), i, value.find("{name}") == std::string::npos);
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

  // Such as take.bvh and take.c3d, which no base keeps apart.
  bool same_folder(std::size_t a, std::size_t b) const {
    if (a == kReport || b == kReport) return false;
    const auto folder = [&](std::size_t i) {
      return std::filesystem::path(list_.files[i].input).parent_path();
    };
    return folder(a) == folder(b);
  }

  void fail(std::size_t who, std::string message, std::string hint = {}) {
    Error error("usage", std::move(message), std::move(hint));
    if (who != kReport) error.where = list_.files[who].line;
    errors_.push_back(std::move(error));
  }

  void note_read(const std::string& path) { note_read(path, file_number(path)); }

  void note_read(const std::string& path, const std::optional<FileNumber>& number) {
    if (path.empty()) return;
    if (path == "-") {
      errors_.push_back(Error("usage",
                              "standard input can be read only once, but there are several inputs",
                              "use a file for the shared input"));
      return;
    }
    if (number) read_.emplace(*number, path);
  }

  void check(const std::string& path, const std::optional<FileNumber>& number, std::size_t who,
             bool lacks_placeholder = false) {
    if (number) {
      if (const auto found = read_.find(*number); found != read_.end()) {
        return fail(who,
                    fmt::format("{} is an input and would be overwritten by the output of {}",
                                found->second, name_of(who)),
                    "choose another folder or file name");
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
         lacks_placeholder ? "use {name}, which is replaced by the name of each output"
         : same_folder(first->second, who)
             ? "give the files of one kind: 'FOLDER/*.bvh'; or a --manifest to name each output"
             : "use --base to keep more sub-folders, or a --manifest to name each output");
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

}  // namespace krok::cli::batch
