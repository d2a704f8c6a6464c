#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <string_view>

#include "core/result.h"
#include "formats/acclaim/acclaim_reader.h"

namespace krok::acclaim {

// White space; the format counts commas and parentheses as such.
inline constexpr std::array<bool, 256> kIsSeparator = [] {
  std::array<bool, 256> table{};
  for (const unsigned char c : {' ', '\t', '\r', '\n', '\v', '\f', ',', '(', ')'}) table[c] = true;
  return table;
}();
inline bool is_separator(char c) { return kIsSeparator[static_cast<unsigned char>(c)]; }
inline bool is_line_end(char c) { return c == '\n' || c == '\r'; }

// A file's text and what is told about it.
class SourceText {
 public:
  SourceText(std::string_view text, const std::string& file_name, Strictness strictness,
             Diagnostics& diagnostics)
      : text_(text), file_name_(file_name), strictness_(strictness), diagnostics_(diagnostics) {}

  std::string_view text() const { return text_; }
  const std::string& file_name() const { return file_name_; }
  Strictness strictness() const { return strictness_; }

  Error error(std::size_t offset, std::string code, std::string message,
              std::string hint = {}) const;

  void note(std::size_t offset, std::string code, std::string message, std::string hint = {});
  // After kMostWarnings of them only their number is told, by finish().
  void warn(std::size_t offset, std::string code, std::string message, std::string hint = {},
            std::string joint = {});
  // A warning that is an error where reading is strict.
  Status fault(std::size_t offset, std::string code, std::string message, std::string hint = {},
               std::string joint = {});
  void finish();

 private:
  static constexpr int kMostWarnings = 50;

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

// Steps through an ASF by words; comments (a word that begins with '#', to the end of its line) are
// passed over.
class TokenCursor {
 public:
  explicit TokenCursor(std::string_view text, std::size_t position = 0)
      : text_(text), position_(position), at_start_(true) {}

  Token next();
  Token peek() const;
  // What is left of the line up to a comment, trimmed.
  std::string_view rest_of_line();
  void skip_line();
  std::size_t position() const { return position_; }

 private:
  std::string_view text_;
  std::size_t position_;
  bool at_start_;
};

// Whether the two texts can be Acclaim files at all: not empty, not binary, not another kind of
// file, not each other. `is_asf` says which of the two it should be. Code acclaim-kind.
Status check_kind(std::string_view text, const std::string& file_name, bool is_asf);

}  // namespace krok::acclaim
