#include "formats/gltf/reader_internal.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <memory>
#include <numeric>
#include <utility>
#include <vector>

#include "core/numbers.h"
#include "nodes/scene.h"

namespace krok::gltf {

namespace {

using namespace nodes;

template <typename T>
Shared<T> picked(const Shared<T>& from, const std::vector<std::uint32_t>& used) {
  if (from == nullptr) return nullptr;
  std::vector<T> values;
  values.reserve(used.size());
  for (const std::uint32_t v : used) values.push_back((*from)[v]);
  return std::make_shared<const std::vector<T>>(std::move(values));
}

template <typename T>
std::vector<T> picked_rows(const std::vector<T>& from, std::size_t each,
                           const std::vector<std::uint32_t>& used) {
  std::vector<T> values;
  values.reserve(used.size() * each);
  for (const std::uint32_t v : used) {
    const auto row = from.begin() + static_cast<std::ptrdiff_t>(v * each);
    values.insert(values.end(), row, row + static_cast<std::ptrdiff_t>(each));
  }
  return values;
}

// The vertices of `whole` that triangles use, in its order, and the triangles with their new
// numbers. Everything else that there is of vertices comes along; the material does not.
Primitive with_used_vertices(const Primitive& whole,
                             std::vector<std::array<std::uint32_t, 3>> triangles) {
  std::vector<std::uint32_t> used;
  for (const auto& triangle : triangles) used.insert(used.end(), triangle.begin(), triangle.end());
  std::ranges::sort(used);
  used.erase(std::unique(used.begin(), used.end()), used.end());
  const auto each = static_cast<std::size_t>(whole.influences_per_vertex);
  Primitive part;
  part.positions = picked(whole.positions, used);
  part.normals = picked(whole.normals, used);
  part.tangents = picked(whole.tangents, used);
  part.texture_coordinates = picked(whole.texture_coordinates, used);
  for (const Shared<Vec2f>& set : whole.more_texture_coordinates) {
    part.more_texture_coordinates.push_back(picked(set, used));
  }
  part.colours = picked(whole.colours, used);
  part.influences_per_vertex = whole.influences_per_vertex;
  part.influence_joints = picked_rows(whole.influence_joints, each, used);
  part.influence_weights = picked_rows(whole.influence_weights, each, used);
  for (const MorphTarget& target : whole.targets) {
    part.targets.push_back({target.name, picked(target.positions, used),
                            picked(target.normals, used), picked(target.tangents, used)});
  }
  for (auto& triangle : triangles) {
    for (std::uint32_t& corner : triangle) {
      corner = static_cast<std::uint32_t>(std::ranges::lower_bound(used, corner) - used.begin());
    }
  }
  part.triangles = std::move(triangles);
  return part;
}

// Of what with_used_vertices() copies, about.
std::size_t bytes_of(const Primitive& primitive) {
  const auto influences = static_cast<std::size_t>(primitive.influences_per_vertex);
  const std::size_t each = 4 * sizeof(Vec4f) +
                           primitive.more_texture_coordinates.size() * sizeof(Vec2f) +
                           influences * (sizeof(std::uint16_t) + sizeof(float)) +
                           3 * sizeof(Vec3f) * primitive.targets.size();
  return primitive.vertex_count() * each;
}

}  // namespace

using namespace nodes;

namespace {

using Triangle = std::array<std::uint32_t, 3>;

Error bad_mesh(const std::string& name, const std::string& what) {
  return Error("gltf-mesh", fmt::format("{}: {}", name, what), kDamagedHint);
}

int attribute(const std::map<std::string, int>& attributes, const char* name) {
  const auto found = attributes.find(name);
  return found == attributes.end() ? -1 : found->second;
}

// An attribute of a vector type, null if it is absent; must have one element per vertex.
Status read_vectors(const std::map<std::string, int>& attributes, const char* what,
                    std::size_t vertices, Accessors& accessors, const std::string& name,
                    Shared<Vec3f>& values) {
  const int accessor = attribute(attributes, what);
  if (accessor == -1) return {};
  auto read = accessors.vectors3(accessor);
  if (!read) return read.error();
  if ((*read)->size() != vertices) {
    return bad_mesh(name, fmt::format("{} {} for {} vertices", (*read)->size(), what, vertices));
  }
  values = std::move(*read);
  return {};
}

Status read_texture_coordinates(const tinygltf::Primitive& source, Accessors& accessors,
                                const std::string& name, Primitive& primitive) {
  const int accessor = attribute(source.attributes, "TEXCOORD_0");
  if (accessor == -1) return {};
  auto read = accessors.vectors2(accessor);
  if (!read) return read.error();
  if ((*read)->size() != primitive.vertex_count()) {
    return bad_mesh(name, fmt::format("{} TEXCOORD_0 for {} vertices", (*read)->size(),
                                      primitive.vertex_count()));
  }
  primitive.texture_coordinates = std::move(*read);
  return {};
}

// Further texture coordinates and vertex colours. A damaged one is left out: nothing depends on it.
Status read_more(const tinygltf::Primitive& source, Accessors& accessors, const std::string& name,
                 Primitive& primitive, Diagnostics& diagnostics) {
  const std::size_t vertices = primitive.vertex_count();
  const auto left_out = [&](const std::string& what, const std::string& why) {
    warn(diagnostics, "gltf-mesh-attribute",
         fmt::format("{}: {} is left out: {}", name, what, why));
  };
  constexpr int kMaxSets = 16;
  for (int set = 1; set < kMaxSets; ++set) {
    const std::string what = fmt::format("TEXCOORD_{}", set);
    const int accessor = attribute(source.attributes, what.c_str());
    if (accessor == -1) continue;
    auto read = accessors.vectors2(accessor);
    if (!read || (*read)->size() != vertices) {
      left_out(what,
               read ? fmt::format("it has {} values for {} vertices", (*read)->size(), vertices)
                    : read.error().message);
      continue;
    }
    primitive.more_texture_coordinates.resize(static_cast<std::size_t>(set));
    primitive.more_texture_coordinates.back() = std::move(*read);
  }
  const int accessor = attribute(source.attributes, "COLOR_0");
  if (accessor == -1) return {};
  auto colours = accessors.colours(accessor);
  if (!colours || (*colours)->size() != vertices) {
    left_out("COLOR_0",
             colours ? fmt::format("it has {} values for {} vertices", (*colours)->size(), vertices)
                     : colours.error().message);
    return {};
  }
  primitive.colours = std::move(*colours);
  return {};
}

// Normalises tangents, as the specification requires; w is the sign. A zero tangent stays zero.
Status read_tangents(const tinygltf::Primitive& source, Accessors& accessors,
                     const std::string& name, Primitive& primitive, Diagnostics& diagnostics) {
  const int accessor = attribute(source.attributes, "TANGENT");
  if (accessor == -1) return {};
  auto read = accessors.vectors4(accessor);
  if (!read) return read.error();
  const std::size_t vertices = primitive.vertex_count();
  if (read->size() != vertices * 4) {
    return bad_mesh(name, fmt::format("{} TANGENT for {} vertices", read->size() / 4, vertices));
  }
  if (auto taken = accessors.reserve(vertices * sizeof(Vec4f)); !taken) return taken;
  auto tangents = std::make_shared<std::vector<Vec4f>>(vertices);
  std::size_t zeros = 0, first_zero = 0;
  for (std::size_t v = 0; v < vertices; ++v) {
    const Eigen::Map<const Vec4f> tangent(read->data() + 4 * v);
    const float length = tangent.head<3>().stableNorm();
    if (length > 0) {
      (*tangents)[v].head<3>() = tangent.head<3>() / length;
    } else {
      (*tangents)[v].head<3>().setZero();
      if (zeros++ == 0) first_zero = v;
    }
    (*tangents)[v].w() = tangent.w() < 0 ? -1.0f : 1.0f;
  }
  if (zeros > 0) {
    warn(diagnostics, "gltf-mesh-tangents",
         fmt::format("{}: {} of {} tangents are zero, the first at vertex {}; a .model of it has "
                     "no tangents",
                     name, zeros, vertices, first_zero));
  }
  primitive.tangents = std::move(tangents);
  return {};
}

// Normalises weights to sum to 1, which rounding to bytes may break. A vertex without weights is
// bound to its first joint, as in common viewers.
void normalize_weights(Primitive& primitive, bool all_kept, const std::string& name,
                       Diagnostics& diagnostics) {
  const auto per_vertex = static_cast<std::size_t>(primitive.influences_per_vertex);
  // Bytes may be off by this much in sum without the exporter's fault.
  constexpr double kRounding = 0.02;
  std::size_t without = 0, unnormalized = 0, negative = 0;
  double least = std::numeric_limits<double>::max(), most = 0;
  for (std::size_t v = 0; v < primitive.vertex_count(); ++v) {
    const std::span<float> weights(&primitive.influence_weights[v * per_vertex], per_vertex);
    double sum = 0;
    if (std::ranges::any_of(weights, [](float weight) { return weight < 0; })) ++negative;
    for (float& weight : weights) {
      weight = std::max(weight, 0.0f);
      sum += static_cast<double>(weight);
    }
    if (all_kept && sum > 0 && std::abs(sum - 1) > kRounding) {
      ++unnormalized;
      least = std::min(least, sum);
      most = std::max(most, sum);
    }
    if (sum > 0) {
      for (float& weight : weights) weight = static_cast<float>(static_cast<double>(weight) / sum);
    } else {
      weights[0] = 1.0f;
      ++without;
    }
  }
  if (unnormalized > 0) {
    warn(diagnostics, "gltf-mesh-weights",
         fmt::format("{}: the weights of {} sum to {} to {} instead of 1; they are normalised",
                     name, counted(static_cast<long long>(unnormalized), "vertex", "vertices"),
                     readable(least, 3), readable(most, 3)));
  }
  if (negative > 0) {
    warn(diagnostics, "gltf-mesh-weights",
         fmt::format("{}: negative weights of {} are taken as 0", name,
                     counted(static_cast<long long>(negative), "vertex", "vertices")));
  }
  if (without > 0) {
    warn(diagnostics, "gltf-mesh-unweighted",
         fmt::format("{}: {} vertices have no weights and are bound to their first joint", name,
                     without));
  }
}

// What is not kept of vertices with too many influences.
struct DroppedInfluences {
  std::size_t vertices = 0;
  double largest = 0;  // sum of the weights of one vertex

