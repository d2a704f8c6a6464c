#include "tools/krok-info/description.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <functional>
#include <map>
#include <set>

#include "core/text.h"

namespace krok::cli::info {

void Description::add(std::string label, std::string line) {
  rows.push_back({std::move(label), {std::move(line)}});
}

void Description::add(std::string label, std::vector<std::string> lines) {
  if (!lines.empty()) rows.push_back({std::move(label), std::move(lines)});
}

std::string to_text(const std::string& path, const Description& description) {
  std::size_t width = 0;
  for (const auto& row : description.rows) width = std::max(width, row.label.size());
  std::string text = fmt::format("{}: {}\n", printable(path), description.what);
  for (const auto& row : description.rows) {
    std::string label = row.label;
    for (const std::string& line : row.lines) {
      text += fmt::format("  {:<{}}  {}\n", label, width, printable(line));
      label.clear();
    }
  }
  return text;
}

void add_choice(const std::string& key, const Choice& choice, Description& out) {
  const std::string why = choice.reason.empty() ? std::string() : ": " + choice.reason;
  out.add(key, fmt::format("{} ({}{})", choice.choice, confidence_name(choice.confidence), why));
  out.json[key] = {{"choice", choice.choice},
                   {"confidence", confidence_name(choice.confidence)},
                   {"reason", choice.reason}};
}

void add_conventions(const Conventions& conventions, Description& out) {
  const Unit& unit = conventions.unit;
  const std::string size = unit.name == "m" ? "" : fmt::format(", {} m", readable(unit.metres));
  add_choice("unit", {unit.name + size, conventions.unit_reason, conventions.unit_confidence}, out);
  out.json["unit"]["metres"] = unit.metres;
  const auto axis = [&](const char* key, Direction direction, const std::string& reason,
                        Confidence confidence) {
    add_choice(key, {std::string(direction_name(direction)), reason, confidence}, out);
  };
  axis("up", conventions.up, conventions.up_reason, conventions.up_confidence);
  axis("forward", conventions.forward, conventions.forward_reason, conventions.forward_confidence);
}

void add_timing(int frames, double rate, Description& out) {
  const double duration = frames < 2 ? 0.0 : (frames - 1) / rate;
  out.add("frames", fmt::format("{} at {} frames/s", grouped(frames), readable(rate)));
  out.add("duration", readable(duration, 4) + " s");
  out.json["frames"] = frames;
  out.json["rate"] = rate;
  out.json["duration"] = duration;
}

void add_size(const Eigen::AlignedBox3d& box, const std::string& measured, Description& out) {
  if (box.isEmpty()) return;
  const Vec3 size = box.sizes();
  out.add("size", fmt::format("{} x {} x {} m (X, Y, Z; {})", readable(size.x(), 4),
                              readable(size.y(), 4), readable(size.z(), 4), measured));
  const auto range = [&](char name, int axis) {
    return fmt::format("{} {} to {}", name, readable(box.min()[axis] + 0.0, 4),
                       readable(box.max()[axis] + 0.0, 4));
  };
  const auto level = [](const Vec3& point) { return Vec3(point.x(), 0, point.z()); };
  // A reference pose away from the origin comes out elsewhere than where it is placed.
  const double away = level(box.center()).norm();
  const bool elsewhere = away > std::max(0.5, level(size).norm());
  out.add("extent",
          fmt::format("{}, {}, {} m{}", range('X', 0), range('Y', 1), range('Z', 2),
                      elsewhere ? fmt::format("; {} m from the origin", readable(away, 3)) : ""));
  out.json["min"] = {box.min().x(), box.min().y(), box.min().z()};
  out.json["max"] = {box.max().x(), box.max().y(), box.max().z()};
  out.json["size"] = {size.x(), size.y(), size.z()};
  out.json["height"] = size.y();
  out.json["measured"] = measured;
}

void add_provenance(const Provenance& provenance, Description& out) {
  Json json = Json::object();
  json["tool"] = provenance.tool;
  json["version"] = provenance.version;
  json["sources"] = Json::array();
  std::vector<std::string> sources;
  for (const auto& source : provenance.sources) {
    json["sources"].push_back({{"name", source.name}, {"xxh3", source.xxh3}});
    sources.push_back(source.xxh3.empty() ? source.name
                                          : fmt::format("{} (xxh3 {})", source.name, source.xxh3));
  }
  json["options"] = Json::array();
  std::vector<std::string> options;
  for (const auto& [name, value] : provenance.options) {
    json["options"].push_back({{"name", name}, {"value", value}});
    options.push_back(value == "true" ? "--" + name : fmt::format("--{} {}", name, value));
  }
  json["conversions"] = provenance.conversions;
  json["warnings"] = provenance.warnings;
  if (const auto& removed = provenance.removed_root_motion) {
    const Vec3& v = removed->velocity;
    const double turn_rate = removed->turn_rate / kRadiansPerDegree;
    json["removed_root_motion"] = {{"velocity", {v.x(), v.y(), v.z()}}, {"turn_rate", turn_rate}};
    out.add("root motion",
            fmt::format("removed: {} m/s ({}, {}, {}), {} deg/s", readable(v.norm(), 4),
                        readable(v.x(), 4), readable(v.y(), 4), readable(v.z(), 4),
                        readable(turn_rate, 4)));
  }
  out.json["provenance"] = std::move(json);

  if (provenance.tool.empty()) {
    out.add("made by", "unknown, not stored in the file");
  } else {
    out.add("made by", fmt::format("{} {}", provenance.tool, provenance.version));
  }
  out.add("from", std::move(sources));
  out.add("options", std::move(options));
  out.add("conversions", provenance.conversions);
  out.add("warnings", provenance.warnings);
}

void add_volumes(const std::vector<NamedVolume>& volumes, Description& out) {
  constexpr double kLitres = 1000;  // per cubic metre
  std::vector<std::string> lines;
  out.json["volumes"] = Json::array();
  for (const auto& [mesh, measured] : volumes) {
    const bool known = measured.closed && std::isfinite(measured.volume);
    out.json["volumes"].push_back({{"mesh", mesh},
                                   {"volume", known ? Json(measured.volume) : Json()},
                                   {"area", measured.area}});
    if (!known) continue;
    lines.push_back(fmt::format("{}{} litres", mesh.empty() ? "" : mesh + ": ",
                                readable(measured.volume * kLitres, 4)));
  }
  out.add("volume", std::move(lines));
}

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
