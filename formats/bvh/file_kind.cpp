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
      return "it is Krok's own already and needs no import";
    default:
      break;
  }
  if (what.find("archive") != std::string_view::npos) return "unpack it first";
  return "give a BVH capture, text that begins with HIERARCHY";
}

}  // namespace

Status check_file_kind(std::string_view text, const std::string& file_name) {
  const auto not_bvh = [&](std::string message, std::string hint) -> Status {
    return Error("bvh-kind", std::move(message), std::move(hint)).in_file(file_name);
  };
  const auto content = std::as_bytes(std::span(text));
  const registry::Kind kind = registry::kind_of_content(content);
  if (kind == registry::Kind::bvh) return {};
  if (text.empty()) return not_bvh("the file is empty", "export or copy it again");
  if (text.starts_with("\xFF\xFE") || text.starts_with("\xFE\xFF")) {
    return not_bvh("is UTF-16 text", "save it as UTF-8");
  }
  if (text.find_first_not_of(" \t\r\n\v\f") == std::string_view::npos) {
    return not_bvh("the file holds nothing but white space", "export or copy it again");
  }
  const std::string_view what = registry::describe_content(content);
  return not_bvh(fmt::format("is no BVH file but {}", what), hint_for(kind, what));
}

}  // namespace krok::bvh
