#include <meshoptimizer.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstring>
#include <map>
#include <string_view>
#include <unordered_map>

#include "core/numbers.h"
#include "formats/gltf/buffers_internal.h"
#include "formats/gltf/document_internal.h"
#include "formats/gltf/glb_container_internal.h"
#include "formats/gltf/gltf_writer.h"
#include "formats/gltf/quantize_internal.h"

// EXT_meshopt_compression. Buffer views of one kind are put together into one, which makes the JSON
// shorter, and encoded. Source: https://github.com/KhronosGroup/glTF, extensions/2.0/Vendor.

namespace krok::gltf {

namespace {

using OrderedJson = nlohmann::ordered_json;

constexpr const char* kMeshoptName = "EXT_meshopt_compression";

// What buffer views must have in common to be put together.
struct ViewKind {
  int target = 0;  // of the view
  std::size_t stride = 0;
  int component = 0, type = 0;  // of the accessor; 0: not of an accessor (an image)
  Filter filter = Filter::none;

  auto operator<=>(const ViewKind&) const = default;  // NOLINT(modernize-use-nullptr): of its own 0
};

struct ViewGroup {
  ViewKind kind;
  std::vector<std::byte> bytes;
};

std::size_t element_size(const tinygltf::Accessor& accessor) {
  return static_cast<std::size_t>(
      tinygltf::GetComponentSizeInBytes(static_cast<std::uint32_t>(accessor.componentType)) *
      tinygltf::GetNumComponentsInType(static_cast<std::uint32_t>(accessor.type)));
}

const char* name_of(Filter filter) {
  if (filter == Filter::octahedral) return "OCTAHEDRAL";
  return filter == Filter::quaternion ? "QUATERNION" : "EXPONENTIAL";
}

bool is_index(const ViewKind& kind) {
  return kind.target == TINYGLTF_TARGET_ELEMENT_ARRAY_BUFFER;
}

// Whether the extension has a mode for it.
bool is_encodable(const ViewKind& kind) {
  if (kind.component == 0) return false;
  if (is_index(kind)) return kind.stride == 2 || kind.stride == 4;
  return kind.stride % 4 == 0 && kind.stride <= 256;
}

std::vector<unsigned char> encode_indices(const ViewGroup& group) {
  const std::size_t stride = group.kind.stride, count = group.bytes.size() / stride;
  std::vector<unsigned> indices(count);
  unsigned largest = 0;
  for (std::size_t i = 0; i < count; ++i) {
    std::uint32_t index = 0;
    std::memcpy(&index, &group.bytes[i * stride], stride);
    indices[i] = index;
    largest = std::max(largest, index);
  }
  std::vector<unsigned char> encoded(
      meshopt_encodeIndexBufferBound(count, std::size_t{largest} + 1));
  meshopt_encodeIndexVersion(1);
  encoded.resize(meshopt_encodeIndexBuffer(encoded.data(), encoded.size(), indices.data(), count));
  return encoded;
}

class Compressor {
 public:
  Compressor(const tinygltf::Model& model, std::span<const std::byte> data,
             const std::map<int, Filter>& filters, OrderedJson& json)
      : model_(model), data_(data), filters_(filters), json_(json) {}

  // Rewrites the JSON; returns the bytes of the only buffer that has some.
  std::vector<std::byte> compress() {
    find_kinds();
    for (std::size_t v = 0; v < model_.bufferViews.size(); ++v) place(v);
    for (OrderedJson& accessor : json_["accessors"]) move(accessor);
    if (json_.contains("images")) {
      for (OrderedJson& image : json_["images"]) {
        if (image.contains("bufferView")) {
          image["bufferView"] = places_[image["bufferView"].get<std::size_t>()].group;
        }
      }
    }
    shorten_json();
    write_views();
    return std::move(buffer_);
  }

  std::size_t unpacked_size() const { return unpacked_; }

 private:
  struct Place {
    std::size_t group = 0, offset = 0;
  };

