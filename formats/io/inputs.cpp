#include "formats/io/inputs.h"

#include <fmt/format.h>

#include <filesystem>

#include "core/text.h"
#include "formats/io/open_scene.h"

namespace krok::io {

Address address_of(const std::string& path) {
  std::error_code unknown;
  for (std::size_t mark = path.find('#'); mark != std::string::npos;
       mark = path.find('#', mark + 1)) {
    const std::string file = path.substr(0, mark);
    if (!is_scene(registry::kind_of_name(file)) || std::filesystem::exists(path, unknown)) continue;
    if (std::filesystem::exists(file, unknown)) return {file, path.substr(mark + 1)};
  }
  return {path, {}};
}

Result<InputFile> open_address(const std::string& path) {
  Address address = address_of(path);
  auto file = InputFile::open(address.file);
  if (file && file->text().starts_with("version https://git-lfs.")) {
    return Error("file-lfs", "is a Git LFS pointer, not the file itself",
                 "fetch the file with: git lfs pull")
        .in_file(address.file);
  }
  std::error_code unknown;
  const std::size_t mark = path.find_last_of(":@|");
  if (!file && file.error().code == "file-missing" && mark != std::string::npos &&
      std::filesystem::is_regular_file(path.substr(0, mark), unknown)) {
    Error error = std::move(file).error();
    error.hint = fmt::format("an animation of a file is '{}#{}', in quotes",
                             shown(path.substr(0, mark)), shown(path.substr(mark + 1)));
    return error;
  }
  if (file) file->choose_part(std::move(address.animation));
  return file;
}

Inputs::~Inputs() = default;

void Inputs::diagnose(const Diagnostics& diagnostics) {
  for (const Diagnostic& diagnostic : diagnostics) diagnose(diagnostic);
}

void Inputs::diagnose_in(const std::string& path, const Diagnostics& diagnostics) {
  for (Diagnostic diagnostic : diagnostics) {
    if (diagnostic.where.file.empty()) diagnostic.where.file = path;
    diagnose(std::move(diagnostic));
  }
}

Result<InputFile> PlainInputs::open_input(const std::string& path) {
  return open_address(path);
}

void PlainInputs::diagnose(Diagnostic diagnostic) {
  diagnostics.push_back(std::move(diagnostic));
}

}  // namespace krok::io
