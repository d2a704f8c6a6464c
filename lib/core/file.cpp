#include "core/file.h"

#include <algorithm>
#include <cctype>
#include <cstring>

#include "core/temporary_files_internal.h"

namespace krok {

Error file_error(const char* code, const std::string& path, std::string message, std::string hint) {
  return Error(code, std::move(message), std::move(hint)).in_file(path);
}

std::string system_text(int error_number) {
  return std::strerror(error_number);
}

std::string base_name(const std::string& path) {
  return std::filesystem::path(path).filename().string();
}

std::string extension(const std::string& path) {
  std::string text = std::filesystem::path(path).extension().string();
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

}  // namespace krok
