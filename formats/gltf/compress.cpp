#include <meshoptimizer.h>

#include <algorithm>
#include <cassert>
#include <cstring>
#include <map>
#include <tuple>

#include "formats/gltf/assemble_glb_internal.h"
#include "formats/gltf/baked_writer.h"
#include "formats/gltf/document_internal.h"
#include "formats/gltf/gltf_writer.h"

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

  auto operator<=>(const ViewKind&) const = default;
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

std::vector<unsigned char> encode_attributes(const ViewGroup& group) {
  const std::size_t stride = group.kind.stride, count = group.bytes.size() / stride;
  std::vector<unsigned char> encoded(meshopt_encodeVertexBufferBound(count, stride));
  meshopt_encodeVertexVersion(0);
  encoded.resize(meshopt_encodeVertexBuffer(encoded.data(), encoded.size(), group.bytes.data(),
                                            count, stride));
  return encoded;
}

class Compressor {
 public:
  Compressor(const tinygltf::Model& model, std::span<const std::byte> data, OrderedJson& json)
      : model_(model), data_(data), json_(json) {}

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
                      accessor.componentType, accessor.type};
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
  }

  void move(OrderedJson& accessor) const {
    const Place& place = places_[accessor["bufferView"].get<std::size_t>()];
    const std::size_t offset = place.offset + accessor.value("byteOffset", std::size_t{0});
    accessor["bufferView"] = place.group;
    accessor.erase("byteOffset");
    if (offset > 0) accessor["byteOffset"] = offset;
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
      const auto encoded = is_index(group.kind) ? encode_indices(group) : encode_attributes(group);
      assert(!encoded.empty());
      const OrderedJson extension = {
          {"buffer", 0},
          {"byteLength", encoded.size()},
          {"byteOffset", append_aligned(std::as_bytes(std::span(encoded)), buffer_)},
          {"byteStride", group.kind.stride},
          {"count", group.bytes.size() / group.kind.stride},
          {"mode", is_index(group.kind) ? "TRIANGLES" : "ATTRIBUTES"}};
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
  OrderedJson& json_;
  std::vector<ViewKind> kinds_;  // [views]
  std::vector<Place> places_;    // [views]
  std::vector<ViewGroup> groups_;
  std::map<ViewKind, std::size_t> numbers_;
  std::vector<std::byte> buffer_;
  std::size_t unpacked_ = 0;
};

template <typename Value>
void reorder_rows(std::vector<Value>& values, std::size_t each, std::size_t first,
                  const std::vector<unsigned>& remap) {
  if (values.empty()) return;
  const auto begin = values.begin() + static_cast<std::ptrdiff_t>(first);
  std::vector<Value> before(begin, begin + static_cast<std::ptrdiff_t>(remap.size() * each));
  for (std::size_t v = 0; v < remap.size(); ++v) {
    for (std::size_t k = 0; k < each; ++k)
      values[first + remap[v] * each + k] = before[v * each + k];
  }
}

}  // namespace

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
  Compressor compressor(gltf, data, json);
  const std::vector<std::byte> packed = compressor.compress();
  // The buffer that the views would have, which viewers make up themselves.
  const OrderedJson unpacked = {{"byteLength", compressor.unpacked_size()},
                                {"extensions", {{kMeshoptName, {{"fallback", true}}}}}};
  auto glb = assemble_glb(json, packed, std::span(&unpacked, 1));
  if (!glb) return glb.error();
  return file.write(*glb);
}

void order_for_compression(Model& model, MorphSet& morphs) {
  const std::size_t vertices = model.positions.size();
  std::vector<unsigned> indices;
  for (const auto& triangle : model.triangles) {
    indices.insert(indices.end(), triangle.begin(), triangle.end());
  }
  for (const Model::Part& part : model.parts) {
    unsigned* const first = indices.data() + std::size_t{3} * part.first_triangle;
    meshopt_optimizeVertexCache(first, first, std::size_t{3} * part.triangle_count, vertices);
  }
  std::vector<unsigned> remap(vertices);
  std::size_t used =
      meshopt_optimizeVertexFetchRemap(remap.data(), indices.data(), indices.size(), vertices);
  for (unsigned& place : remap) {  // vertices without a triangle are last
    if (place == ~0u) place = static_cast<unsigned>(used++);
  }
  reorder_rows(model.positions, 1, 0, remap);
  reorder_rows(model.normals, 1, 0, remap);
  reorder_rows(model.texture_coordinates, 1, 0, remap);
  reorder_rows(model.tangents, 1, 0, remap);
  const auto places = static_cast<std::size_t>(model.influences_per_vertex);
  reorder_rows(model.influence_joints, places, 0, remap);
  reorder_rows(model.influence_weights, places, 0, remap);
  for (std::size_t t = 0; t < morphs.names.size(); ++t) {
    reorder_rows(morphs.positions, 1, t * vertices, remap);
    reorder_rows(morphs.normals, 1, t * vertices, remap);
  }
  for (std::size_t i = 0; i < indices.size(); ++i) {
    model.triangles[i / 3][i % 3] = remap[indices[i]];
  }
}

}  // namespace krok::gltf
