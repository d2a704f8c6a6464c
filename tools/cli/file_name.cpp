#include "tools/cli/file_name.h"

#include <fmt/format.h>

#include <filesystem>
#include <string_view>
#include <system_error>

#include "core/file.h"
#include "core/numbers.h"
#include "core/text.h"
#include "formats/io/inputs.h"

namespace krok::cli {

std::string file_name_of(const std::string& name) {
  std::string result;
  for (const char c : printable(to_utf8(name))) {
    const bool odd = std::string_view("/\\:*?\"<>|{}$`'&;!").find(c) != std::string_view::npos;
    result += odd ? '_' : c;
  }
  while (result.starts_with('.') || result.starts_with('-')) result[0] = '_';
  if (result.size() > 100) {
    std::size_t end = 100;
    while ((static_cast<unsigned char>(result[end]) & 0xC0) == 0x80) --end;
    result.resize(end);
  }
  return result;
}

std::string uri_of(const std::string& path) {
  std::string uri;
  for (const char c : path) {
    const bool plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
                       std::string_view("-._~/").find(c) != std::string_view::npos;
    uri += plain ? std::string(1, c) : fmt::format("%{:02X}", static_cast<unsigned char>(c));
  }
  return uri;
}

std::string beside(const std::string& path, const std::string& ending) {
  std::filesystem::path result = path;
  if (!result.has_filename()) result = result.parent_path();
  std::error_code unknown;
  const bool folder = std::filesystem::is_directory(result, unknown);
  if (path == "-" || !result.has_filename() || result.filename() == ".") return {};
  return (folder ? result.string() : path_without_ending(result.string())) + ending;
}

std::string name_of_input(const std::string& path) {
  return path == "-" ? "standard input" : base_name(path);
}

std::string path_without_ending(const std::string& path) {
  const auto [file, animation] = io::address_of(path);
  const std::string stem = std::filesystem::path(file).replace_extension().string();
  return animation.empty() ? stem : stem + "_" + file_name_of(animation);
}

std::string clip_name_of(const std::string& path) {
  const std::string animation = io::address_of(path).animation;
  if (!animation.empty() && !parse_integer(animation)) return to_utf8(animation);
  if (!animation.empty()) return to_utf8(base_name(path_without_ending(path)));
  const std::string name = base_name(path);
  const std::string stem = name.substr(0, name.size() - extension(path).size());
  return path == "-" || stem.empty() ? "motion" : to_utf8(stem);
}

NamedPath named_path(const std::string& text) {
  const std::size_t equals = text.find('=');
  std::error_code unknown;
  const bool named = equals != std::string::npos && equals > 0 && text.find('/') > equals &&
                     !std::filesystem::exists(text, unknown);
  if (!named) return {{}, text};
  return {to_utf8(text.substr(0, equals)), text.substr(equals + 1)};
}

}  // namespace krok::cli
