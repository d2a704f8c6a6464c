#include "tools/krok-import/output_set.h"

#include <fmt/format.h>

namespace krok::import {

Status OutputSet::add(const std::string& path, const std::function<Status(OutputFile&)>& write) {
  if (path.empty()) return {};
  for (const auto& [other, file] : files_) {
    if (other == path) return Error("usage", fmt::format("two outputs are named {}", path));
  }
  auto file = OutputFile::create(path, context_.output_options());
  if (!file) return file.error();
  if (Status written = write(*file); !written) return written;
  files_.emplace_back(path, std::move(*file));
  return {};
}

Status OutputSet::finish() {
  for (auto& [path, file] : files_) {
    if (files_.size() == 1) break;
    if (Status done = file.sync(); !done) return done;
  }
  for (auto& [path, file] : files_) {
    if (Status done = file.commit(); !done) return done;
  }
  for (auto& [path, file] : files_) context_.wrote(path);
  return {};
}

std::string OutputSet::names() const {
  std::string names;
  for (const auto& [path, file] : files_) names += (names.empty() ? "" : ", ") + path;
  return names;
}

}  // namespace krok::import