  void find_kinds() {
    kinds_.resize(model_.bufferViews.size());
    for (const tinygltf::Accessor& accessor : model_.accessors) {
      const auto view = static_cast<std::size_t>(accessor.bufferView);
      const tinygltf::BufferView& source = model_.bufferViews[view];
      kinds_[view] = {source.target,
                      source.byteStride > 0 ? source.byteStride : element_size(accessor),
                      accessor.componentType, accessor.type, Filter::none};
      if (const auto found = filters_.find(accessor.bufferView); found != filters_.end()) {
        kinds_[view].filter = found->second;
      }
    }
    find_weights();
  }

  // The codec looks for what repeats from one element to the next: a key of all targets, or as many
  // as have a size that it takes.
  void find_weights() {
    for (const tinygltf::Animation& animation : model_.animations) {
      for (const tinygltf::AnimationChannel& channel : animation.channels) {
        if (channel.target_path != "weights") continue;
        const auto& sampler = animation.samplers[static_cast<std::size_t>(channel.sampler)];
        const auto& keys = model_.accessors[static_cast<std::size_t>(sampler.input)];
        const auto& weights = model_.accessors[static_cast<std::size_t>(sampler.output)];
        const std::size_t size = element_size(weights) * (weights.count / keys.count);
        for (const std::size_t keys_at_once : {1, 2, 4}) {
          const std::size_t stride = size * keys_at_once;
          if (stride % 4 != 0 || stride > 256) continue;
          kinds_[static_cast<std::size_t>(weights.bufferView)].stride = stride;
          break;
        }
      }
    }
  }

  // Images and what cannot be encoded stay views of their own.
  void place(std::size_t view) {
    const tinygltf::BufferView& source = model_.bufferViews[view];
    const ViewKind kind = kinds_[view];
    std::size_t group = groups_.size();
    if (is_encodable(kind)) group = numbers_.emplace(kind, group).first->second;
    if (group == groups_.size()) groups_.push_back({kind, {}});
    std::vector<std::byte>& bytes = groups_[group].bytes;
    places_.push_back({group, bytes.size()});
    const auto from = data_.subspan(source.byteOffset, source.byteLength);
    bytes.insert(bytes.end(), from.begin(), from.end());
    if (is_encodable(kind))
      bytes.resize((bytes.size() + kind.stride - 1) / kind.stride * kind.stride);
  }

  void move(OrderedJson& accessor) const {
    const Place& place = places_[accessor["bufferView"].get<std::size_t>()];
    const std::size_t offset = place.offset + accessor.value("byteOffset", std::size_t{0});
    accessor["bufferView"] = place.group;
    accessor.erase("byteOffset");
    if (offset > 0) accessor["byteOffset"] = offset;
  }

  // Leaves out what is the default, and digits that no float has.
  void shorten_json() {
    if (json_.contains("animations")) {
      for (OrderedJson& animation : json_["animations"]) {
        for (OrderedJson& sampler : animation["samplers"]) {
          if (sampler.value("interpolation", "") == "LINEAR") sampler.erase("interpolation");
        }
      }
    }
    for (const char* const list : {"nodes", "accessors"}) {
      for (OrderedJson& object : json_[list]) {
        for (const char* const place : {"translation", "rotation", "scale", "min", "max"}) {
          if (!object.contains(place)) continue;
          for (OrderedJson& number : object[place]) {
            const auto value = number.get<double>();
            number = parse_finite(shortest(static_cast<float>(value))).value_or(value);
            if (std::trunc(value) == value && std::abs(value) < 1e6) number = std::llround(value);
          }
        }
      }
    }
  }

