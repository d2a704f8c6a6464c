#include "formats/acclaim/source_text_internal.h"

#include <fmt/format.h>

#include <span>

#include "formats/registry/registry.h"

namespace krok::acclaim {

Error SourceText::error(const TextLocation& place, std::string code, std::string message,
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

void SourceText::warn(const TextLocation& place, std::string code, std::string message,
                      std::string hint, std::string joint) {
  if (++warnings_ > kMaxWarnings) return;
  Error failure = error(place, std::move(code), std::move(message), std::move(hint));
  failure.severity = Severity::warning;
  failure.joint = std::move(joint);
  diagnostics_.push_back(std::move(failure));
}

Status SourceText::fault(const TextLocation& place, std::string code, std::string message,
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
  if (warnings_ <= kMaxWarnings) return;
  diagnostics_.push_back(make_warning(
      "acclaim-more", fmt::format("{} more warnings are not shown", warnings_ - kMaxWarnings), "",
      file_name_));
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

Status check_kind(std::string_view text, const std::string& file_name, bool is_asf) {
  using registry::Kind;
  const char* wanted = is_asf ? "an Acclaim skeleton (ASF)" : "an Acclaim motion (AMC)";
  const auto refuse = [&](std::string message, std::string hint) {
    return Error("acclaim-kind", std::move(message), std::move(hint)).in_file(file_name);
  };
  if (text.empty()) return refuse("the file is empty", "export or copy it again");
  const auto content = std::as_bytes(std::span(text));
  const Kind kind = registry::kind_of_content(content);
  if (kind == (is_asf ? Kind::asf : Kind::amc)) return {};
  if (kind == Kind::asf || kind == Kind::amc) {
    return refuse(fmt::format("is {}, expected {}", registry::describe_content(content), wanted),
                  "perhaps the two files are in the wrong order");
  }
  if (text.starts_with("\xFF\xFE") || text.starts_with("\xFE\xFF")) {
    return refuse("is UTF-16 text", "save it as UTF-8");
  }
  if (TokenCursor(text).next().end()) {
    return refuse("the file has only white space and comments", "export or copy it again");
  }
  // A text that begins with an unknown section may still be an Acclaim file.
  const std::string_view what = registry::describe_content(content);
  if (kind == Kind::unknown && what == registry::kUnknownText) return {};
  return refuse(fmt::format("is {}, not {}", what, wanted), fmt::format("give {}", wanted));
}

}  // namespace krok::acclaim
