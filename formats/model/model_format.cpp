#include "formats/model/model_format.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "formats/container/sections.h"

namespace krok::model {

namespace {

constexpr ContainerFormat kFormat = {registry::Kind::model, registry::kModelMagic, 1,
                                     kFlagFourComponents};

struct Info {
  std::uint32_t joint_count;
  std::uint32_t vertex_count;
  std::uint32_t triangle_count;
  std::uint32_t part_count;
  std::uint32_t influences_per_vertex;
  std::uint32_t reserved;
};
static_assert(sizeof(Info) == 24);

struct PartRecord {
  std::uint32_t first_triangle;
  std::uint32_t triangle_count;
};
static_assert(sizeof(PartRecord) == 8);

static_assert(sizeof(Vec2f) == 8 && sizeof(Vec3f) == 12 && sizeof(Vec4f) == 16);
static_assert(sizeof(std::array<std::uint32_t, 3>) == 12);

// Counts fit in 31 bits, so that indices can be ints.
constexpr std::uint64_t kMaxCount = std::numeric_limits<std::int32_t>::max();

template <typename T>
Status write_array(std::string_view name, const std::vector<T>& values,
                   ContainerWriter& container) {
  // Eigen's fixed-size vectors are not formally trivially copyable, but plain arrays of floats (see
  // the assertions above).
  return container.section(
      name, {reinterpret_cast<const std::byte*>(values.data()), values.size() * sizeof(T)});
}

template <typename T>
Status read_optional_array(const ContainerReader& container, std::string_view name,
                           std::uint64_t count, std::vector<T>& values) {
  if (!container.find(name)) return {};
  return read_array(container, name, count, values);
}

Status write_parts(const Model& model, ContainerWriter& container) {
  std::vector<PartRecord> records;
  std::vector<std::string> names;
  for (const Model::Part& part : model.parts) {
    records.push_back({part.first_triangle, part.triangle_count});
    names.push_back(part.name);
    names.push_back(part.material);
  }
  if (Status status = write_array("PARTS", records, container); !status) return status;
  return write_texts("PARTNAME", names, container);
}

// The sets after the first, one after another.
Status write_more_coordinates(const Model& model, ContainerWriter& container) {
  std::vector<Vec2f> all;
  for (const auto& set : model.more_texture_coordinates) {
    all.insert(all.end(), set.begin(), set.end());
  }
  return write_array("TEXMORE", all, container);
}

Status read_more_coordinates(const ContainerReader& container, std::uint64_t vertices,
                             Model& model) {
  const auto section = container.find("TEXMORE");
  if (!section) return {};
  const std::uint64_t each = vertices * sizeof(Vec2f);
  const std::uint64_t sets = each == 0 ? 0 : section->bytes.size() / each;
  if (sets == 0 || sets >= Model::kMaxCoordinateSets || section->bytes.size() % each != 0) {
    return at_section(
        Error("model-shape",
              fmt::format("{} bytes are not 1 to {} sets of texture coordinates for {} vertices",
                          section->bytes.size(), Model::kMaxCoordinateSets - 1, vertices),
              "create the file again"),
        container, "TEXMORE");
  }
  std::vector<Vec2f> all;
  if (Status status = read_array(container, "TEXMORE", sets * vertices, all); !status) {
    return status;
  }
  for (std::uint64_t s = 0; s < sets; ++s) {
    const auto first = all.begin() + static_cast<std::ptrdiff_t>(s * vertices);
    model.more_texture_coordinates.emplace_back(first,
                                                first + static_cast<std::ptrdiff_t>(vertices));
  }
  return {};
}

// Whether the section MESHNAME is written.
bool names_meshes(const Model& model) {
  return std::ranges::any_of(model.parts,
                             [](const Model::Part& part) { return !part.mesh.empty(); });
}

Status write_mesh_names(const Model& model, ContainerWriter& container) {
  std::vector<std::string> names;
  for (const Model::Part& part : model.parts) names.push_back(part.mesh);
  return write_texts("MESHNAME", names, container);
}

Status read_mesh_names(const ContainerReader& container, Model& model) {
  if (!container.find("MESHNAME")) return {};
  auto names = read_texts(container, "MESHNAME", model.parts.size());
  if (!names) return names.error();
  for (std::size_t i = 0; i < names->size(); ++i) model.parts[i].mesh = std::move((*names)[i]);
  return {};
}

Status read_parts(const ContainerReader& container, std::uint32_t part_count, Model& model) {
  std::vector<PartRecord> records;
  if (Status status = read_array(container, "PARTS", part_count, records); !status) return status;
  auto names = read_texts(container, "PARTNAME", std::uint64_t{2} * part_count);
  if (!names) return names.error();
  for (std::size_t i = 0; i < records.size(); ++i) {
    model.parts.push_back({std::move((*names)[2 * i]), std::move((*names)[2 * i + 1]),
                           records[i].first_triangle, records[i].triangle_count});
  }
  return read_mesh_names(container, model);
}

Status check_storable(const Model& model) {
  if (Status status = check(model); !status) return status;
  if (Status status = krok::check_storable(model.skeleton); !status) return status;
  if (model.positions.size() > kMaxCount || model.triangles.size() > kMaxCount ||
      model.parts.size() > kMaxCount) {
    return Error("model-shape",
                 fmt::format("more than {} vertices, triangles or parts", kMaxCount));
  }
  for (const Model::Part& part : model.parts) {
    if (is_storable_text(part.name) && is_storable_text(part.material) &&
        is_storable_text(part.mesh)) {
      continue;
    }
    return Error("model-shape",
                 "the name, material or mesh of a part is not valid UTF-8 or has a zero byte",
                 "rename the part, its material or its mesh");
  }
  return {};
}

// The section of an error of check(Model), by its code.
std::string_view section_of(const std::string& code) {
  if (code == "model-weight") return "VWEIGHTS";
  if (code == "model-index") return "TRIANGLE";
  if (code == "model-value") return "POSITION";
  return "PARTS";
}

}  // namespace

Status write(const Model& model, const WriteOptions& options, OutputFile& file) {
  if (Status status = check_storable(model); !status) return status;
  const Info info = {static_cast<std::uint32_t>(model.skeleton.names.size()),
                     static_cast<std::uint32_t>(model.positions.size()),
                     static_cast<std::uint32_t>(model.triangles.size()),
                     static_cast<std::uint32_t>(model.parts.size()),
                     static_cast<std::uint32_t>(model.influences_per_vertex),
                     0};
  const bool normals = !model.normals.empty();
  const bool coordinates = !model.texture_coordinates.empty();
  const bool more = !model.more_texture_coordinates.empty();
  const bool tangents = !model.tangents.empty();
  const bool colours = !model.colours.empty();
  const bool meshes = names_meshes(model);
  const std::size_t optional_sections =
      std::size_t{normals} + coordinates + more + tangents + colours + meshes;
  ContainerWriter container(file, kFormat, orientation_flags(options.orientation),
                            8 + kSkeletonSections + optional_sections);
  Status status = container.section("INFO", std::as_bytes(std::span(&info, 1)));
  if (status) status = write_skeleton(model.skeleton, options.orientation, container);
  if (status) status = write_array("POSITION", model.positions, container);
  if (status && normals) status = write_array("NORMAL", model.normals, container);
  if (status && coordinates) status = write_array("TEXCOORD", model.texture_coordinates, container);
  if (status && more) status = write_more_coordinates(model, container);
  if (status && tangents) status = write_array("TANGENT", model.tangents, container);
  if (status && colours) status = write_array("COLOUR", model.colours, container);
  if (status) status = write_array("VJOINTS", model.influence_joints, container);
  if (status) status = write_array("VWEIGHTS", model.influence_weights, container);
  if (status) status = write_array("TRIANGLE", model.triangles, container);
  if (status) status = write_parts(model, container);
  if (status && meshes) status = write_mesh_names(model, container);
  if (status) status = write_provenance(model.provenance, container);
  if (status) status = container.finish();
  return status;
}

Result<Model> read(std::span<const std::byte> file) {
  const auto container = ContainerReader::open(file, kFormat);
  if (!container) return container.error();
  const auto info_section = container->section("INFO", 1, sizeof(Info));
  if (!info_section) return info_section.error();
  const auto info = ByteReader(info_section->bytes).read<Info>();
  if (info.joint_count < 1 || info.joint_count > kMaxFileJoints || info.vertex_count > kMaxCount ||
      info.triangle_count > kMaxCount || info.part_count > kMaxCount ||
      info.influences_per_vertex < 1 ||
      info.influences_per_vertex > static_cast<std::uint32_t>(Model::kMaxInfluences)) {
    return at_section(
        Error("model-shape",
              fmt::format("has invalid counts: {} joints, {} vertices, {} triangles, {} parts and "
                          "{} influences per vertex",
                          info.joint_count, info.vertex_count, info.triangle_count, info.part_count,
                          info.influences_per_vertex),
              "create the file again"),
        *container, "INFO");
  }

  Model model;
  auto skeleton = read_skeleton(*container, info.joint_count);
  if (!skeleton) return skeleton.error();
  model.skeleton = *std::move(skeleton);
  auto provenance = read_provenance(*container);
  if (!provenance) return provenance.error();
  model.provenance = *std::move(provenance);

  const std::uint64_t vertices = info.vertex_count;
  const std::uint64_t influences = vertices * info.influences_per_vertex;
  model.influences_per_vertex = static_cast<int>(info.influences_per_vertex);
  Status status = read_array(*container, "POSITION", vertices, model.positions);
  if (status) status = read_optional_array(*container, "NORMAL", vertices, model.normals);
  if (status) {
    status = read_optional_array(*container, "TEXCOORD", vertices, model.texture_coordinates);
  }
  if (status) status = read_more_coordinates(*container, vertices, model);
  if (status) status = read_optional_array(*container, "TANGENT", vertices, model.tangents);
  if (status) status = read_optional_array(*container, "COLOUR", vertices, model.colours);
  if (status) status = read_array(*container, "VJOINTS", influences, model.influence_joints);
  if (status) status = read_array(*container, "VWEIGHTS", influences, model.influence_weights);
  if (status) status = read_array(*container, "TRIANGLE", info.triangle_count, model.triangles);
  if (status) status = read_parts(*container, info.part_count, model);
  if (!status) return status.error();

  if (Status step = check(model); !step) {
    const std::string_view section = section_of(step.error().code);
    return at_section(std::move(step).error(), *container, section);
  }
  return model;
}

}  // namespace krok::model