  void write_views() {
    OrderedJson views = OrderedJson::array();
    for (const ViewGroup& group : groups_) {
      OrderedJson view = {{"buffer", 0}, {"byteLength", group.bytes.size()}};
      if (!is_encodable(group.kind)) {
        view["byteOffset"] = append_aligned(group.bytes, buffer_);
        if (group.kind.target != 0) view["target"] = group.kind.target;
        views.push_back(std::move(view));
        continue;
      }
      const auto encoded = is_index(group.kind) ? encode_indices(group)
                                                : encode_attributes(group.bytes, group.kind.stride);
      assert(!encoded.empty());
      OrderedJson extension = {
          {"buffer", 0},
          {"byteLength", encoded.size()},
          {"byteOffset", append_aligned(std::as_bytes(std::span(encoded)), buffer_)},
          {"byteStride", group.kind.stride},
          {"count", group.bytes.size() / group.kind.stride},
          {"mode", is_index(group.kind) ? "TRIANGLES" : "ATTRIBUTES"}};
      if (group.kind.filter != Filter::none) extension["filter"] = name_of(group.kind.filter);
      unpacked_ = (unpacked_ + kAlignment - 1) / kAlignment * kAlignment;
      view["buffer"] = 1;
      view["byteOffset"] = unpacked_;
      if (group.kind.target == TINYGLTF_TARGET_ARRAY_BUFFER) view["byteStride"] = group.kind.stride;
      if (group.kind.target != 0) view["target"] = group.kind.target;
      view["extensions"] = {{kMeshoptName, extension}};
      unpacked_ += group.bytes.size();
      views.push_back(std::move(view));
    }
    json_["bufferViews"] = std::move(views);
  }