  template <typename Weight>
  void add(std::span<const std::size_t> places, const Weight& weight) {
    double sum = 0;
    for (const std::size_t k : places) sum += static_cast<double>(std::max(weight(k), 0.0f));
    if (sum > 0) ++vertices;
    largest = std::max(largest, sum);
  }
};

Status read_influences(const tinygltf::Primitive& source, Accessors& accessors,
                       const std::string& name, Primitive& primitive, Diagnostics& diagnostics) {
  // [sets], four influences of each vertex in each.
  std::vector<std::vector<std::uint32_t>> joints;
  std::vector<std::vector<float>> weights;
  const std::size_t vertices = primitive.vertex_count();
  for (std::size_t set = 0;; ++set) {
    const std::string joints_name = fmt::format("JOINTS_{}", set);
    const std::string weights_name = fmt::format("WEIGHTS_{}", set);
    const int joint_accessor = attribute(source.attributes, joints_name.c_str());
    const int weight_accessor = attribute(source.attributes, weights_name.c_str());
    if (joint_accessor == -1 && weight_accessor == -1) break;
    if (joint_accessor == -1 || weight_accessor == -1) {
      return bad_mesh(name, fmt::format("has only one of {} and {}", joints_name, weights_name));
    }
    auto set_joints = accessors.integers(joint_accessor, TINYGLTF_TYPE_VEC4);
    if (!set_joints) return set_joints.error();
    auto set_weights = accessors.vectors4(weight_accessor);
    if (!set_weights) return set_weights.error();
    if (set_joints->size() != vertices * 4 || set_weights->size() != vertices * 4) {
      return bad_mesh(name, fmt::format("{} joints and {} weights for {} vertices",
                                        set_joints->size() / 4, set_weights->size() / 4, vertices));
    }
    joints.push_back(std::move(*set_joints));
    weights.push_back(std::move(*set_weights));
  }
  if (joints.empty() || vertices == 0) return {};

  const std::size_t all = 4 * joints.size();
  const std::size_t per_vertex = std::min<std::size_t>(all, Primitive::kMaxInfluences);
  if (auto taken = accessors.reserve(vertices * per_vertex * 6); !taken) return taken;
  primitive.influences_per_vertex = static_cast<int>(per_vertex);
  primitive.influence_joints.resize(vertices * per_vertex);
  primitive.influence_weights.resize(vertices * per_vertex);
  DroppedInfluences dropped;
  std::vector<std::size_t> order(all);
  for (std::size_t v = 0; v < vertices; ++v) {
    const auto weight = [&](std::size_t k) { return weights[k / 4][v * 4 + k % 4]; };
    std::iota(order.begin(), order.end(), std::size_t{0});
    if (all > per_vertex) {
      std::ranges::stable_sort(order, [&](std::size_t a, std::size_t b) {
        return std::max(weight(a), 0.0f) > std::max(weight(b), 0.0f);
      });
      dropped.add(std::span(order).subspan(per_vertex), weight);
    }
    for (std::size_t k = 0; k < per_vertex; ++k) {
      const std::uint32_t joint = joints[order[k] / 4][v * 4 + order[k] % 4];
      if (joint > 0xFFFF) return bad_mesh(name, fmt::format("joint {} is out of range", joint));
      primitive.influence_joints[v * per_vertex + k] = static_cast<std::uint16_t>(joint);
      primitive.influence_weights[v * per_vertex + k] = weight(order[k]);
    }
  }
  if (dropped.vertices > 0) {
    warn(diagnostics, "gltf-mesh-influences",
         fmt::format("{}: {} vertices have more than 8 influences; the 8 largest are kept, what is "
                     "dropped is up to {}% of a vertex's weight",
                     name, dropped.vertices, readable(100 * dropped.largest, 3)));
  }
  normalize_weights(primitive, dropped.vertices == 0, name, diagnostics);
  return {};
}

// Triangles from triangle lists, strips and fans; section 3.7.2.1 of the specification.
std::vector<Triangle> triangles_of(int mode, std::span<const std::uint32_t> corners) {
  std::vector<Triangle> triangles;
  const std::size_t count = corners.size();
  if (mode == TINYGLTF_MODE_TRIANGLES) {
    triangles.reserve(count / 3);
    for (std::size_t i = 0; i + 2 < count; i += 3) {
      triangles.push_back({corners[i], corners[i + 1], corners[i + 2]});
    }
  } else if (mode == TINYGLTF_MODE_TRIANGLE_STRIP) {
    for (std::size_t i = 0; i + 2 < count; ++i) {
      triangles.push_back({corners[i], corners[i + 1 + i % 2], corners[i + 2 - i % 2]});
    }
  } else if (mode == TINYGLTF_MODE_TRIANGLE_FAN) {
    for (std::size_t i = 1; i + 1 < count; ++i) {
      triangles.push_back({corners[i], corners[i + 1], corners[0]});
    }
  }
  return triangles;
}

Status read_triangles(const tinygltf::Primitive& source, Accessors& accessors,
                      const std::string& name, Primitive& primitive) {
  if (source.mode < TINYGLTF_MODE_POINTS || source.mode > TINYGLTF_MODE_TRIANGLE_FAN) {
    return bad_mesh(name, fmt::format("mode {} is not a glTF mode", source.mode));
  }
  const std::size_t vertices = primitive.vertex_count();
  std::vector<std::uint32_t> corners;
  if (source.indices >= 0) {
    auto indices = accessors.integers(source.indices, TINYGLTF_TYPE_SCALAR);
    if (!indices) return indices.error();
    corners = std::move(*indices);
    for (std::size_t i = 0; i < corners.size(); ++i) {
      if (corners[i] < vertices) continue;
      return bad_mesh(
          name, fmt::format("index {} is {}, but there are {} vertices", i, corners[i], vertices));
    }
  } else {
    if (auto taken = accessors.reserve(vertices * sizeof(std::uint32_t)); !taken) return taken;
    corners.resize(vertices);
    for (std::size_t i = 0; i < vertices; ++i) corners[i] = static_cast<std::uint32_t>(i);
  }
  if (source.mode == TINYGLTF_MODE_TRIANGLES && corners.size() % 3 != 0) {
    return bad_mesh(name, fmt::format("{} indices do not form whole triangles", corners.size()));
  }
  const std::size_t each = source.mode == TINYGLTF_MODE_TRIANGLES ? 4 : sizeof(Triangle);
  if (auto taken = accessors.reserve(corners.size() * each); !taken) return taken;
  primitive.triangles = triangles_of(source.mode, corners);
  return {};
}

Status read_targets(const tinygltf::Primitive& source, const std::vector<std::string>& names,
                    Accessors& accessors, const std::string& name, Primitive& primitive) {
  for (std::size_t t = 0; t < source.targets.size(); ++t) {
    MorphTarget& target = primitive.targets.emplace_back();
    if (t < names.size()) target.name = names[t];
    const std::string target_name = fmt::format("{}, target {}", name, t);
    for (const auto& [what, values] : {std::pair{"POSITION", &target.positions},
                                       {"NORMAL", &target.normals},
                                       {"TANGENT", &target.tangents}}) {
      const Status status = read_vectors(source.targets[t], what, primitive.vertex_count(),
                                         accessors, target_name, *values);
      if (!status) return status;
    }
  }
  return {};
}

// The vertices of a primitive, and what there is of each.
Result<Primitive> read_vertices(const tinygltf::Primitive& source,
                                const std::vector<std::string>& target_names, Accessors& accessors,
                                const std::string& name, Diagnostics& diagnostics) {
  Primitive primitive;
  const int position = attribute(source.attributes, "POSITION");
  if (position == -1) return bad_mesh(name, "has no POSITION");
  auto positions = accessors.vectors3(position);
  if (!positions) return positions.error();
  primitive.positions = std::move(*positions);
  for (const Status& read : {read_vectors(source.attributes, "NORMAL", primitive.vertex_count(),
                                          accessors, name, primitive.normals),
                             read_texture_coordinates(source, accessors, name, primitive),
                             read_more(source, accessors, name, primitive, diagnostics),
                             read_tangents(source, accessors, name, primitive, diagnostics),
                             read_influences(source, accessors, name, primitive, diagnostics),
                             read_targets(source, target_names, accessors, name, primitive)}) {
    if (!read) return read.error();
  }
  return primitive;
}

// Reads the primitives of a mesh. Where several share their vertices (each draws a part of them),
// the vertices are read once, and each gets those that its triangles use.
class PrimitiveReader {
 public:
  PrimitiveReader(const ParsedJson& parsed, const tinygltf::Mesh& source,
                  const std::vector<std::string>& target_names, Accessors& accessors,
                  Diagnostics& diagnostics)
      : parsed_(parsed),
        source_(source),
        target_names_(target_names),
        accessors_(accessors),
        diagnostics_(diagnostics) {
    for (const tinygltf::Primitive& primitive : source.primitives) ++users_[key_of(primitive)];
  }

