#include "tools/batch/names.h"

#include <fmt/format.h>

#include "tools/cli/paths.h"

namespace krok::cli::batch {

namespace {

constexpr const char* kHint = "use a --manifest to name each output";

}  // namespace

std::vector<std::string> outputs_of(const BatchFile& file, const BatchList& list,
                                    const std::string& out_dir) {
  std::vector<std::string> paths = {file.output};
  for (const GivenOption& option : options_of(file, list, out_dir)) {
    if (option.names_output) paths.insert(paths.end(), option.values.begin(), option.values.end());
  }
  return paths;
}

Status BatchNames::check(const std::string& path) {
  if (const auto number = file_number(path)) {
    const auto read = list_.read_files.find(*number);
    if (read != list_.read_files.end()) return replaced_error(read->second);
  }
  std::call_once(listed_once_, [this] {
    for (const BatchFile& file : list_.files) {
      for (const std::string& output : outputs_of(file, list_, out_dir_)) {
        listed_[place_of(output)] = file.input;
      }
    }
  });
  const auto listed = listed_.find(place_of(path));
  if (listed == listed_.end()) return {};
  return Error("usage", fmt::format("{} would also be written by {}", path, listed->second), kHint);
}

Status BatchNames::claim(const std::vector<std::string>& paths, const std::string& input) {
  for (const std::string& path : paths) {
    const auto owner = owners_.find(place_of(path));
    if (owner == owners_.end()) continue;
    return Error("usage",
                 fmt::format("{} and {} would both be written to {}", owner->second, input, path),
                 kHint);
  }
  for (const std::string& path : paths) owners_[place_of(path)] = input;
  return {};
}

}  // namespace krok::cli::batch
