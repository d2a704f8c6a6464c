#include "formats/bvh/file_kind.h"

#include <fmt/format.h>

#include <span>

#include "formats/bvh/text_cursor.h"
#include "formats/registry/registry.h"

namespace krok::bvh {

namespace {

std::string hint_for(registry::Kind kind, std::string_view what) {
  switch (kind) {
    case registry::Kind::anim:
    case registry::Kind::model:
    case registry::Kind::cam:
      return "this is a Krok file already; no import is needed";
    default:
      break;
  }
  if (what.find("archive") != std::string_view::npos) return "unpack it first";
  if (what.find("Git LFS") != std::string_view::npos) return "fetch the file with: git lfs pull";
  if (what.find("web page") != std::string_view::npos) return "download the file itself";
  return "a BVH file is text that begins with HIERARCHY";
}

// UTF-16 with a byte-order mark, or without: every other byte of ASCII letters is 0.
bool is_utf16(std::string_view text) {
  if (text.starts_with("\xFF\xFE") || text.starts_with("\xFE\xFF")) return true;
  const std::string_view head = text.substr(0, 8);
  if (head.size() < 8) return false;
  for (const std::size_t zero : {0, 1}) {
    bool fits = true;
    for (std::size_t i = 0; i < head.size(); ++i) fits &= (head[i] == 0) == (i % 2 == zero);
    if (fits) return true;
  }
  return false;
}

}  // namespace

std::optional<HierarchyStart> find_start(std::string_view text) {
  constexpr std::size_t kFarthest = std::size_t{64} << 10;
  const std::string_view head = text.substr(0, kFarthest);
  TextCursor cursor(head);
  if (same_word(cursor.peek(), "ROOT")) {
    cursor.skip_space();
    return HierarchyStart{cursor.position(), 0};
  }
  if (cursor.peek().starts_with('<')) return std::nullopt;  // a web page that shows the file
  HierarchyStart start;
  while (!cursor.at_end()) {
    cursor.skip_space();
    start.offset = cursor.position();
    if (same_word(cursor.peek(), "HIERARCHY")) return start;
    const std::string_view line = cursor.line();
    if (line.find('\0') != std::string_view::npos) return std::nullopt;
    ++start.lines;
  }
  return std::nullopt;
}

Status check_file_kind(std::string_view text, const std::string& file_name) {
  const auto not_bvh = [&](std::string message, std::string hint) -> Status {
    return Error("bvh-kind", std::move(message), std::move(hint)).in_file(file_name);
  };
  const auto content = std::as_bytes(std::span(text));
  const registry::Kind kind = registry::kind_of_content(content);
  if (kind == registry::Kind::bvh) return {};
  if (text.empty()) return not_bvh("the file is empty", "export or copy it again");
  if (is_utf16(text)) return not_bvh("is UTF-16 text", "save it as UTF-8");
  if (text.find_first_not_of(" \t\r\n\v\f") == std::string_view::npos) {
    return not_bvh("the file has only white space", "export or copy it again");
  }
  const std::string_view what = registry::describe_content(content);
  return not_bvh(fmt::format("not a BVH file: it is {}", what), hint_for(kind, what));
}

}  // namespace krok::bvh