  Result<Primitive> read(std::size_t index, const std::string& name) {
    const tinygltf::Primitive& source = source_.primitives[index];
    const Key key = key_of(source);
    auto known = whole_.find(key);
    if (known == whole_.end()) {
      auto vertices = read_vertices(source, target_names_, accessors_, name, diagnostics_);
      if (!vertices) return vertices.error();
      known = whole_.emplace(key, std::move(*vertices)).first;
    }
    const bool shared = users_[key] > 1;
    Primitive triangles;
    triangles.positions = known->second.positions;
    if (Status read = read_triangles(source, accessors_, name, triangles); !read) {
      return read.error();
    }
    Primitive primitive;
    if (shared && !triangles.triangles.empty()) {
      primitive = with_used_vertices(known->second, std::move(triangles.triangles));
      if (Status status = accessors_.reserve(bytes_of(primitive)); !status) {
        return status.error();
      }
    } else {
      primitive = shared ? known->second : std::move(known->second);
      primitive.triangles = std::move(triangles.triangles);
    }
    if (source.material >= 0 &&
        static_cast<std::size_t>(source.material) < parsed_.material_names.size()) {
      primitive.material = parsed_.material_names[static_cast<std::size_t>(source.material)];
    }
    return primitive;
  }

 private:
  using Key = std::pair<std::map<std::string, int>, std::vector<std::map<std::string, int>>>;
  static Key key_of(const tinygltf::Primitive& source) {
    return {source.attributes, source.targets};
  }

