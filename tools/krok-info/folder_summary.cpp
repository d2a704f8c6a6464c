#include "tools/krok-info/description.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <functional>
#include <map>
#include <set>
#include <utility>
#include <vector>

#include "core/numbers.h"
#include "core/text.h"

namespace krok::cli::info {

namespace {

constexpr std::size_t kColumns = 7;
using Row = std::array<std::string, kColumns>;

template <typename Value>
Value value_or(const Json& file, const char* key, Value other) {
  const auto found = file.find(key);
  return found == file.end() || found->is_null() ? other : found->get<Value>();
}

// Of all animations of a scene.
double seconds_of(const Json& file) {
  double seconds = value_or(file, "duration", 0.0);
  for (const Json& animation : value_or(file, "animations", Json::array())) {
    seconds += animation["duration"].get<double>();
  }
  return seconds;
}

Row row_of(const Json& file) {
  Row row = {printable(file["path"].get<std::string>()),
             value_or<std::string>(file, "kind", "not read")};
  if (file.contains("frames")) {
    row[2] = grouped(file["frames"].get<long long>());
    row[3] = readable(file["rate"].get<double>(), 4);
  } else if (const auto count = value_or(file, "animations", Json::array()).size(); count > 0) {
    row[2] = counted(count, "animation");
  }
  if (const double seconds = seconds_of(file); seconds > 0) row[4] = fmt::format("{:.2f}", seconds);
  if (file.contains("joints")) row[5] = std::to_string(file["joints"].get<int>());
  if (value_or(file, "humanoid", false)) row[6] = "humanoid";
  const bool meshes = !value_or(file, "meshes", Json::array()).empty();
  if (meshes || file.contains("vertices")) row[6] += row[6].empty() ? "mesh" : ", mesh";
  return row;
}

// How many files are of each value of a key, the commonest first: "12 bvh, 3 anim".
std::string counts(const std::map<std::string, int>& of) {
  std::vector<std::pair<std::string, int>> sorted(of.begin(), of.end());
  std::ranges::stable_sort(sorted, std::greater(), &std::pair<std::string, int>::second);
  std::string text;
  for (const auto& [name, count] : sorted) {
    text += fmt::format("{}{} {}", text.empty() ? "" : ", ", count, name);
  }
  return text;
}

}  // namespace

std::string folder_summary(const Json& files) {
  std::vector<Row> rows = {{"file", "kind", "frames", "fps", "seconds", "joints", "body"}};
  std::map<std::string, int> kinds, rates;
  std::set<std::string> skeletons;
  double seconds = 0;
  long long frames = 0;
  std::size_t animations = 0;
  for (const Json& file : files) {
    rows.push_back(row_of(file));
    ++kinds[rows.back()[1]];
    seconds += seconds_of(file);
    animations += value_or(file, "animations", Json::array()).size();
    if (file.contains("frames")) {
      frames += file["frames"].get<long long>();
      ++rates["at " + rows.back()[3] + " fps"];
    }
    std::string names;
    for (const Json& joint : value_or(file, "skeleton", Json::array())) {
      names += joint["joint"].get<std::string>() + '\n';
    }
    if (!names.empty()) skeletons.insert(std::move(names));
  }
  std::array<std::size_t, kColumns> widths = {};
  for (const Row& row : rows) {
    for (std::size_t c = 0; c < kColumns; ++c) widths[c] = std::max(widths[c], row[c].size());
  }
  std::string text;
  for (const Row& row : rows) {
    std::string line;
    for (std::size_t c = 0; c < kColumns; ++c) {
      const bool number = c >= 2 && c <= 5;
      line += number ? fmt::format("  {:>{}}", row[c], widths[c])
                     : fmt::format("{}{:<{}}", c == 0 ? "" : "  ", row[c], widths[c]);
    }
    text += line.substr(0, line.find_last_not_of(' ') + 1) + '\n';
  }
  text += fmt::format("\n{}: {}\n", counted(files.size(), "file"), counts(kinds));
  if (animations > 0) text += counted(animations, "animation") + " in scenes\n";
  if (!rates.empty()) {
    text += fmt::format("{} in {:.1f} s ({:.1f} min): {}\n", counted(frames, "frame"), seconds,
                        seconds / 60, counts(rates));
  }
  if (!skeletons.empty()) {
    text += counted(skeletons.size(), "skeleton") + " by joint names\n";
  }
  return text;
}

}  // namespace krok::cli::info
