#include "formats/acclaim/source_text.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/text_reading.h"

namespace krok::acclaim {

Error SourceText::error(const Place& place, std::string code, std::string message,
                        std::string hint) const {
  Error error(std::move(code), std::move(message), std::move(hint));
  if (place.line == 0) {
    error.where = locate(text_, place.offset, file_name_);
  } else {
    error.where.file = file_name_;
    error.where.line = place.line;
    error.where.column = place.column;
  }
  return error;
}

void SourceText::warn(const Place& place, std::string code, std::string message, std::string hint,
                      std::string joint) {
  if (++warnings_ > kMostWarnings) return;
  Error told = error(place, std::move(code), std::move(message), std::move(hint));
  told.severity = Severity::warning;
  told.joint = std::move(joint);
  diagnostics_.push_back(std::move(told));
}

Status SourceText::fault(const Place& place, std::string code, std::string message,
                         std::string hint, std::string joint) {
  if (strictness_ == Strictness::strict) {
    Error refused = error(place, std::move(code), std::move(message), std::move(hint));
    refused.joint = std::move(joint);
    return refused;
  }
  warn(place, std::move(code), std::move(message), std::move(hint), std::move(joint));
  return {};
}

void SourceText::finish() {
  if (warnings_ <= kMostWarnings) return;
  Diagnostic more;
  more.severity = Severity::warning;
  more.code = "acclaim-more";
  more.message = fmt::format("{} more warnings are not shown", warnings_ - kMostWarnings);
  more.where.file = file_name_;
  diagnostics_.push_back(std::move(more));
}

Token TokenCursor::next() {
  Token token;
  token.starts_line = at_start_;
  at_start_ = false;
  for (;;) {
    while (position_ < text_.size() && is_separator(text_[position_])) {
      if (is_line_end(text_[position_])) token.starts_line = true;
      ++position_;
    }
    if (position_ == text_.size() || text_[position_] != '#') break;
    skip_line();
  }
  token.offset = position_;
  while (position_ < text_.size() && !is_separator(text_[position_])) ++position_;
  token.text = text_.substr(token.offset, position_ - token.offset);
  return token;
}

Token TokenCursor::peek() const {
  TokenCursor ahead = *this;
  return ahead.next();
}

std::string_view TokenCursor::rest_of_line() {
  const std::size_t begin = position_;
  skip_line();
  std::string_view rest = text_.substr(begin, position_ - begin);
  for (std::size_t i = 0; i < rest.size(); ++i) {
    if (rest[i] == '#' && (i == 0 || is_separator(rest[i - 1]))) rest = rest.substr(0, i);
  }
  while (!rest.empty() && is_separator(rest.front())) rest.remove_prefix(1);
  while (!rest.empty() && is_separator(rest.back())) rest.remove_suffix(1);
  return rest;
}

void TokenCursor::skip_line() {
  while (position_ < text_.size() && !is_line_end(text_[position_])) ++position_;
}

namespace {

struct KnownBeginning {
  std::string_view begins;
  std::string_view what;
};

constexpr std::array kOthers = {
    KnownBeginning{"HIERARCHY", "a BVH file"},
    KnownBeginning{"KROK", "a file of Krok's own"},
    KnownBeginning{"glTF", "a binary glTF file"},
    KnownBeginning{"\x89PNG", "a PNG image"},
    KnownBeginning{"PK\x03\x04", "a ZIP archive"},
    KnownBeginning{"\x1F\x8B", "gzip-compressed"},
    KnownBeginning{"<", "an XML file or a web page"},
    KnownBeginning{"%PDF", "a PDF document"},
    KnownBeginning{"Kaydara", "an FBX file"},
    KnownBeginning{"\xFF\xFE", "UTF-16 text"},
    KnownBeginning{"\xFE\xFF", "UTF-16 text"},
};

// The first section keyword says which of the two a file is: only an AMC names its format.
bool begins_as_motion(std::string_view text) {
  TokenCursor cursor(text);
  const std::string word = ascii_lower(cursor.next().text);
  return word.starts_with(":fully") || word == ":degrees" || word == ":radians" ||
         word == ":samples-per-second" || word == ":frame-range" || word.starts_with(":asf-");
}

bool begins_as_skeleton(std::string_view text) {
  TokenCursor cursor(text);
  const std::string word = ascii_lower(cursor.next().text);
  return word == ":version" || word == ":name" || word == ":units" || word == ":root" ||
         word == ":bonedata" || word == ":documentation";
}

}  // namespace

Status check_kind(std::string_view text, const std::string& file_name, bool is_asf) {
  const char* wanted = is_asf ? "an Acclaim skeleton (ASF)" : "an Acclaim motion (AMC)";
  const auto refuse = [&](std::string message, std::string hint) {
    return Error("acclaim-kind", std::move(message), std::move(hint)).in_file(file_name);
  };
  if (text.empty()) return refuse("the file is empty", "export or copy it again");
  for (const KnownBeginning& other : kOthers) {
    if (text.starts_with(other.begins)) {
      return refuse(fmt::format("is {}, not {}", other.what, wanted),
                    fmt::format("give {}", wanted));
    }
  }
  if (text.substr(0, 512).find('\0') != std::string_view::npos) {
    return refuse(fmt::format("is a binary file, not {}", wanted), fmt::format("give {}", wanted));
  }
  if (TokenCursor(text).next().end()) {
    return refuse("the file holds nothing but white space and comments", "export or copy it again");
  }
  if (is_asf ? begins_as_motion(text) : begins_as_skeleton(text)) {
    return refuse(fmt::format("is an Acclaim {}, where {} is expected",
                              is_asf ? "motion (AMC)" : "skeleton (ASF)", wanted),
                  "perhaps the two files are in the wrong order");
  }
  return {};
}

}  // namespace krok::acclaim
