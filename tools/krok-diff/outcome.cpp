#include "tools/krok-diff/outcome.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/numbers.h"

namespace krok::cli::diff {

namespace {

constexpr int kDigits = 3;
constexpr const char* kHandedness = "handedness of tangents";

// One unit for each quantity, so that values in a table compare.
std::string in_unit(double value, Unit unit) {
  if (!std::isfinite(value)) return "not a number";
  switch (unit) {
    case Unit::length:
      return readable(value * 1000, kDigits) + " mm";
    case Unit::angle:
      return readable(value / kRadiansPerDegree, kDigits) + " deg";
    case Unit::time:
      return readable(value * 1000, kDigits) + " ms";
    case Unit::side:
      return value > 0 ? "flipped" : "equal";
    case Unit::ratio:
      break;
  }
  return readable(value, kDigits);
}

const char* unit_name(Unit unit) {
  constexpr std::array kNames = {"m", "deg", "1", "s", "1"};  // [Unit]
  return kNames[static_cast<std::size_t>(unit)];
}

// The name at an index; empty if there is none.
std::string name_at(const std::vector<std::string>& names, int index) {
  const auto i = static_cast<std::size_t>(index);
  return index >= 0 && i < names.size() ? names[i] : std::string();
}

std::string named(const char* kind, const std::vector<std::string>& names, int index) {
  const std::string name = name_at(names, index);
  return name.empty() ? fmt::format("{} {}", kind, index) : fmt::format("{} {}", kind, name);
}

const std::vector<std::string>& mesh_names(const compare::ValueLocation& place,
                                           const PlaceNames& names) {
  return place.in_second ? names.second_meshes : names.meshes;
}

std::vector<std::string> target_names(const PlaceNames& names, int mesh) {
  const auto i = static_cast<std::size_t>(std::max(mesh, 0));  // morph target files have no mesh
  return i < names.targets.size() ? names.targets[i] : std::vector<std::string>();
}

std::string to_text(const compare::ValueLocation& place, const PlaceNames& names) {
  std::vector<std::string> parts;
  if (place.vertex >= 0) {
    parts.push_back(fmt::format("vertex {}", place.vertex));
    if (place.mesh >= 0) {
      parts.back() += place.in_second ? " of the second's " : " of ";
      parts.back() += named("mesh", mesh_names(place, names), place.mesh);
    }
  }
  if (place.target >= 0) {
    parts.push_back(named("target", target_names(names, place.mesh), place.target));
  }
  if (place.joint >= 0) parts.push_back(named("joint", names.joints, place.joint));
  if (place.animation >= 0) {
    parts.push_back(named("animation", names.animations, place.animation));
  }
  if (place.frame >= 0) {
    parts.push_back(fmt::format("{}frame {} ({} s)", place.after_frame ? "after " : "", place.frame,
                                readable(place.time, 4)));
  }
  return fmt::format("{}", fmt::join(parts, ", "));
}

Json to_json(const compare::ValueLocation& place, const PlaceNames& names) {
  Json json = Json::object();
  const auto add = [&](const char* key, int index, const std::string& name) {
    if (index < 0) return;
    json[std::string(key) + "_index"] = index;
    if (!name.empty()) json[key] = name;
  };
  if (place.in_second) json["in"] = "second";
  add("mesh", place.mesh, name_at(mesh_names(place, names), place.mesh));
  if (place.mesh >= 0) {
    const auto& files = place.in_second ? names.second_files : names.first_files;
    const auto i = static_cast<std::size_t>(place.mesh);
    if (i < files.size() && !files[i].first.empty()) json["node_name"] = files[i].first;
    if (i < files.size() && !files[i].second.empty()) json["mesh_name"] = files[i].second;
  }
  if (place.vertex >= 0) json["vertex"] = place.vertex;
  add("target", place.target, name_at(target_names(names, place.mesh), place.target));
  add("joint", place.joint, name_at(names.joints, place.joint));
  add("animation", place.animation, name_at(names.animations, place.animation));
  if (place.frame >= 0) {
    json[place.after_frame ? "after_frame" : "frame"] = place.frame;
    json["time"] = place.time;
  }
  return json;
}

std::string to_text(const Row& row, const PlaceNames& names) {
  const compare::Measure& measure = row.measure;
  if (measure.largest == 0) {
    return fmt::format("{}: equal in all {}", row.what, grouped(measure.count));
  }
  if (row.unit == Unit::side) {
    return fmt::format("{}: {} at {}; in {} of {}", row.what, in_unit(measure.largest, row.unit),
                       to_text(measure.where, names), grouped(measure.over),
                       grouped(measure.count));
  }
  std::string text = fmt::format(
      "{}: largest {}{} at {}; RMS {}, 95 % {}", row.what, row.at_least ? "at least " : "",
      in_unit(measure.largest, row.unit), to_text(measure.where, names),
      in_unit(measure.rms(), row.unit), in_unit(measure.percentile(0.95), row.unit));
  if (std::isinf(measure.tolerance)) return text + "; not counted";
  text += measure.over == 0 ? fmt::format("; within in all {}", grouped(measure.count))
                            : fmt::format("; over tolerance in {} of {}", grouped(measure.over),
                                          grouped(measure.count));
  return text;
}

Json to_json(const Row& row, const PlaceNames& names) {
  const compare::Measure& measure = row.measure;
  Json entry;
  entry["what"] = row.what;
  entry["unit"] = unit_name(row.unit);
  const auto reported = [&](double value) {
    return row.unit == Unit::angle ? to_degrees(value) : value;
  };
  entry["largest"] = reported(measure.largest);
  entry["mean"] = reported(measure.mean());
  entry["rms"] = reported(measure.rms());
  entry["percentile_95"] = reported(measure.percentile(0.95));
  entry["tolerance"] = reported(measure.tolerance);
  entry["over"] = measure.over;
  entry["count"] = measure.count;
  if (row.at_least) entry["at_least"] = true;
  entry["where"] = measure.largest > 0 ? to_json(measure.where, names) : Json();
  return entry;
}

Json to_json(const std::vector<Item>& items, const PlaceNames& names) {
  Json list = Json::array();
  for (const Item& item : items) {
    Json entry = to_json(item.place, names);
    entry["measures"] = Json::array();
    for (const Row& row : item.rows) entry["measures"].push_back(to_json(row, names));
    list.push_back(std::move(entry));
  }
  return list;
}

// The ratio of a difference to its tolerance; 0 if it is within.
double excess_of(const compare::Measure& measure) {
  return measure.within() ? 0.0 : measure.largest / std::max(measure.tolerance, 1e-12);
}

// What is farthest beyond its tolerance, of what shows where something does: a reference pose may
// differ where the motion does not. Null if nothing measured is.
const Row* worst_row(const Outcome& outcome) {
  const auto rank = [](const Row& row) {
    return std::pair(!row.what.starts_with("reference "), excess_of(row.measure));
  };
  const Row* worst = nullptr;
  for (const Row& row : outcome.rows) {
    if (row.measure.within()) continue;
    if (worst == nullptr || rank(row) > rank(*worst)) worst = &row;
  }
  return worst;
}

// "positions 28.6 mm (286 x the tolerance) at vertex 12 of body, frame 32 (1.067 s)"
std::string to_text(const Row& row, const Outcome& outcome) {
  const compare::Measure& measure = row.measure;
  // --tolerance is of lengths.
  const std::string which =
      row.unit == Unit::length ? "" : " of " + in_unit(measure.tolerance, row.unit);
  const std::string excess =
      measure.tolerance > 0
          ? fmt::format(" ({} x the tolerance{})", readable(excess_of(measure), kDigits), which)
          : "";
  return fmt::format("{} {}{}{} at {}", row.what, row.at_least ? "at least " : "",
                     in_unit(measure.largest, row.unit), excess,
                     to_text(measure.where, outcome.names));
}

// The largest of an item.
double excess_of(const Item& item) {
  double most = 0;
  for (const Row& row : item.rows) most = std::max(most, excess_of(row.measure));
  return most;
}

// "LeftHand: positions up to 0.32 mm, RMS 0.04 mm, 95 % 0.1 mm (frame 37 (0.6167 s))"
std::string to_text(const Item& item, const PlaceNames& names) {
  std::string text = item.place.joint >= 0
                         ? named("joint", names.joints, item.place.joint)
                         : named("mesh", mesh_names(item.place, names), item.place.mesh);
  if (item.place.in_second) text = "the second's " + text;
  const char* before = ": ";
  for (const Row& row : item.rows) {
    const compare::Measure& measure = row.measure;
    if (measure.within()) continue;
    const std::string largest = in_unit(measure.largest, row.unit);
    text += before + row.what;
    text +=
        row.unit == Unit::side
            ? fmt::format(" {} in {} of {}", largest, grouped(measure.over), grouped(measure.count))
            : fmt::format(" up to {}, RMS {}, 95 % {}", largest, in_unit(measure.rms(), row.unit),
                          in_unit(measure.percentile(0.95), row.unit));
    before = "; ";
  }
  return text;
}

// The worst items, if there are several.
std::string worst_items(const std::vector<Item>& items, const char* title,
                        const PlaceNames& names) {
  constexpr std::size_t kShown = 5;
  std::vector<const Item*> worst;
  for (const Item& item : items) {
    if (excess_of(item) > 0) worst.push_back(&item);
  }
  if (worst.empty() || items.size() < 2) return {};
  std::stable_sort(worst.begin(), worst.end(),
                   [](const Item* a, const Item* b) { return excess_of(*a) > excess_of(*b); });
  std::string text = fmt::format("  {} beyond tolerance, {} of {}{}:\n", title, worst.size(),
                                 items.size(), worst.size() > kShown ? "; the worst" : "");
  worst.resize(std::min(worst.size(), kShown));
  for (const Item* item : worst) text += "    " + to_text(*item, names) + "\n";
  return text;
}

// Only the tolerances that were used.
std::string tolerances(const Outcome& outcome, const compare::Tolerance& tolerance) {
  std::string text = fmt::format("{}, {}", in_unit(tolerance.length, Unit::length),
                                 in_unit(tolerance.angle, Unit::angle));
  const bool ratio = std::any_of(outcome.rows.begin(), outcome.rows.end(),
                                 [](const Row& row) { return row.unit == Unit::ratio; });
  if (ratio) text += ", ratio " + readable(tolerance.ratio);
  if (tolerance.normals) text += ", normals " + in_unit(*tolerance.normals, Unit::angle);
  if (tolerance.joint_positions) {
    text += ", joints " + in_unit(*tolerance.joint_positions, Unit::length);
  }
  if (tolerance.joint_orientations) {
    text += " and " + in_unit(*tolerance.joint_orientations, Unit::angle);
  }
  return text;
}

// The option that sets the tolerance of what is beyond it, if that is none of lengths, for which
// users look first: "--angle sets the tolerance of orientations". Empty otherwise.
std::string option_for(const Outcome& outcome, const compare::Tolerance& tolerance) {
  const Row* const worst = worst_row(outcome);
  if (worst == nullptr || worst->unit == Unit::side) return {};
  const bool lengths = std::ranges::any_of(outcome.rows, [](const Row& row) {
    return row.unit == Unit::length && !row.measure.within();
  });
  if (lengths) return {};
  const auto option = [&] {
    if (worst->unit == Unit::ratio) return "--ratio";
    if (worst->unit == Unit::time) return "--times";
    if (tolerance.normals && worst->what == "normals") return "--normals";
    const bool joints = tolerance.joint_orientations && worst->what.ends_with("orientations");
    return joints ? "--joint-tolerance" : "--angle";
  };
  return fmt::format("; {} sets the tolerance of {}", option(), worst->what);
}

}  // namespace

void Outcome::add_row(std::string what, Unit unit, const compare::Measure& measure) {
  const bool lower_bound = at_least && what == "positions";
  if (measure.count > 0) rows.push_back({std::move(what), unit, measure, lower_bound});
}

void Outcome::add_tangents(const compare::Measure& directions, const compare::Measure& sides) {
  add_row("tangents", Unit::angle, directions);
  if (!sides.within()) add_row(kHandedness, Unit::side, sides);
}

void Outcome::add_parts(const std::vector<compare::PartDifference>& parts) {
  for (const compare::PartDifference& part : parts) {
    Item item;
    item.place = {.mesh = part.mesh, .in_second = part.in_second};
    if (part.positions.count > 0) item.rows.push_back({"positions", Unit::length, part.positions});
    if (part.normals.count > 0) item.rows.push_back({"normals", Unit::angle, part.normals});
    if (part.tangents.count > 0) item.rows.push_back({"tangents", Unit::angle, part.tangents});
    if (!part.tangent_sides.within()) {
      item.rows.push_back({kHandedness, Unit::side, part.tangent_sides});
    }
    meshes.push_back(std::move(item));
  }
}

void Outcome::add_joints(const std::vector<compare::JointDifference>& found) {
  for (const compare::JointDifference& joint : found) {
    if (joint.positions.count == 0) continue;
    joints.push_back({{.joint = joint.joint},
                      {{"positions", Unit::length, joint.positions},
                       {"orientations", Unit::angle, joint.orientations}}});
  }
}

std::string to_text(const Outcome& outcome, const compare::Tolerance& tolerance) {
  std::string text;
  for (const std::string& line : outcome.summary) text += (text.empty() ? "" : "  ") + line + "\n";
  const Row* const worst = worst_row(outcome);
  if (worst != nullptr) text += "  differs: " + to_text(*worst, outcome) + "\n";
  for (const std::string& line : outcome.structure) text += "  differs: " + line + "\n";
  for (const std::string& line : outcome.notes) text += "  note: " + line + "\n";
  bool measured_over = false;
  for (const Row& row : outcome.rows) {
    text += "  " + to_text(row, outcome.names) + "\n";
    measured_over = measured_over || !row.measure.within();
  }
  text += worst_items(outcome.meshes, "meshes", outcome.names);
  text += worst_items(outcome.joints, "joints", outcome.names);
  if (outcome.same) {
    text += fmt::format("the same within {}\n", tolerances(outcome, tolerance));
  } else if (measured_over) {
    text += fmt::format("beyond tolerance ({}){}\n", tolerances(outcome, tolerance),
                        option_for(outcome, tolerance));
  } else {
    text += "not the same\n";
  }
  return text;
}

double excess_of(const Outcome& outcome) {
  const Row* const worst = worst_row(outcome);
  if (worst != nullptr) return excess_of(worst->measure);
  return outcome.structure.empty() ? 0 : std::numeric_limits<double>::infinity();
}

std::string worst_of(const Outcome& outcome) {
  const Row* const worst = worst_row(outcome);
  std::vector<std::string> parts;
  if (worst != nullptr) parts.push_back(to_text(*worst, outcome));
  constexpr std::size_t kShown = 2;
  for (std::size_t i = 0; i < std::min(kShown, outcome.structure.size()); ++i) {
    parts.push_back(outcome.structure[i]);
  }
  if (outcome.structure.size() > kShown) {
    parts.push_back(fmt::format("{} more", outcome.structure.size() - kShown));
  }
  // Often the cause: another rate, or vertices in another order.
  if (!outcome.notes.empty()) parts.push_back(outcome.notes.front());
  return fmt::format("{}", fmt::join(parts, "; "));
}

Json to_json(const compare::Tolerance& tolerance) {
  return {{"length", tolerance.length},
          {"angle", to_degrees(tolerance.angle)},
          {"ratio", tolerance.ratio},
          {"time", tolerance.time},
          {"normals", to_degrees(tolerance.of_normals())},
          {"joint_positions", tolerance.of_joint_positions()},
          {"joint_orientations", to_degrees(tolerance.of_joint_orientations())}};
}

Json to_json(const Outcome& outcome, const compare::Tolerance& tolerance) {
  Json json;
  json["kind"] = outcome.kind;
  json["same"] = outcome.same;
  json["summary"] = outcome.summary;
  json["tolerance"] = to_json(tolerance);
  json["structure"] = outcome.structure;
  json["notes"] = outcome.notes;
  json["measures"] = Json::array();
  for (const Row& row : outcome.rows) json["measures"].push_back(to_json(row, outcome.names));
  if (!outcome.meshes.empty()) json["meshes"] = to_json(outcome.meshes, outcome.names);
  if (!outcome.joints.empty()) json["joints"] = to_json(outcome.joints, outcome.names);
  return json;
}

}  // namespace krok::cli::diff
