#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>

#include "core/index.h"
#include "core/numbers.h"
#include "core/text.h"
#include "formats/anim/anim.h"
#include "formats/cam/cam.h"
#include "formats/container/sections.h"
#include "formats/correctives/correctives_format.h"
#include "formats/model/model_format.h"
#include "formats/morph_exr/morph_exr.h"
#include "formats/ragdoll/ragdoll_format.h"
#include "formats/textgrid/textgrid.h"
#include "tools/krok-info/describe.h"
#include "tools/krok-info/description.h"

// Morph targets and labels over time.

namespace krok::cli::info {

namespace {

void add_reference_size(const Skeleton& skeleton, Description& out) {
  std::vector<Vec3> positions;
  for (const Transform& joint : skeleton.reference) positions.push_back(joint.position);
  add_size<Vec3>(positions, "joints in the reference pose", out);
}

void add_orientations(const InputFile& file, Description& out) {
  const bool four = stored_orientation(file.bytes()) == OrientationEncoding::xyzw;
  out.add("orientations", four ? "x, y, z, w" : "x, y, z; w is reconstructed");
  out.json["orientations"] = four ? "xyzw" : "xyz";
}

std::string or_none(const std::string& name) {
  return name.empty() ? "(no name)" : name;
}

std::string_view shape_name(ragdoll::Shape::Kind kind) {
  constexpr std::array kNames = {"box", "capsule", "sphere"};  // [Kind]
  return kNames[static_cast<std::size_t>(kind)];
}

// "8 spherical, 4 revolute".
std::string list_of(const std::map<std::string, int>& counts) {
  std::vector<std::string> parts;
  for (const auto& [name, count] : counts) parts.push_back(fmt::format("{} {}", count, name));
  return fmt::format("{}", fmt::join(parts, ", "));
}

}  // namespace

void add_parts(const Model& model, Description& out) {
  out.json["parts"] = Json::array();
  std::vector<std::string> lines;
  for (const Model::Part& part : model.parts) {
    out.json["parts"].push_back(
        {{"name", part.name}, {"material", part.material}, {"triangles", part.triangle_count}});
    lines.push_back(
        fmt::format("{}, {}, {}", or_none(part.name), counted(part.triangle_count, "triangle"),
                    part.material.empty() ? "no material" : "material " + part.material));
  }
  out.add("parts", std::move(lines));
}

void add_mesh_size(const Model& model, Description& out) {
  if (model.positions.empty()) {
    add_reference_size(model.skeleton, out);
    return;
  }
  add_size<Vec3f>(model.positions, "mesh in the reference pose", out);
  std::vector<Vec3> positions;
  for (const Vec3f& position : model.positions) positions.push_back(position.cast<double>());
  add_volumes({{"", mesh_volume(positions, model.triangles)}}, out);
}

Result<Description> describe_anim(const InputFile& file, const SkeletonOptions& how,
                                  ToolContext& context) {
  const auto opened =
      anim::open(file.bytes(), [&file](std::size_t offset) { file.release_before(offset); });
  if (!opened) return opened.error();
  const FrameSource& frames = opened->frames;
  Stretches stretches;
  if (opened->stretched) {
    const auto clip = anim::read(file.bytes(), &stretches);
    if (!clip) return clip.error();
  } else if (Status status = read_through(frames, context.jobs); !status) {
    return status.error();
  }
  Description out("a motion (.anim)", "anim");
  add_timing(frames.frame_count, frames.rate, out);
  if (Status status = add_skeleton(frames.skeleton, how, out); !status) return status.error();
  if (!stretches.empty()) {
    const LargestStretch worst = largest_stretch(stretches, frames.joint_count());
    const std::string& joint = frames.skeleton.names[at(worst.joint)];
    out.add("scale", fmt::format("joints change scale; most: {} by {}% in frame {}", shown(joint),
                                 readable(100 * worst.size, 3), worst.frame));
    out.json["largest_stretch"] = {{"joint", joint}, {"frame", worst.frame}, {"size", worst.size}};
  }
  add_reference_size(frames.skeleton, out);
  add_orientations(file, out);
  add_provenance(opened->provenance, out);
  return out;
}

Result<Description> describe_model(const InputFile& file, const SkeletonOptions& how,
                                   ToolContext&) {
  const auto model = model::read(file.bytes());
  if (!model) return model.error();
  Description out("a model (.model)", "model");
  const auto vertices = model->positions.size(), triangles = model->triangles.size();
  std::vector<std::string> with;
  if (!model->normals.empty()) with.emplace_back("normals");
  if (!model->texture_coordinates.empty()) with.emplace_back("texture coordinates");
  if (!model->more_texture_coordinates.empty()) {
    with.push_back(counted(std::ssize(model->more_texture_coordinates),
                           "further set of texture coordinates",
                           "further sets of texture coordinates"));
  }
  if (!model->colours.empty()) with.emplace_back("vertex colours");
  if (!model->tangents.empty()) with.emplace_back("tangents");
  out.add("mesh", vertices == 0 ? std::string("none, skeleton only")
                                : fmt::format("{}, {}", counted(vertices, "vertex", "vertices"),
                                              counted(triangles, "triangle")));
  out.add("with", with.empty() ? std::vector<std::string>()
                               : std::vector{fmt::format("{}", fmt::join(with, ", "))});
  if (vertices > 0) {
    out.add("influences", fmt::format("up to {} per vertex", model->influences_per_vertex));
  }
  out.json["vertices"] = vertices;
  out.json["triangles"] = triangles;
  out.json["attributes"] = with;
  out.json["influences_per_vertex"] = model->influences_per_vertex;
  add_parts(*model, out);
  if (Status status = add_skeleton(model->skeleton, how, out); !status) return status.error();
  add_mesh_size(*model, out);
  add_orientations(file, out);
  add_provenance(model->provenance, out);
  return out;
}

Result<Description> describe_cam(const InputFile& file, const SkeletonOptions&, ToolContext&) {
  const auto camera = cam::read(file.bytes());
  if (!camera) return camera.error();
  Description out("a camera (.cam)", "cam");
  add_timing(camera->frame_count(), camera->rate, out);
  if (camera->frame_count() > 0) {
    const auto [low, high] =
        std::minmax_element(camera->fields_of_view.begin(), camera->fields_of_view.end());
    const auto degrees = [](float angle) { return readable(angle / kRadiansPerDegree, 4); };
    out.add("field of view",
            *low == *high ? fmt::format("{} deg, vertical", degrees(*low))
                          : fmt::format("{} to {} deg, vertical", degrees(*low), degrees(*high)));
    out.json["field_of_view"] = {{"smallest", to_degrees(static_cast<double>(*low))},
                                 {"largest", to_degrees(static_cast<double>(*high))}};
    Eigen::AlignedBox3d box;
    for (const Vec3f& position : camera->positions) box.extend(position.cast<double>());
    const Vec3 size = box.sizes();
    if (!camera->cuts.empty())
      out.add("cuts at", fmt::format("frame {}", fmt::join(camera->cuts, ", ")));
    out.json["cuts"] = camera->cuts;
    out.add("moves within", fmt::format("{} x {} x {} m", readable(size.x(), 4),
                                        readable(size.y(), 4), readable(size.z(), 4)));
    out.json["range"] = {size.x(), size.y(), size.z()};
  }
  add_orientations(file, out);
  add_provenance(camera->provenance, out);
  return out;
}

Result<Description> describe_correctives(const InputFile& file, const SkeletonOptions&,
                                         ToolContext&) {
  const auto read = correctives_file::read(file.text());
  if (!read) return read.error();
  Description out("shapes by pose (.correctives)", "correctives");
  std::vector<std::string> lines;
  Json joints = Json::array();
  for (const JointCorrective& joint : read->joints) {
    lines.push_back(fmt::format("{}: {} of {}", shown(joint.joint),
                                counted(joint.target_count(), "target"),
                                counted(std::ssize(joint.vertices), "vertex", "vertices")));
    joints.push_back({{"joint", joint.joint},
                      {"targets", joint.target_count()},
                      {"vertices", joint.vertices.size()}});
  }
  out.add("vertices", fmt::format("{}, of the model", grouped(read->vertex_count)));
  out.add("joints", std::move(lines));
  out.json["vertices"] = read->vertex_count;
  out.json["joints"] = std::move(joints);
  return out;
}

Result<Description> describe_morphs(const InputFile& file, const SkeletonOptions&, ToolContext&) {
  const auto morphs = morph_exr::read(file.bytes());
  if (!morphs) return morphs.error();
  Description out("morph targets (.exr)", "morphs");
  out.add("vertices", fmt::format("{}, of the model", grouped(morphs->vertex_count)));
  out.json["vertices"] = morphs->vertex_count;
  out.json["normals"] = !morphs->normals.empty();
  out.json["targets"] = morphs->names;
  std::vector<std::string> names;
  for (const std::string& name : morphs->names) names.push_back(shown(name));
  out.add("targets", grouped(morphs->target_count()));
  out.add("", std::move(names));
  add_provenance(morphs->provenance, out);
  return out;
}

Result<Description> describe_textgrid(const InputFile& file, const SkeletonOptions&, ToolContext&) {
  const auto grid = textgrid::read(file.text(), file.path());
  if (!grid) return grid.error();
  Description out("labels over time (TextGrid)", "textgrid");
  out.add("duration", readable(grid->end - grid->start, 4) + " s");
  out.json["duration"] = grid->end - grid->start;
  std::vector<std::string> lines;
  for (const textgrid::Tier& tier : grid->tiers) {
    const auto labelled = std::ranges::count_if(
        tier.intervals, [](const textgrid::Interval& one) { return !one.label.empty(); });
    lines.push_back(fmt::format(
        "{}: {}, {} with a label", shown(tier.name),
        counted(std::ssize(tier.intervals), tier.points ? "point" : "interval"), labelled));
    out.json["tiers"].push_back({{"name", tier.name},
                                 {"points", tier.points},
                                 {"intervals", tier.intervals.size()},
                                 {"labelled", labelled}});
  }
  out.add("tiers", std::move(lines));
  return out;
}

Result<Description> describe_ragdoll(const InputFile& file, const SkeletonOptions&, ToolContext&) {
  const auto read = ragdoll_file::read(file.text(), nullptr);
  if (!read) return read.error();
  Description out("bodies and joints (.ragdoll.json)", "ragdoll");
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
