#pragma once

#include <map>
#include <string>
#include <vector>

#include "core/result.h"
#include "tools/batch/manifest.h"
#include "tools/cli/command_line.h"
#include "tools/cli/tool.h"

namespace krok::cli::batch {

// A set of options shared by files of a batch.
struct OptionSet {
  std::vector<GivenOption> options;
  Result<std::string> ending = std::string();  // suffix of output names, or why it is unknown
};

// The options of the command line merged with those of manifest lines, which override them. Each
// distinct set is parsed once.
class OptionSets {
 public:
  OptionSets(MakeToolSpec make_spec, const CommandLine& whole);

  // Index of the set for these manifest words. An Error has the location of the invalid word, or no
  // file if there are no words.
  Result<std::size_t> find(const std::vector<ManifestWord>& words);

  std::vector<OptionSet> take() && { return std::move(sets_); }
  const std::vector<OptionSet>& all() const { return sets_; }

 private:
  Result<OptionSet> parse(const std::vector<std::string>& words) const;

  MakeToolSpec make_spec_;
  std::vector<GivenOption> whole_;
  std::vector<std::string> fixed_positionals_;
  std::vector<OptionSet> sets_;
  std::map<std::vector<std::string>, std::size_t> known_;
};

// The arguments for one file.
std::vector<std::string> arguments_for_file(const std::vector<GivenOption>& options,
                                            const std::vector<std::string>& fixed_positionals,
                                            const std::string& input, const std::string& output,
                                            bool no_clobber);

}  // namespace krok::cli::batch
