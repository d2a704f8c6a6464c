#pragma once

#include <tiny_gltf.h>

#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "core/result.h"
#include "nodes/scene.h"

// Private to this folder: bounds-checked reading of accessors.

namespace krok::gltf {

using nodes::Shared;

// Reads the accessors of a parsed file. Nothing in `model` is trusted: every index, offset, stride
// and count is checked against the size of the buffers; values must be finite. The total memory
// handed out is limited to `most_bytes`, so many accessors of one view cannot multiply it. Codes:
// gltf-accessor, gltf-value, gltf-too-large.
class Accessors {
 public:
  Accessors(const tinygltf::Model& model, std::vector<std::span<const std::byte>> buffers,
            std::uint64_t most_bytes)
      : model_(model), buffers_(std::move(buffers)), bytes_left_(most_bytes) {}

  // Floats, or integers (normalised or not) converted to floats. Repeated calls for an accessor
  // share memory.
  Result<Shared<float>> scalars(int index);
  Result<Shared<Vec2f>> vectors2(int index);
  Result<Shared<Vec3f>> vectors3(int index);
  Result<std::vector<Mat4>> matrices(int index);

  // A copy, for animation samplers: scalars or vectors of `components`, contiguous.
  Result<Shared<float>> flat(int index, int components);

  // Unsigned integers, contiguous. `type`: TINYGLTF_TYPE_SCALAR (indices) or _VEC4 (joints).
  Result<std::vector<std::uint32_t>> integers(int index, int type);

  // Colours of VEC3 or VEC4; alpha is 1 where there is none. Repeated calls share memory.
  Result<Shared<Vec4f>> colours(int index);

  // VEC4 values, contiguous.
  Result<std::vector<float>> vectors4(int index);

  // Subtracts from the memory budget.
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
  std::map<int, Shared<Vec4f>> colours_;
};

}  // namespace krok::gltf
