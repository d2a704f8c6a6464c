#include "tools/batch/manifest.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/text.h"

namespace krok::cli::batch {

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
