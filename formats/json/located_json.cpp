#include "formats/json/located_json.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <span>

#include "core/json_internal.h"
#include "core/text.h"
#include "formats/registry/registry.h"

namespace krok::json {

namespace {

constexpr std::size_t kDeepest = 32;
constexpr std::size_t kMaxMembers = 1000;  // keys are compared pairwise

// Finds the offsets of tokens, in sync with the parser's events. The text between two tokens has
// only white space, commas and colons, because the parser has accepted it.
class TokenPlaces {
 public:
  explicit TokenPlaces(std::string_view text) : text_(text) {}

  std::size_t next() {
    while (at_ < text_.size() && (is_space(text_[at_]) || text_[at_] == ',' || text_[at_] == ':')) {
      ++at_;
    }
    const std::size_t begin = at_;
    if (begin < text_.size()) at_ = end_of_token(begin);
    return begin;
  }

 private:
  std::size_t end_of_token(std::size_t at) const {
    const char first = text_[at++];
    if (first == '"') {
      while (at < text_.size() && text_[at] != '"') at += text_[at] == '\\' ? 2 : 1;
      return std::min(at + 1, text_.size());
    }
    if (first == '{' || first == '}' || first == '[' || first == ']') return at;
    const std::string_view ends = ",:{}[] \t\r\n";
    while (at < text_.size() && ends.find(text_[at]) == std::string_view::npos) ++at;
    return at;
  }

  std::string_view text_;
  std::size_t at_ = 0;
};

// Receives nlohmann's events and builds the tree.
class Builder : public nlohmann::json_sax<nlohmann::json> {
 public:
  explicit Builder(std::string_view text) : text_(text), places_(text) {}

  bool null() override { return add({}); }
  bool boolean(bool value) override {
    Value made;
    made.kind = Value::Kind::boolean;
    made.truth = value;
    return add(std::move(made));
  }
  bool number_integer(number_integer_t value) override { return number(double(value)); }
  bool number_unsigned(number_unsigned_t value) override { return number(double(value)); }
  bool number_float(number_float_t value, const string_t&) override { return number(value); }
  bool string(string_t& value) override {
    Value made;
    made.kind = Value::Kind::string;
    made.text = std::move(value);
    return add(std::move(made));
  }
  bool binary(binary_t&) override { return false; }
  bool start_object(std::size_t) override { return open(Value::Kind::object); }
  bool start_array(std::size_t) override { return open(Value::Kind::array); }
  bool end_object() override { return close(); }
  bool end_array() override { return close(); }
  bool key(string_t& name) override {
    const std::size_t offset = places_.next();
    if (stack_.back().members.size() >= kMaxMembers) {
      error_ = error_at(text_, offset, "json-limit",
                        fmt::format("an object has more than {} keys", kMaxMembers));
      return false;
    }
    for (const Value::Member& member : stack_.back().members) {
      if (member.key != name) continue;
      error_ =
          error_at(text_, offset, "json-syntax", fmt::format("duplicate key '{}'", shown(name)));
      return false;
    }
    stack_.back().members.push_back({std::move(name), offset, {}});
    return true;
  }
  bool parse_error(std::size_t position, const std::string& token,
                   const nlohmann::detail::exception& error) override {
    // "[json.exception.parse_error.101] parse error at line 1, column 2: what": the location is
    // reported separately.
    std::string what = error.what();
    if (const auto place = what.find(": "); place != std::string::npos) what.erase(0, place + 2);
    // The position is the number of bytes read. An unexpected string is reported at its beginning.
    std::size_t offset = position > 0 ? position - 1 : 0;
    if (is_one_string(token) && token.size() <= position &&
        text_.substr(0, position).ends_with(token)) {
      offset = position - token.size();
    }
    error_ = error_at(text_, offset, "json-syntax", "not valid JSON: " + what.substr(0, 200));
    const std::size_t before = text_.find_last_not_of(" \t\r\n", offset == 0 ? 0 : offset - 1);
    if (before < offset && text_[before] == ',' && (token.ends_with('}') || token.ends_with(']'))) {
      error_->hint = "JSON has no comma after the last item: remove it";
    }
    return false;
  }

  std::optional<Error> error_;
  Value root_;

 private:
  // The parser's token begins at the last string and may continue after it.
  static bool is_one_string(const std::string& token) {
    if (!token.starts_with('"')) return false;
    std::size_t at = 1;
    while (at < token.size() && token[at] != '"') at += token[at] == '\\' ? 2 : 1;
    return at + 1 >= token.size();
  }

  bool number(double value) {
    Value made;
    made.kind = Value::Kind::number;
    made.number = value;
    return add(std::move(made));
  }
  bool add(Value value) {
    value.offset = places_.next();
    place(std::move(value));
    return true;
  }
  bool open(Value::Kind kind) {
    Value made;
    made.kind = kind;
    made.offset = places_.next();
    if (stack_.size() >= kDeepest) {
      error_ = error_at(text_, made.offset, "json-limit",
                        fmt::format("nested more than {} levels deep", kDeepest));
      return false;
    }
    stack_.push_back(std::move(made));
    return true;
  }
  bool close() {
    places_.next();
    Value done = std::move(stack_.back());
    stack_.pop_back();
    place(std::move(done));
    return true;
  }
  void place(Value value) {
    if (stack_.empty()) {
      root_ = std::move(value);
    } else if (stack_.back().kind == Value::Kind::array) {
      stack_.back().items.push_back(std::move(value));
    } else {
      stack_.back().members.back().value = std::move(value);
    }
  }

  std::string_view text_;
  TokenPlaces places_;
  std::vector<Value> stack_;
};

}  // namespace

const Value* Value::find(std::string_view key) const {
  for (const Member& member : members) {
    if (member.key == key) return &member.value;
  }
  return nullptr;
}

std::string_view kind_name(Value::Kind kind) {
  switch (kind) {
    case Value::Kind::null:
      return "null";
    case Value::Kind::boolean:
      return "true or false";
    case Value::Kind::number:
      return "a number";
    case Value::Kind::string:
      return "a string";
    case Value::Kind::array:
      return "an array";
    case Value::Kind::object:
      return "an object";
  }
  return "a value";
}

Result<Value> parse(std::string_view text, std::size_t largest) {
  if (text.size() > largest) {
    return Error("json-limit",
                 fmt::format("{} bytes exceed the limit of {}", text.size(), largest));
  }
  const std::string_view content = without_byte_order_mark(text);
  Builder builder(content);
  const bool parsed = nlohmann::json::sax_parse(content.begin(), content.end(), &builder);
  if (parsed && !builder.error_) return std::move(builder.root_);
  const std::string_view start = trimmed(content);
  if (builder.error_ && !start.starts_with('{') && !start.starts_with('[')) {
    const auto what = registry::describe_content(std::as_bytes(std::span(content)));
    if (!what.ends_with("unknown kind")) {
      builder.error_->message = fmt::format("is {}, not JSON", what);
    }
  }
  if (builder.error_) return std::move(*builder.error_);
  return Error("json-syntax", "not valid JSON");
}

Error error_at(std::string_view text, std::size_t offset, std::string code, std::string message,
               std::string hint) {
  const Location place = locate(without_byte_order_mark(text), offset, {});
  return Error(std::move(code), std::move(message), std::move(hint))
      .at_line(place.line, place.column);
}

std::string in_quotes(std::string_view text) {
  return krok::json_text(nlohmann::json(text));
}

}  // namespace krok::json