  const tinygltf::Model& model_;
  const std::span<const std::byte> data_;
  const std::map<int, Filter>& filters_;
  OrderedJson& json_;
  std::vector<ViewKind> kinds_;  // [views]
  std::vector<Place> places_;    // [views]
  std::vector<ViewGroup> groups_;
  std::map<ViewKind, std::size_t> numbers_;
  std::vector<std::byte> buffer_;
  std::size_t unpacked_ = 0;
};

}  // namespace

std::vector<unsigned char> encode_attributes(std::span<const std::byte> bytes, std::size_t stride) {
  const std::size_t count = bytes.size() / stride;
  std::vector<unsigned char> encoded(meshopt_encodeVertexBufferBound(count, stride));
  meshopt_encodeVertexVersion(0);
  encoded.resize(
      meshopt_encodeVertexBuffer(encoded.data(), encoded.size(), bytes.data(), count, stride));
  return encoded;
}

Status Document::write_compressed(OutputFile& file) {
  if (size_ > kMaxDataBytes) return Error("gltf-too-large", "the file exceeds glTF's limit");
  std::vector<std::byte> data;
  for (const Part& part : parts_) {
    const auto bytes = part.bytes();
    data.insert(data.end(), bytes.begin(), bytes.end());
  }
  for (auto* names : {&gltf.extensionsUsed, &gltf.extensionsRequired}) {
    names->emplace_back(kMeshoptName);
  }
  OrderedJson json;
  try {
    json = OrderedJson::parse(json_text());
  } catch (const nlohmann::json::exception&) {
    return Error("gltf-name", "a name is not valid UTF-8, which glTF requires",
                 "rename the joint or material");
  }
  Compressor compressor(gltf, data, filters_, json);
  const std::vector<std::byte> packed = compressor.compress();
  // The buffer that the views would have, which viewers make up themselves.
  const OrderedJson unpacked = {{"byteLength", compressor.unpacked_size()},
                                {"extensions", {{kMeshoptName, {{"fallback", true}}}}}};
  auto glb = assemble_glb(json, packed, std::span(&unpacked, 1));
  if (!glb) return glb.error();
  return file.write(*glb);
}

namespace {

// Moves the rows of [first, first + remap.size()) to their new places; of several that come to one
// place, the first stays. The vector keeps its length.
template <typename Value>
void move_rows(std::vector<Value>& values, std::size_t each, std::size_t first,
               const std::vector<unsigned>& remap) {
  if (values.empty()) return;
  const auto begin = values.begin() + static_cast<std::ptrdiff_t>(first * each);
  const std::vector<Value> before(begin, begin + static_cast<std::ptrdiff_t>(remap.size() * each));
  for (std::size_t v = remap.size(); v-- > 0;) {
    for (std::size_t k = 0; k < each; ++k) {
      values[(first + remap[v]) * each + k] = before[v * each + k];
    }
  }
}

// Gives the vertices of a model new places, of which there are `count`.
void move_vertices(Model& model, MorphSet& morphs, const std::vector<unsigned>& remap,
                   std::size_t count) {
  const std::size_t before = model.positions.size();
  const auto move = [&](auto& values, std::size_t each) {
    move_rows(values, each, 0, remap);
    if (!values.empty()) values.resize(count * each);
  };
  move(model.positions, 1);
  move(model.normals, 1);
  move(model.texture_coordinates, 1);
  for (auto& set : model.more_texture_coordinates) move(set, 1);
  move(model.tangents, 1);
  move(model.colours, 1);
  move(model.influence_joints, static_cast<std::size_t>(model.influences_per_vertex));
  move(model.influence_weights, static_cast<std::size_t>(model.influences_per_vertex));
  for (auto* targets : {&morphs.positions, &morphs.normals}) {
    if (targets->empty()) continue;
    std::vector<Vec3f> kept;
    for (std::size_t t = 0; t < morphs.names.size(); ++t) {
      move_rows(*targets, 1, t * before, remap);
      const auto begin = targets->begin() + static_cast<std::ptrdiff_t>(t * before);
      kept.insert(kept.end(), begin, begin + static_cast<std::ptrdiff_t>(count));
    }
    *targets = std::move(kept);
  }
  if (!morphs.names.empty()) morphs.vertex_count = static_cast<int>(count);
  for (auto& triangle : model.triangles) {
    for (std::uint32_t& corner : triangle) corner = remap[corner];
  }
}

// The part that uses a vertex first, or the number of parts.
std::vector<std::uint32_t> first_parts(const Model& model) {
  const auto parts = static_cast<std::uint32_t>(model.parts.size());
  std::vector<std::uint32_t> first(model.positions.size(), parts);
  for (std::uint32_t p = parts; p-- > 0;) {
    const Model::Part& part = model.parts[p];
    for (std::uint32_t t = 0; t < part.triangle_count; ++t) {
      for (const std::uint32_t corner : model.triangles[part.first_triangle + t]) first[corner] = p;
    }
  }
  return first;
}

// Vertices of different parts stay apart, so that parts have vertices of their own.
std::vector<std::uint32_t> weld(Model& model, MorphSet& morphs,
                                const std::optional<Quantization>& quantization) {
  const VertexRows rows = vertex_rows(model, morphs, quantization);
  const std::vector<std::uint32_t> parts = first_parts(model);
  const std::string_view bytes(reinterpret_cast<const char*>(rows.bytes.data()), rows.bytes.size());
  std::vector<std::unordered_map<std::string_view, unsigned>> known(model.parts.size() + 1);
  std::vector<unsigned> remap(model.positions.size());
  unsigned count = 0;
  for (std::size_t v = 0; v < remap.size(); ++v) {
    const auto [place, made] =
        known[parts[v]].emplace(bytes.substr(v * rows.size, rows.size), count);
    if (made) ++count;
    remap[v] = place->second;
  }
  move_vertices(model, morphs, remap, count);
  return remap;
}

}  // namespace

std::vector<std::uint32_t> order_for_compression(Model& model, MorphSet& morphs,
                                                 const std::optional<Quantization>& quantization) {
  std::vector<std::uint32_t> places = weld(model, morphs, quantization);
  const std::size_t vertices = model.positions.size();
  std::vector<unsigned> indices;
  for (const auto& triangle : model.triangles) {
    indices.insert(indices.end(), triangle.begin(), triangle.end());
  }
  for (const Model::Part& part : model.parts) {
    // The order of strips, which is smaller than that which vertex caches like best.
    unsigned* const first = indices.data() + std::size_t{3} * part.first_triangle;
    meshopt_optimizeVertexCacheStrip(first, first, std::size_t{3} * part.triangle_count, vertices);
  }
  for (std::size_t i = 0; i < indices.size(); ++i) model.triangles[i / 3][i % 3] = indices[i];
  std::vector<unsigned> remap(vertices);
  std::size_t used =
      meshopt_optimizeVertexFetchRemap(remap.data(), indices.data(), indices.size(), vertices);
  for (unsigned& place : remap) {  // vertices without a triangle are last
    if (place == ~0u) place = static_cast<unsigned>(used++);
  }
  move_vertices(model, morphs, remap, vertices);
  for (std::uint32_t& place : places) place = remap[place];
  return places;
}

}  // namespace krok::gltf
