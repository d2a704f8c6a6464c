#include <fmt/format.h>

#include <map>

#include "core/numbers.h"
#include "formats/ragdoll/ragdoll_format.h"
#include "tools/krok-info/describe.h"

namespace krok::cli::info {

namespace {

std::string_view shape_name(ragdoll::Shape::Kind kind) {
  switch (kind) {
    case ragdoll::Shape::Kind::box:
      return "box";
    case ragdoll::Shape::Kind::capsule:
      return "capsule";
    case ragdoll::Shape::Kind::sphere:
      break;
  }
  return "sphere";
}

// "8 spherical, 4 revolute".
std::string list_of(const std::map<std::string, int>& counts) {
  std::vector<std::string> parts;
  for (const auto& [name, count] : counts) parts.push_back(fmt::format("{} {}", count, name));
  return fmt::format("{}", fmt::join(parts, ", "));
}

}  // namespace

Result<Description> describe_ragdoll(const InputFile& file, ToolContext&) {
  const auto read = ragdoll_file::read(file.text(), nullptr);
  if (!read) return read.error();
  Description out;
  out.what = "bodies and joints (.ragdoll.json)";
  out.json["kind"] = "ragdoll";
  double mass = 0;
  int soft = 0;
  std::map<std::string, int> shapes, kinds, modes;
  std::vector<std::string> lines;
  Json bodies = Json::array();
  for (const ragdoll::Body& body : read->bodies) {
    const std::string shape(shape_name(body.shape.kind));
    mass += body.mass;
    ++shapes[shape];
    ++modes[std::string(body_mode_name(body.mode))];
    lines.push_back(fmt::format("{}: {}, {} kg", body.name, shape, readable(body.mass, 4)));
    bodies.push_back({{"name", body.name}, {"shape", shape}, {"mass", body.mass}});
  }
  for (const ragdoll::JointRule& rule : read->joints) {
    ++kinds[std::string(joint_kind_name(rule.kind))];
    soft += rule.soft ? 1 : 0;
  }
  out.add("bodies", fmt::format("{}: {}", read->bodies.size(), list_of(shapes)));
  if (modes.size() > 1 || !modes.contains("simulated")) out.add("modes", list_of(modes));
  out.add("mass", readable(mass, 6) + " kg");
  out.add("joints", fmt::format("{}: {}", read->joints.size(),
                                read->joints.empty() ? "none" : list_of(kinds)));
  if (soft > 0) out.add("soft limits", counted(soft, "joint"));
  out.add("parts", std::move(lines));
  out.json["mass"] = mass;
  out.json["bodies"] = std::move(bodies);
  out.json["joints"] = kinds;
  return out;
}

}  // namespace krok::cli::info
