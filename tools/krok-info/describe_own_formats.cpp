#include <fmt/format.h>

#include <algorithm>

#include "core/index.h"
#include "core/numbers.h"
#include "core/text.h"
#include "formats/anim/anim.h"
#include "formats/cam/cam.h"
#include "formats/container/sections.h"
#include "formats/model/model_format.h"
#include "tools/krok-info/describe.h"
#include "tools/krok-info/volumes.h"

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

}  // namespace

void add_parts(const Model& model, Description& out) {
  out.json["parts"] = Json::array();
  std::vector<std::string> lines;
  for (const Model::Part& part : model.parts) {
    out.json["parts"].push_back(
        {{"name", part.name}, {"material", part.material}, {"triangles", part.triangle_count}});
    lines.push_back(
        fmt::format("{}, {}, {}", or_none(part.name), count_of(part.triangle_count, "triangle"),
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
  const auto opened = anim::open(file.bytes());
  if (!opened) return opened.error();
  const FrameSource& frames = opened->frames;
  Stretches stretches;
  if (opened->stretched) {
    const auto clip = anim::read(file.bytes(), &stretches);
    if (!clip) return clip.error();
  } else if (Status status = read_through(frames, context.jobs); !status) {
    return status.error();
  }
  Description out;
  out.what = "a motion (.anim)";
  out.json["kind"] = "anim";
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
  Description out;
  out.what = "a model (.model)";
  out.json["kind"] = "model";
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
                                : fmt::format("{}, {}", count_of(vertices, "vertex", "vertices"),
                                              count_of(triangles, "triangle")));
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

Result<Description> describe_cam(const InputFile& file, ToolContext&) {
  const auto camera = cam::read(file.bytes());
  if (!camera) return camera.error();
  Description out;
  out.what = "a camera (.cam)";
  out.json["kind"] = "cam";
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
    out.add("moves within", fmt::format("{} x {} x {} m", readable(size.x(), 4),
                                        readable(size.y(), 4), readable(size.z(), 4)));
    out.json["range"] = {size.x(), size.y(), size.z()};
  }
  add_orientations(file, out);
  add_provenance(camera->provenance, out);
  return out;
}

}  // namespace krok::cli::info
