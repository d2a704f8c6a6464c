#include <algorithm>
#include <cstring>

#include "formats/gltf/document_internal.h"

namespace krok::gltf {

namespace {

// Each part's accessors take some 150 bytes of JSON each; more than this many are not worth it.
constexpr std::size_t kMaxRanges = 4096;

double component_at(const std::byte* bytes, int component) {
  const auto value = [&](auto number) {
    std::memcpy(&number, bytes, sizeof number);
    return static_cast<double>(number);
  };
  if (component == TINYGLTF_COMPONENT_TYPE_SHORT) return value(std::int16_t{});
  if (component == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT) return value(std::uint16_t{});
  return value(float{});
}

}  // namespace

std::vector<Document::VertexRange> Document::part_ranges(const Model& model) const {
  struct Used {
    std::uint32_t first, last;
    std::size_t primitive;
  };
  std::vector<Used> used;
  for (const Model::Part& part : model.parts) {
    if (part.triangle_count == 0) continue;
    Used one{~std::uint32_t{0}, 0, used.size()};
    for (std::uint32_t t = 0; t < part.triangle_count; ++t) {
      for (const std::uint32_t corner : model.triangles[part.first_triangle + t]) {
        one.first = std::min(one.first, corner);
        one.last = std::max(one.last, corner);
      }
    }
    used.push_back(one);
  }
  const std::size_t targets = options_.morphs == nullptr ? 0 : options_.morphs->names.size();
  if (used.size() < 2 || used.size() * (1 + targets) > kMaxRanges) return {};
  std::ranges::sort(used, {}, &Used::first);
  std::vector<VertexRange> ranges(used.size());
  for (std::size_t i = 0; i < used.size(); ++i) {
    const bool is_last = i + 1 == used.size();
    if (!is_last && used[i].last >= used[i + 1].first) return {};
    // What no triangle uses goes with the part before it.
    const std::size_t begin = i == 0 ? 0 : used[i].first;
    const std::size_t end = is_last ? model.positions.size() : used[i + 1].first;
    ranges[used[i].primitive] = {begin, end - begin};
  }
  return ranges;
}

std::span<const std::byte> Document::bytes_from(std::size_t offset) const {
  for (const Part& part : parts_) {
    const auto bytes = part.bytes();
    if (offset < bytes.size()) return bytes.subspan(offset);
    offset -= bytes.size();
  }
  return {};
}

std::span<const std::byte> Document::bytes_of(const tinygltf::Accessor& accessor) const {
  const auto& view = gltf.bufferViews[static_cast<std::size_t>(accessor.bufferView)];
  return bytes_from(view.byteOffset).first(view.byteLength);
}

void Document::find_bounds(tinygltf::Accessor& accessor) const {
  const auto& view = gltf.bufferViews[static_cast<std::size_t>(accessor.bufferView)];
  const auto size = static_cast<std::size_t>(
      tinygltf::GetComponentSizeInBytes(static_cast<std::uint32_t>(accessor.componentType)));
  const auto bytes = bytes_from(view.byteOffset + accessor.byteOffset);
  for (std::size_t i = 0; i < accessor.count; ++i) {
    for (std::size_t c = 0; c < accessor.minValues.size(); ++c) {
      const double value =
          component_at(&bytes[i * view.byteStride + c * size], accessor.componentType);
      double& least = accessor.minValues[c];
      double& most = accessor.maxValues[c];
      least = i == 0 ? value : std::min(least, value);
      most = i == 0 ? value : std::max(most, value);
    }
  }
}

std::map<std::string, int> Document::attributes_of(const std::map<std::string, int>& whole,
                                                   const VertexRange& range, bool in_place) {
  std::map<std::string, int> attributes = whole;
  for (auto& [name, index] : attributes) {
    tinygltf::Accessor part = gltf.accessors[static_cast<std::size_t>(index)];
    if (const auto found = displacements_.find(index); found != displacements_.end()) {
      fill_displacements(std::span(found->second).subspan(range.first, range.count), part);
      if (in_place) {
        gltf.accessors[static_cast<std::size_t>(index)] = std::move(part);
      } else {
        index = static_cast<int>(gltf.accessors.size());
        gltf.accessors.push_back(std::move(part));
      }
      continue;
    }
    const auto& view = gltf.bufferViews[static_cast<std::size_t>(part.bufferView)];
    part.byteOffset = range.first * view.byteStride;
    part.count = range.count;
    if (!part.minValues.empty()) find_bounds(part);
    if (in_place) {
      gltf.accessors[static_cast<std::size_t>(index)] = std::move(part);
    } else {
      index = static_cast<int>(gltf.accessors.size());
      gltf.accessors.push_back(std::move(part));
    }
  }
  return attributes;
}

std::map<std::string, int> Document::own_attributes(const tinygltf::Primitive& primitive,
                                                    const std::map<std::string, int>& whole,
                                                    const VertexRange& range) const {
  const auto used = used_sets_.find(primitive.material);
  const auto is_used = [&](const std::string& name) {
    return used != used_sets_.end() && used->second.contains(name);
  };
  std::map<std::string, int> own = whole;
  std::erase_if(own, [&](const auto& attribute) {
    const auto& [name, index] = attribute;
    if (!name.starts_with("TEXCOORD_") || is_used(name)) return false;
    const auto& accessor = gltf.accessors[static_cast<std::size_t>(index)];
    const auto& view = gltf.bufferViews[static_cast<std::size_t>(accessor.bufferView)];
    const auto bytes = bytes_from(view.byteOffset + range.first * view.byteStride)
                           .first(range.count * view.byteStride);
    return std::ranges::all_of(bytes, [](std::byte byte) { return byte == std::byte{0}; });
  });
  return own;
}

void Document::for_each_own_primitive(
    std::span<const MeshNode> meshes,
    const std::function<void(tinygltf::Primitive&, const VertexRange&, bool)>& take) {
  for (std::size_t m = meshes.size(); m-- > 0;) {
    const auto ranges = ranges_.find(meshes[m].mesh);
    if (ranges == ranges_.end()) continue;
    auto& primitives = gltf.meshes[static_cast<std::size_t>(meshes[m].mesh)].primitives;
    for (std::size_t p = primitives.size(); p-- > 0;) {
      take(primitives[p], ranges->second[p], m == 0 && p == 0);
    }
  }
}

int Document::add_displacements(std::vector<Vec3f> values, bool bounds) {
  const int sparse = add_sparse(values, bounds, TINYGLTF_COMPONENT_TYPE_FLOAT);
  if (sparse >= 0) return sparse;
  return bounds ? add_positions(values) : add_vectors(values);
}

int Document::add_sparse(std::vector<Vec3f> values, bool bounds, int component) {
  const auto moved = std::ranges::count_if(values, [](const Vec3f& one) { return !one.isZero(0); });
  const std::ptrdiff_t value =
      tinygltf::GetComponentSizeInBytes(static_cast<std::uint32_t>(component));
  const std::ptrdiff_t bytes = 3 * value;
  constexpr int kIndex = sizeof(std::uint32_t);
  const std::ptrdiff_t sparse = bytes + kIndex, dense = (bytes + 3) / 4 * 4;
  if ((options_.compressed && options_.binary) || 2 * moved * sparse > std::ssize(values) * dense) {
    return -1;
  }
  tinygltf::Accessor accessor;
  accessor.componentType = component;
  accessor.normalized = component != TINYGLTF_COMPONENT_TYPE_FLOAT;
  accessor.type = TINYGLTF_TYPE_VEC3;
  if (bounds) accessor.minValues.resize(3);
  const int index = static_cast<int>(gltf.accessors.size());
  gltf.accessors.push_back(std::move(accessor));
  displacements_[index] = std::move(values);
  return index;
}

void Document::fill_displacements(std::span<const Vec3f> values, tinygltf::Accessor& accessor) {
  accessor.count = values.size();
  std::vector<std::uint32_t> places;
  std::vector<Vec3f> moved;
  Vec3f least = values.empty() ? Vec3f(Vec3f::Zero()) : values[0], most = least;
  for (std::size_t v = 0; v < values.size(); ++v) {
    least = least.cwiseMin(values[v]);
    most = most.cwiseMax(values[v]);
    if (values[v].isZero(0)) continue;
    places.push_back(static_cast<std::uint32_t>(v));
    moved.push_back(values[v]);
  }
  if (!accessor.minValues.empty()) {
    accessor.minValues.assign(least.data(), least.data() + 3);
    accessor.maxValues.assign(most.data(), most.data() + 3);
  }
  if (moved.empty()) return;              // an accessor without data is 0
  const auto take_view = [&](int made) {  // of an accessor that is not needed
    const int view = gltf.accessors[static_cast<std::size_t>(made)].bufferView;
    const int component = gltf.accessors[static_cast<std::size_t>(made)].componentType;
    gltf.accessors.pop_back();
    return std::pair(view, component);
  };
  const auto [index_view, component] =
      take_view(add_integers(places, TINYGLTF_TYPE_SCALAR, places.back(), Use::data));
  const auto whole = [&]<typename Whole>(Whole, int type) {
    std::vector<Whole> numbers;
    for (const Vec3f& one : moved) {
      for (const float value : one) numbers.push_back(static_cast<Whole>(value));
    }
    return add_accessor(std::as_bytes(std::span(numbers)), type, sizeof(Whole), TINYGLTF_TYPE_VEC3,
                        Use::data);
  };
  const int type = accessor.componentType;
  const auto value_view =
      take_view(type == TINYGLTF_COMPONENT_TYPE_SHORT  ? whole(std::int16_t{}, type)
                : type == TINYGLTF_COMPONENT_TYPE_BYTE ? whole(std::int8_t{}, type)
                                                       : add_vectors(moved, Use::data))
          .first;
  accessor.sparse.isSparse = true;
  accessor.sparse.count = static_cast<int>(moved.size());
  accessor.sparse.indices = {0, index_view, component};
  accessor.sparse.values = {value_view, 0};
}

std::vector<Document::MeshNode> Document::moved_meshes(
    std::span<const MeshNode> meshes, const std::function<bool(std::size_t vertex)>& moves) const {
  const auto is_moved = [&](const VertexRange& range) {
    for (std::size_t v = range.first; v < range.first + range.count; ++v) {
      if (moves(v)) return true;
    }
    return false;
  };
  std::vector<MeshNode> moved;
  for (const MeshNode& one : meshes) {
    const auto ranges = ranges_.find(one.mesh);
    if (ranges == ranges_.end() || std::ranges::any_of(ranges->second, is_moved)) {
      moved.push_back(one);
    }
  }
  if (moved.empty() && !meshes.empty()) moved.push_back(meshes[0]);
  return moved;
}

void Document::set_targets(std::span<const MeshNode> meshes,
                           const std::vector<std::map<std::string, int>>& targets,
                           std::span<const std::string> names) {
  tinygltf::Value::Array list;
  for (const std::string& name : names) list.emplace_back(name);
  for (const MeshNode& made : meshes) {
    tinygltf::Mesh& changed = gltf.meshes[static_cast<std::size_t>(made.mesh)];
    for (tinygltf::Primitive& primitive : changed.primitives) primitive.targets = targets;
    changed.extras =
        tinygltf::Value(tinygltf::Value::Object{{"targetNames", tinygltf::Value(list)}});
  }
  for (const auto& [index, values] : displacements_) {
    if (!ranges_.empty()) break;
    tinygltf::Accessor whole = gltf.accessors[static_cast<std::size_t>(index)];
    fill_displacements(values, whole);
    gltf.accessors[static_cast<std::size_t>(index)] = std::move(whole);
  }
  for_each_own_primitive(
      meshes, [&](tinygltf::Primitive& primitive, const VertexRange& range, bool is_first) {
        for (auto& target : primitive.targets) target = attributes_of(target, range, is_first);
      });
}

}  // namespace krok::gltf
