#pragma once

#include <tiny_gltf.h>

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/result.h"
#include "nodes/scene.h"

// Private to this folder: bounds-checked reading of accessors.

namespace krok::gltf {

using nodes::Shared;

// Reads accessors of a parsed file out of its buffers. Nothing in `model` is trusted: every index,
// offset, stride and count is checked against the bytes that are there; values must be finite.
// Memory handed out in all is held under `most_bytes`, so that many accessors of one view cannot
// multiply it. Codes gltf-accessor, gltf-value, gltf-too-large.
class Accessors {
 public:
  Accessors(const tinygltf::Model& model, std::vector<std::span<const std::byte>> buffers,
            std::uint64_t most_bytes)
      : model_(model), buffers_(std::move(buffers)), bytes_left_(most_bytes) {}

  // Floats, or normalised or plain integers turned into floats. `type` is a TINYGLTF_TYPE_*. The
  // same accessor asked for twice gives the same memory.
  Result<Shared<float>> scalars(int index);
  Result<Shared<Vec2f>> vectors2(int index);
  Result<Shared<Vec3f>> vectors3(int index);
  Result<std::vector<Mat4>> matrices(int index);

  // A copy of its own. Values of animation samplers: scalars or vectors one after the other.
  Result<Shared<float>> flat(int index, int components);

  // Unsigned integers: SCALAR for indices, VEC4 for joints; the latter one after the other.
  Result<std::vector<std::uint32_t>> integers(int index, int type);

  // Numbers of VEC4, one after the other.
  Result<std::vector<float>> vectors4(int index);

  // Takes from the memory that is left.
  Status reserve(std::uint64_t bytes);

 private:
  struct Layout;
  Result<Layout> layout(int index) const;
  Result<Layout> view_layout(int view, std::uint64_t offset, std::uint64_t count,
                             std::uint64_t element_size, bool strided,
                             const std::string& name) const;
  template <typename Number>
  Status fill(int index, std::span<Number> numbers) const;
  template <typename Number>
  Status fill_sparse(int index, std::span<Number> numbers) const;
  Result<std::size_t> check_type(int index, int type) const;
  template <typename T>
  Result<Shared<T>> cached(int index, int type, std::map<int, Shared<T>>& cache);

  const tinygltf::Model& model_;
  std::vector<std::span<const std::byte>> buffers_;
  std::uint64_t bytes_left_;
  std::map<int, Shared<float>> scalars_;
  std::map<int, Shared<Vec2f>> vectors2_;
  std::map<int, Shared<Vec3f>> vectors3_;
};

}  // namespace krok::gltf
