#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "core/result.h"
#include "core/text.h"
#include "formats/acclaim/acclaim_reader.h"

namespace krok::acclaim {

// White space; in this format it includes commas and parentheses.
inline constexpr std::array<bool, 256> kIsSeparator = [] {
  std::array<bool, 256> table = kIsSpace;
  for (const unsigned char c : {',', '(', ')'}) table[c] = true;
  return table;
}();
inline bool is_separator(char c) {
  return kIsSeparator[static_cast<unsigned char>(c)];
}

// The text of a file and its diagnostics.
class SourceText {
 public:
  SourceText(std::string_view text, const std::string& file_name, Strictness strictness,
             Diagnostics& diagnostics)
      : text_(text), file_name_(file_name), strictness_(strictness), diagnostics_(diagnostics) {}

  std::string_view text() const { return text_; }
  const std::string& file_name() const { return file_name_; }
  Strictness strictness() const { return strictness_; }

  // A location in the text, by offset or by line if known. Finding the line of an offset takes time
  // linear in the offset.
  struct TextLocation {
    TextLocation(std::size_t byte) : offset(byte) {}  // NOLINT: implicit
    TextLocation(std::int64_t line_number, std::int64_t column_number)
        : line(line_number), column(column_number) {}
    std::size_t offset = 0;
    std::int64_t line = 0;  // 0: by offset
    std::int64_t column = 0;
  };

  Error error(const TextLocation& place, std::string code, std::string message,
              std::string hint = {}) const;

  // Warnings beyond kMaxWarnings are only counted; finish() reports their number.
  void warn(const TextLocation& place, std::string code, std::string message, std::string hint = {},
            std::string joint = {});
  // A warning that is an error if strict.
  Status fault(const TextLocation& place, std::string code, std::string message,
               std::string hint = {}, std::string joint = {});
  void finish();

 private:
  static constexpr int kMaxWarnings = 50;

  std::string_view text_;
  const std::string& file_name_;
  Strictness strictness_;
  Diagnostics& diagnostics_;
  int warnings_ = 0;
};

struct Token {
  std::string_view text;  // empty at the end of the file
  std::size_t offset = 0;
  bool starts_line = false;
  bool end() const { return text.empty(); }
};

// Splits an ASF into words, skipping comments (from a word that begins with '#' to the end of the
// line).
class TokenCursor {
 public:
  explicit TokenCursor(std::string_view text) : text_(text) {}

  Token next();
  Token peek() const;
  // The rest of the line up to a comment, trimmed.
  std::string_view rest_of_line();
  void skip_line();

 private:
  std::string_view text_;
  std::size_t position_ = 0;
  bool at_start_ = true;
};

// Checks that a text can be an ASF (`is_asf`) or AMC file: not empty, not binary, not another kind
// of file, not the other of the two. Code acclaim-kind.
Status check_kind(std::string_view text, const std::string& file_name, bool is_asf);

}  // namespace krok::acclaim