  const ParsedJson& parsed_;
  const tinygltf::Mesh& source_;
  const std::vector<std::string>& target_names_;
  Accessors& accessors_;
  Diagnostics& diagnostics_;
  std::map<Key, int> users_;
  std::map<Key, Primitive> whole_;
};

}  // namespace

Result<Mesh> read_mesh(const ParsedJson& parsed, std::size_t index, Accessors& accessors,
                       Diagnostics& diagnostics) {
  const tinygltf::Mesh& source = parsed.model.meshes[index];
  Mesh mesh;
  mesh.name = source.name;
  const std::string name = mesh.name.empty() ? fmt::format("mesh {}", index)
                                             : fmt::format("mesh {} ({})", index, mesh.name);
  const std::vector<std::string> no_names;
  const auto& target_names =
      index < parsed.target_names.size() ? parsed.target_names[index] : no_names;
  PrimitiveReader reader(parsed, source, target_names, accessors, diagnostics);
  for (std::size_t p = 0; p < source.primitives.size(); ++p) {
    auto primitive = reader.read(p, fmt::format("{}, primitive {}", name, p));
    if (!primitive) return primitive.error();
    mesh.primitives.push_back(std::move(*primitive));
    if (mesh.primitives.back().targets.size() == mesh.target_count()) continue;
    return bad_mesh(name, fmt::format("primitive {} has {} morph targets, the first has {}", p,
                                      mesh.primitives.back().targets.size(), mesh.target_count()));
  }
  mesh.weights = source.weights;
  if (mesh.weights.empty()) mesh.weights.assign(mesh.target_count(), 0.0);
  if (mesh.weights.size() != mesh.target_count()) {
    return bad_mesh(name, fmt::format("{} weights for {} morph targets", mesh.weights.size(),
                                      mesh.target_count()));
  }
  return mesh;
}

}  // namespace krok::gltf
