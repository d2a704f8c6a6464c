#include "captures/long_capture.h"

#include <fmt/format.h>

#include <vector>

#include "core/file.h"

namespace krok::bench {

namespace {

struct Parts {
  std::string_view before_count, after_count;  // of the number behind "Frames:"
  std::vector<std::string_view> rows;          // with their line ends
};

Result<Parts> split(std::string_view text) {
  constexpr std::string_view kDigits = "0123456789";
  const std::size_t frames = text.find("Frames:");
  const std::size_t count = text.find_first_of(kDigits, frames);
  const std::size_t after = text.find_first_not_of(kDigits, count);
  const std::size_t time = text.find("Frame Time:", after);
  const std::size_t line_end = text.find('\n', time);
  if (line_end == std::string_view::npos) {
    return Error("bench-capture", "is no BVH file that this program understands");
  }
  Parts parts = {text.substr(0, count), text.substr(after, line_end + 1 - after), {}};
  for (std::size_t at = line_end + 1; at < text.size();) {
    const std::size_t end = std::min(text.find('\n', at), text.size() - 1) + 1;
    const std::string_view row = text.substr(at, end - at);
    if (row.find_first_of(kDigits) != std::string_view::npos) parts.rows.push_back(row);
    at = end;
  }
  if (parts.rows.empty()) return Error("bench-capture", "has no frames");
  return parts;
}

}  // namespace

Status write_long_capture(const std::string& from, int frames, const std::string& to) {
  const auto input = InputFile::open(from);
  if (!input) return input.error();
  const auto parts = split(input->text());
  if (!parts) return Error(parts.error()).in_file(from);
  auto file = OutputFile::create(to);
  if (!file) return file.error();
  const std::string head = fmt::format("{}{}{}", parts->before_count, frames, parts->after_count);
  if (Status status = file->write(head); !status) return status;
  for (int frame = 0; frame < frames; ++frame) {
    const std::string_view row = parts->rows[static_cast<std::size_t>(frame) % parts->rows.size()];
    if (Status status = file->write(row); !status) return status;
  }
  return file->commit();
}

}  // namespace krok::bench
