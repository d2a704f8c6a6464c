#include "tools/batch/option_sets.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/text.h"

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

namespace {

struct Field {
  std::string_view text;
  std::int64_t column = 1;
};

std::vector<Field> fields_of(std::string_view line) {
  std::vector<Field> fields;
  for (std::size_t at = 0;;) {
    const std::size_t end = std::min(line.find('\t', at), line.size());
    fields.push_back({line.substr(at, end - at), static_cast<std::int64_t>(at) + 1});
    if (end == line.size()) return fields;
    at = end + 1;
  }
}

class LineParser {
 public:
  LineParser(std::string_view line, std::int64_t number, const std::string& file)
      : line_(line), number_(number), file_(file) {}

  Result<ManifestLine> parse() {
    const auto fields = fields_of(line_);
    if (fields.size() > 3) {
      return error(fields[3].column, "more than three fields",
                   "input, output and options are separated by tabs");
    }
    ManifestLine result;
    result.input = word(fields[0].text, fields[0].column);
    if (result.input.text.empty()) return error(1, "no input given");
    if (fields.size() > 1) result.output = word(fields[1].text, fields[1].column);
    for (const ManifestWord& path : {result.input, result.output}) {
      if (path.text == "-") {
        return error(path.where.column, "standard streams cannot be used in a list of files",
                     "give a file");
      }
      if (path.text.find('\0') != std::string::npos) {
        return error(path.where.column, "file name with a zero byte");
      }
    }
    if (fields.size() > 2) {
      auto words = split(fields[2]);
      if (!words) return words.error();
      result.options = std::move(*words);
    }
    return result;
  }

 private:
  Error error(std::int64_t column, std::string message, std::string hint = {}) const {
    return Error("manifest-line", std::move(message), std::move(hint))
        .in_file(file_)
        .at_line(number_, column);
  }

  ManifestWord word(std::string_view text, std::int64_t column) const {
    return {std::string(text), {file_, number_, column, -1}};
  }

  Result<std::vector<ManifestWord>> split(const Field& field) const {
    std::vector<ManifestWord> words;
    for (std::size_t at = 0; at < field.text.size();) {
      if (field.text[at] == ' ') {
        ++at;
        continue;
      }
      const auto column = [&](std::size_t offset) {
        return field.column + static_cast<std::int64_t>(offset);
      };
      ManifestWord next = word({}, column(at));
      while (at < field.text.size() && field.text[at] != ' ') {
        const char c = field.text[at];
        if (c != '"' && c != '\'') {
          next.text += c;
          ++at;
          continue;
        }
        const std::size_t end = field.text.find(c, at + 1);
        if (end == std::string_view::npos) {
          return error(column(at), fmt::format("unclosed quote {}", c));
        }
        next.text += field.text.substr(at + 1, end - at - 1);
        at = end + 1;
      }
      words.push_back(std::move(next));
    }
    return words;
  }

  std::string_view line_;
  std::int64_t number_;
  const std::string& file_;
};

bool is_heading(std::string_view line) {
  return line == "input" || line == "input\toutput" || line == "input\toutput\toptions";
}

}  // namespace

Manifest parse_manifest(std::string_view text, const std::string& file_name) {
  Manifest manifest;
  text = without_byte_order_mark(text);
  std::int64_t number = 0;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    std::string_view line = text.substr(at, end - at);
    at = end + 1;
    ++number;
    if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
    if (trimmed(line).empty() || line[0] == '#') continue;
    if (number == 1 && is_heading(line)) continue;
    auto parsed = LineParser(line, number, file_name).parse();
    if (parsed) {
      manifest.lines.push_back(std::move(*parsed));
    } else {
      manifest.errors.push_back(std::move(parsed).error());
    }
  }
  return manifest;
}

}  // namespace krok::cli::batch
