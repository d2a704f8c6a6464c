#include "core/path_inside.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <system_error>

#include "core/text.h"

namespace krok {

namespace fs = std::filesystem;

namespace {

constexpr std::size_t kMaxPath = 4096;  // Linux's own limit

Error outside(const std::string& path, std::string_view why) {
  return Error("path-outside", fmt::format("the path '{}' {}", shown(path), why),
               "files that a file refers to must be in its folder or below");
}

}  // namespace

std::string path_fault(std::string_view path) {
  if (path.empty()) return "is empty";
  if (path.size() > kMaxPath) return "is too long";
  if (!is_utf8(path)) return "is not UTF-8";
  const auto control = [](char c) { return static_cast<unsigned char>(c) < 32 || c == 127; };
  if (std::ranges::any_of(path, control)) return "contains a control character";
  if (path.find('\\') != std::string_view::npos) return "contains a backslash; the separator is /";
  // A colon in the first component belongs to a drive letter or URL scheme.
  const std::string_view first = path.substr(0, path.find('/'));
  if (first.empty() || first.find(':') != std::string_view::npos) return "is not a relative path";
  if (path.ends_with('/') || path.ends_with("/.") || path == ".") return "is a folder";
  for (std::size_t at = 0; at <= path.size();) {
    const std::size_t end = std::min(path.find('/', at), path.size());
    if (path.substr(at, end - at) == "..") return "leaves the folder";
    at = end + 1;
  }
  return {};
}

std::string folder_of(const std::string& path) {
  const std::string folder = fs::path(path).parent_path().string();
  return folder.empty() ? "." : folder;
}

Result<std::string> path_inside(const std::string& folder, const std::string& path) {
  if (const std::string fault = path_fault(path); !fault.empty()) return outside(path, fault);
  std::error_code error;
  const fs::path base = folder.empty() ? "." : folder;
  const fs::path root = fs::weakly_canonical(base, error);
  if (error) return outside(path, "cannot be resolved");
  const fs::path full = fs::weakly_canonical(root / path, error);
  if (error) return outside(path, "cannot be resolved");
  const fs::path inside = full.lexically_relative(root);
  if (inside.empty() || *inside.begin() == "..") {
    return outside(path, "leaves the folder through a symbolic link");
  }
  return base == "." ? path : (base / path).string();
}

}  // namespace krok
