#include <meshoptimizer.h>

#include <algorithm>
#include <string_view>
#include <unordered_map>

#include "formats/gltf/gltf_writer.h"
#include "formats/gltf/quantize_internal.h"

namespace krok::gltf {

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
