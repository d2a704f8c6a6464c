#include "formats/io/formats.h"

#include <algorithm>
#include <array>

#include "formats/io/readers_internal.h"

namespace krok::io {

namespace {

using registry::Kind;

#define KROK_ROW(kind_, group, endings, description, recognised, ...) \
  Format{.kind = Kind::kind_ __VA_OPT__(, ) __VA_ARGS__},
constexpr auto kOwnFormats = std::to_array<Format>({KROK_FORMATS(KROK_ROW)});
#undef KROK_ROW

constexpr Format kNone;

std::vector<Format>& table() {
  static std::vector<Format> rows(kOwnFormats.begin(), kOwnFormats.end());
  return rows;
}

}  // namespace

std::span<const Format> formats() {
  return table();
}

void add_format(const Format& format) {
  table().push_back(format);
}

const Format& format_of(Kind kind) {
  if (kind == Kind::unknown) return kNone;
  const auto found = std::ranges::find(table(), kind, &Format::kind);
  return found == table().end() ? kNone : *found;
}

const Format& format_of(const InputFile& file) {
  const Kind kind = registry::identify(file.path(), file.bytes());
  if (kind != Kind::unknown) return format_of(kind);
  for (const Format& format : table()) {
    if (format.recognises != nullptr && format.recognises(file.bytes())) return format;
  }
  const std::string ending = extension(file.path());
  for (const Format& format : table()) {
    if (!format.ending.empty() && ending == "." + std::string(format.ending)) return format;
  }
  return kNone;
}

bool is_motion(const InputFile& file) {
  const Format& format = format_of(file);
  return format.reads_motion() && format.read_scene == nullptr;
}

std::vector<std::string> endings(bool (*wanted)(const Format& format)) {
  std::vector<std::string> endings;
  for (const Format& format : table()) {
    if (!wanted(format)) continue;
    if (!format.ending.empty()) endings.push_back("." + std::string(format.ending));
    for (std::string& one : registry::endings_of(format.kind)) endings.push_back(std::move(one));
  }
  return endings;
}

std::vector<std::string> motion_endings() {
  return endings([](const Format& format) { return format.reads_motion(); });
}

std::vector<std::string> foreign_motion_endings() {
  return endings(
      [](const Format& format) { return format.reads_motion() && format.kind != Kind::anim; });
}

}  // namespace krok::io
