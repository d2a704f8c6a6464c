#include "formats/acclaim/source_text_internal.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <span>

#include "core/numbers.h"
#include "formats/acclaim/files_internal.h"
#include "formats/registry/registry.h"
#include "math/quaternion.h"

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

namespace {

constexpr std::array<std::string_view, 7> kChannelNames = {"tx", "ty", "tz", "rx", "ry", "rz", "l"};

std::optional<Channel> parse_channel(std::string_view word) {
  for (std::size_t i = 0; i < kChannelNames.size(); ++i) {
    if (same_word(word, kChannelNames[i])) return static_cast<Channel>(i);
  }
  return std::nullopt;
}

// "XYZ": three different axes, in the order of application.
std::optional<EulerOrder> parse_order(std::string_view word) {
  EulerOrder order{};
  if (word.size() != order.size()) return std::nullopt;
  std::array<bool, 3> seen{};
  for (std::size_t i = 0; i < order.size(); ++i) {
    const int axis = ascii_lower(word[i]) - 'x';
    if (axis < 0 || axis > 2 || seen[static_cast<std::size_t>(axis)]) return std::nullopt;
    seen[static_cast<std::size_t>(axis)] = true;
    order[i] = static_cast<Axis>(axis);
  }
  return order;
}

}  // namespace

std::string_view channel_name(Channel channel) {
  return kChannelNames[static_cast<std::size_t>(channel)];
}

Quat PrintedAxes::rotation(double radians) const {
  Quat q = Quat::Identity();
  for (const Axis axis : order) {
    q = axis_rotation(axis, angles[static_cast<int>(axis)] * radians) * q;
  }
  return normalized_or_identity(q);
}

Result<double> ItemParser::number(const std::string& what) {
  const Token token = cursor_.next();
  const auto value = parse_finite(token.text);
  if (value) return *value;
  return source_.error(
      token.offset, "acclaim-number",
      token.end() ? fmt::format("the file ends in the {}", what)
                  : fmt::format("'{}' in the {} is not a finite number", shown(token.text), what),
      token.end() ? "the file is truncated; export or copy it again" : "");
}

Status ItemParser::vector(const std::string& what, Vec3& vector) {
  for (int axis = 0; axis < 3; ++axis) {
    const auto value = number(what);
    if (!value) return value.error();
    vector[axis] = *value;
  }
  return {};
}

Status ItemParser::channels(std::vector<Channel>& channels, const std::string& whose) {
  for (Token token = cursor_.peek(); !token.end() && !token.starts_line; token = cursor_.peek()) {
    cursor_.next();
    const auto channel = parse_channel(token.text);
    if (!channel) {
      return source_.error(
          token.offset, "acclaim-dof",
          fmt::format("'{}' is not a degree of freedom (of {})", shown(token.text), whose),
          "use tx ty tz rx ry rz l");
    }
    if (std::find(channels.begin(), channels.end(), *channel) != channels.end()) {
      return source_.error(token.offset, "acclaim-dof",
                           fmt::format("{} has {} twice", whose, channel_name(*channel)));
    }
    channels.push_back(*channel);
  }
  return {};
}

Status ItemParser::axis_order(const std::string& whose, EulerOrder& order) {
  const Token token = cursor_.peek();
  if (token.end() || token.starts_line) {
    return source_.fault(token.offset, "acclaim-syntax",
                         fmt::format("the axis of {} has no order, assumed to be XYZ", whose));
  }
  cursor_.next();
  const auto parsed = parse_order(token.text);
  if (!parsed) {
    return source_.error(token.offset, "acclaim-syntax",
                         fmt::format("'{}' is not an axis order (of {})", shown(token.text), whose),
                         "write XYZ or another permutation");
  }
  order = *parsed;
  return {};
}

Status ItemParser::skip_unknown(const Token& token) {
  cursor_.skip_line();
  return source_.fault(token.offset, "acclaim-keyword",
                       fmt::format("'{}' is unknown, the line is ignored", shown(token.text)));
}

}  // namespace krok::acclaim
