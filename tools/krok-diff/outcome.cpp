#include "outcome.h"

#include <fmt/format.h>

#include <cmath>

#include "core/numbers.h"

namespace krok::diff {

namespace {

constexpr int kDigits = 3;

std::string in_unit(double value, Unit unit) {
  if (!std::isfinite(value)) return "not a number";
  switch (unit) {
    case Unit::length:
      return value < 1.0 ? readable(value * 1000, kDigits) + " mm"
                         : readable(value, kDigits) + " m";
    case Unit::angle:
      return readable(value / kRadiansPerDegree, kDigits) + " deg";
    case Unit::ratio:
      break;
  }
  return readable(value, kDigits);
}

const char* unit_name(Unit unit) {
  switch (unit) {
    case Unit::length:
      return "m";
    case Unit::angle:
      return "rad";
    case Unit::ratio:
      break;
  }
  return "1";
}

// The name at an index, empty where there is none.
std::string name_at(const std::vector<std::string>& names, int index) {
  const auto i = static_cast<std::size_t>(index);
  return index >= 0 && i < names.size() ? names[i] : std::string();
}

std::string named(const char* kind, const std::vector<std::string>& names, int index) {
  const std::string name = name_at(names, index);
  return name.empty() ? fmt::format("{} {}", kind, index) : fmt::format("{} {}", kind, name);
}

std::vector<std::string> target_names(const PlaceNames& names, int mesh) {
  const auto i = static_cast<std::size_t>(mesh);
  return mesh >= 0 && i < names.targets.size() ? names.targets[i] : std::vector<std::string>();
}

std::string to_text(const compare::Place& place, const PlaceNames& names) {
  std::vector<std::string> parts;
  if (place.vertex >= 0) {
    parts.push_back(fmt::format("vertex {}", place.vertex));
    if (place.mesh >= 0) parts.back() += " of " + named("mesh", names.meshes, place.mesh);
  }
  if (place.target >= 0) {
    parts.push_back(named("target", target_names(names, place.mesh), place.target));
  }
  if (place.joint >= 0) parts.push_back(named("joint", names.joints, place.joint));
  if (place.animation >= 0) {
    parts.push_back(named("animation", names.animations, place.animation));
  }
  if (place.frame >= 0) {
    parts.push_back(fmt::format("frame {} ({} s)", place.frame, readable(place.time, 4)));
  }
  return fmt::format("{}", fmt::join(parts, ", "));
}

Json to_json(const compare::Place& place, const PlaceNames& names) {
  Json json = Json::object();
  const auto add = [&](const char* key, int index, const std::string& name) {
    if (index < 0) return;
    json[std::string(key) + "_index"] = index;
    if (!name.empty()) json[key] = name;
  };
  add("mesh", place.mesh, name_at(names.meshes, place.mesh));
  if (place.vertex >= 0) json["vertex"] = place.vertex;
  add("target", place.target, name_at(target_names(names, place.mesh), place.target));
  add("joint", place.joint, name_at(names.joints, place.joint));
  add("animation", place.animation, name_at(names.animations, place.animation));
  if (place.frame >= 0) {
    json["frame"] = place.frame;
    json["time"] = place.time;
  }
  return json;
}

std::string to_text(const Row& row, const PlaceNames& names) {
  const compare::Measure& measure = row.measure;
  if (measure.largest == 0) {
    return fmt::format("{}: equal in all {}", row.what, grouped(measure.count));
  }
  std::string text =
      fmt::format("{}: largest {} at {}; RMS {}", row.what, in_unit(measure.largest, row.unit),
                  to_text(measure.where, names), in_unit(measure.rms(), row.unit));
  text += measure.over == 0 ? fmt::format("; within in all {}", grouped(measure.count))
                            : fmt::format("; over tolerance in {} of {}", grouped(measure.over),
                                          grouped(measure.count));
  return text;
}

// Only the tolerances that were needed.
std::string tolerances(const Outcome& outcome, const compare::Tolerance& tolerance) {
  std::string text = fmt::format("{}, {}", in_unit(tolerance.length, Unit::length),
                                 in_unit(tolerance.angle, Unit::angle));
  for (const Row& row : outcome.rows) {
    if (row.unit != Unit::ratio) continue;
    return text + ", ratio " + readable(tolerance.ratio);
  }
  return text;
}

}  // namespace

void Outcome::add_row(std::string what, Unit unit, const compare::Measure& measure) {
  if (measure.count > 0) rows.push_back({std::move(what), unit, measure});
}

std::string to_text(const Outcome& outcome, const compare::Tolerance& tolerance) {
  std::string text;
  for (const std::string& line : outcome.summary) text += (text.empty() ? "" : "  ") + line + "\n";
  for (const std::string& line : outcome.structure) text += "  differs: " + line + "\n";
  for (const std::string& line : outcome.notes) text += "  note: " + line + "\n";
  bool measured_over = false;
  for (const Row& row : outcome.rows) {
    text += "  " + to_text(row, outcome.names) + "\n";
    measured_over = measured_over || !row.measure.within();
  }
  if (outcome.same) {
    text += fmt::format("the same within {}\n", tolerances(outcome, tolerance));
  } else if (measured_over) {
    text += fmt::format("beyond tolerance ({})\n", tolerances(outcome, tolerance));
  } else {
    text += "not the same\n";
  }
  return text;
}

Json to_json(const Outcome& outcome, const compare::Tolerance& tolerance) {
  Json json;
  json["kind"] = outcome.kind;
  json["same"] = outcome.same;
  json["summary"] = outcome.summary;
  json["tolerance"] = {
      {"length", tolerance.length}, {"angle", tolerance.angle}, {"ratio", tolerance.ratio}};
  json["structure"] = outcome.structure;
  json["notes"] = outcome.notes;
  json["measures"] = Json::array();
  for (const Row& row : outcome.rows) {
    const compare::Measure& measure = row.measure;
    Json entry;
    entry["what"] = row.what;
    entry["unit"] = unit_name(row.unit);
    entry["largest"] = measure.largest;
    entry["rms"] = measure.rms();
    entry["tolerance"] = measure.tolerance;
    entry["over"] = measure.over;
    entry["count"] = measure.count;
    entry["where"] = measure.largest > 0 ? to_json(measure.where, outcome.names) : Json();
    json["measures"].push_back(std::move(entry));
  }
  return json;
}

}  // namespace krok::diff
