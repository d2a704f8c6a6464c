#pragma once

#include <map>
#include <string>
#include <vector>

#include "core/result.h"
#include "tools/common/batch/manifest.h"
#include "tools/common/command_line.h"
#include "tools/common/tool.h"

namespace krok {

// The options that files of a batch are done with.
struct OptionSet {
  std::vector<GivenOption> options;
  Result<std::string> ending = std::string();  // of a result's name, or why it is not known
};

// The options of the whole batch, and those of lines of a manifest: what a line gives goes before
// what the command line gave. Each set is parsed once, however many lines have it.
class OptionSets {
 public:
  OptionSets(MakeToolSpec make_spec, const CommandLine& whole);

  // Where the set of these words is. An Error has the place of the word that is at fault, or is
  // about no file where there are no words.
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

}  // namespace krok
