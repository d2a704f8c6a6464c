#include "tools/batch/option_sets.h"

#include <algorithm>

namespace krok::cli::batch {

std::vector<std::string> arguments_for_file(const std::vector<GivenOption>& options,
                                            const std::vector<std::string>& fixed_positionals,
                                            const std::string& input, const std::string& output,
                                            bool no_clobber) {
  std::vector<std::string> arguments = arguments_of(options);
  arguments.insert(arguments.end(), {"--output", output});
  if (no_clobber) arguments.push_back("--no-clobber");
  arguments.push_back("--");
  arguments.insert(arguments.end(), fixed_positionals.begin(), fixed_positionals.end());
  arguments.push_back(input);
  return arguments;
}

OptionSets::OptionSets(MakeToolSpec make_spec, const CommandLine& whole)
    : make_spec_(std::move(make_spec)),
      whole_(whole.given()),
      fixed_positionals_(whole.fixed_positionals) {}

Result<OptionSet> OptionSets::parse(const std::vector<std::string>& words) const {
  CommandLine line(make_spec_(), CommandLine::Form::own);
  if (const auto parsed = line.parse(words); !parsed) return parsed.error();
  OptionSet set;
  for (const GivenOption& option : whole_) {
    const bool replaced =
        std::any_of(line.given().begin(), line.given().end(),
                    [&](const GivenOption& given) { return given.name == option.name; });
    if (!replaced) set.options.push_back(option);
  }
  set.options.insert(set.options.end(), line.given().begin(), line.given().end());

  // Merged, as they will be parsed for each file.
  CommandLine file(make_spec_(), CommandLine::Form::one_file);
  const ToolSpec& spec = file.spec();
  const auto parsed =
      file.parse(arguments_for_file(set.options, fixed_positionals_, "input", "output", false));
  if (!parsed) return parsed.error();
  if (spec.check) {
    if (Status status = spec.check(); !status) return status.error();
  }
  set.ending = spec.batch->ending();
  if (spec.batch->each_animation) set.each_animation = spec.batch->each_animation();
  return set;
}

Result<std::size_t> OptionSets::find(const std::vector<ManifestWord>& words) {
  std::vector<std::string> texts;
  for (const ManifestWord& word : words) texts.push_back(word.text);
  if (const auto found = known_.find(texts); found != known_.end()) return found->second;
  auto set = parse(texts);
  if (set) {
    sets_.push_back(std::move(*set));
    return known_[texts] = sets_.size() - 1;
  }
  if (words.empty()) return std::move(set).error();
  // The invalid word follows the longest valid prefix.
  std::size_t right = words.size() - 1;
  while (right > 0 && !parse({texts.begin(), texts.begin() + static_cast<std::ptrdiff_t>(right)})) {
    --right;
  }
  Error error = std::move(set).error();
  error.where = words[right].where;
  error.hint = "lines take the tool's own options; batch options go on the command line";
  return error;
}

std::unique_ptr<CommandLine> ReadyLines::take(std::size_t set) {
  {
    const std::lock_guard lock(mutex_);
    const auto found = std::find_if(kept_.rbegin(), kept_.rend(),
                                    [&](const Kept& kept) { return kept.set == set; });
    if (found != kept_.rend()) {
      std::unique_ptr<CommandLine> line = std::move(found->line);
      kept_.erase(std::next(found).base());
      return line;
    }
  }
  return std::make_unique<CommandLine>(make_spec_(), CommandLine::Form::one_file);
}

void ReadyLines::put_back(std::size_t set, std::unique_ptr<CommandLine> line) {
  Kept oldest;  // destroyed after the mutex is released
  const std::lock_guard lock(mutex_);
  if (kept_.size() >= max_) {
    oldest = std::move(kept_.front());
    kept_.erase(kept_.begin());
  }
  kept_.push_back({set, std::move(line)});
}

}  // namespace krok::cli::batch
