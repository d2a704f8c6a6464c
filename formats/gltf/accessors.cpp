#include "formats/gltf/accessors_internal.h"

#include <fmt/format.h>

#include <cmath>
#include <cstring>
#include <type_traits>

#include "formats/gltf/reader_internal.h"

namespace krok::gltf {

namespace {

Error bad_accessor(int index, const std::string& what) {
  return Error("gltf-accessor", fmt::format("accessor {}: {}", index, what), kDamagedHint);
}

// Bytes per component; 0 for an invalid type.
std::uint64_t component_size(int type) {
  switch (type) {
    case TINYGLTF_COMPONENT_TYPE_BYTE:
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
      return 1;
    case TINYGLTF_COMPONENT_TYPE_SHORT:
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
      return 2;
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
    case TINYGLTF_COMPONENT_TYPE_FLOAT:
      return 4;
    default:
      return 0;
  }
}

int component_count(int type) {
  switch (type) {
    case TINYGLTF_TYPE_SCALAR:
      return 1;
    case TINYGLTF_TYPE_VEC2:
      return 2;
    case TINYGLTF_TYPE_VEC3:
      return 3;
    case TINYGLTF_TYPE_VEC4:
      return 4;
    case TINYGLTF_TYPE_MAT4:
      return 16;
    default:
      return 0;  // MAT2 and MAT3 are not used
  }
}

const char* type_name(int type) {
  switch (type) {
    case TINYGLTF_TYPE_SCALAR:
      return "SCALAR";
    case TINYGLTF_TYPE_VEC2:
      return "VEC2";
    case TINYGLTF_TYPE_VEC3:
      return "VEC3";
    case TINYGLTF_TYPE_VEC4:
      return "VEC4";
    case TINYGLTF_TYPE_MAT4:
      return "MAT4";
    default:
      return "a matrix";
  }
}

template <typename T>
T load(const std::byte* bytes) {
  T value;
  std::memcpy(&value, bytes, sizeof(T));
  return value;
}

// Normalised integers: section 3.6.2.2 of the specification.
template <typename Integer, typename Number>
Number convert(const std::byte* bytes, bool normalized) {
  const Integer value = load<Integer>(bytes);
  if constexpr (std::is_floating_point_v<Number>) {
    if (normalized) {
      const auto scaled =
          static_cast<Number>(value) / static_cast<Number>(std::numeric_limits<Integer>::max());
      return std::max(scaled, Number(-1));
    }
  }
  return static_cast<Number>(value);
}

template <typename Number>
Number component(const std::byte* bytes, int type, bool normalized) {
  switch (type) {
    case TINYGLTF_COMPONENT_TYPE_BYTE:
      return convert<std::int8_t, Number>(bytes, normalized);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
      return convert<std::uint8_t, Number>(bytes, normalized);
    case TINYGLTF_COMPONENT_TYPE_SHORT:
      return convert<std::int16_t, Number>(bytes, normalized);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
      return convert<std::uint16_t, Number>(bytes, normalized);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
      return convert<std::uint32_t, Number>(bytes, normalized);
    default:
      return convert<float, Number>(bytes, false);
  }
}

template <typename Number>
bool is_finite(Number value) {
  if constexpr (std::is_floating_point_v<Number>) return std::isfinite(value);
  return true;
}

}  // namespace

// Element i is at data[i * stride]. If data is empty, all elements are zero.
struct Accessors::Layout {
  std::span<const std::byte> data;
  std::uint64_t stride = 0;
};

Status Accessors::reserve(std::uint64_t bytes) {
  if (bytes > bytes_left_) {
    return Error("gltf-too-large", "the accessors describe far more data than the file contains",
                 "many accessors share the same bytes; export without sharing");
  }
  bytes_left_ -= bytes;
  return {};
}

Result<Accessors::Layout> Accessors::view_layout(int view, std::uint64_t offset,
                                                 std::uint64_t count, std::uint64_t element_size,
                                                 bool strided, const std::string& name) const {
  const auto fail = [&](const std::string& what) {
    return Error("gltf-accessor", fmt::format("{}: {}", name, what), kDamagedHint);
  };
  if (view < 0 || static_cast<std::size_t>(view) >= model_.bufferViews.size()) {
    return fail(fmt::format("buffer view {} does not exist", view));
  }
  const tinygltf::BufferView& buffer_view = model_.bufferViews[static_cast<std::size_t>(view)];
  if (buffer_view.buffer < 0 || static_cast<std::size_t>(buffer_view.buffer) >= buffers_.size()) {
    return fail(fmt::format("buffer {} does not exist", buffer_view.buffer));
  }
  const auto buffer = buffers_[static_cast<std::size_t>(buffer_view.buffer)];
  if (buffer_view.byteOffset > buffer.size() ||
      buffer_view.byteLength > buffer.size() - buffer_view.byteOffset) {
    return fail(fmt::format("buffer view {} exceeds its buffer of {} bytes", view, buffer.size()));
  }
  Layout layout;
  layout.stride = strided && buffer_view.byteStride > 0 ? buffer_view.byteStride : element_size;
  if (element_size == 0 || layout.stride < element_size) {
    return fail(
        fmt::format("elements of {} bytes have a stride of {} bytes", element_size, layout.stride));
  }
  const std::uint64_t length = buffer_view.byteLength;
  // Avoids overflow: bounds count by length / stride + 1.
  if (offset > length ||
      (count > 0 && (element_size > length - offset ||
                     (count - 1) > (length - offset - element_size) / layout.stride))) {
    return fail(fmt::format("{} elements exceed buffer view {} of {} bytes", count, view, length));
  }
  layout.data = buffer.subspan(buffer_view.byteOffset + offset, length - offset);
  return layout;
}

Result<Accessors::Layout> Accessors::layout(int index) const {
  const tinygltf::Accessor& accessor = model_.accessors[static_cast<std::size_t>(index)];
  if (accessor.bufferView < 0) return Layout{};
  const std::uint64_t size = component_size(accessor.componentType) *
                             static_cast<std::uint64_t>(component_count(accessor.type));
  return view_layout(accessor.bufferView, accessor.byteOffset, accessor.count, size, true,
                     fmt::format("accessor {}", index));
}

Result<std::size_t> Accessors::check_type(int index, int type) const {
  if (index < 0 || static_cast<std::size_t>(index) >= model_.accessors.size()) {
    return Error("gltf-accessor", fmt::format("accessor {} does not exist", index), kDamagedHint);
  }
  const tinygltf::Accessor& accessor = model_.accessors[static_cast<std::size_t>(index)];
  if (component_size(accessor.componentType) == 0) {
    return bad_accessor(
        index, fmt::format("component type {} is not a glTF type", accessor.componentType));
  }
  if (accessor.type != type) {
    return bad_accessor(
        index, fmt::format("is {}, expected {}", type_name(accessor.type), type_name(type)));
  }
  // Indices have 32 bits.
  if (accessor.count > 0xFFFFFFFFu) {
    return bad_accessor(index, fmt::format("too many elements ({})", accessor.count));
  }
  return accessor.count;
}

// `numbers` has count x components elements.
template <typename Number>
Status Accessors::fill(int index, std::span<Number> numbers) const {
  const tinygltf::Accessor& accessor = model_.accessors[static_cast<std::size_t>(index)];
  const auto where = layout(index);
  if (!where) return where.error();
  const auto components = static_cast<std::size_t>(component_count(accessor.type));
  const std::size_t size = component_size(accessor.componentType);
  if (!where->data.empty()) {
    for (std::size_t i = 0; i < accessor.count; ++i) {
      const std::byte* element = where->data.data() + i * where->stride;
      for (std::size_t c = 0; c < components; ++c) {
        numbers[i * components + c] =
            component<Number>(element + c * size, accessor.componentType, accessor.normalized);
      }
    }
  }
  if (accessor.sparse.isSparse) {
    if (auto filled = fill_sparse(index, numbers); !filled) return filled;
  }
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    if (is_finite(numbers[i])) continue;
    return Error(
        "gltf-value",
        fmt::format("element {} of accessor {} is not a finite number", i / components, index),
        "the data is damaged, or the exporter computed it wrongly");
  }
  return {};
}

template <typename Number>
Status Accessors::fill_sparse(int index, std::span<Number> numbers) const {
  const tinygltf::Accessor& accessor = model_.accessors[static_cast<std::size_t>(index)];
  const auto& sparse = accessor.sparse;
  const auto components = static_cast<std::size_t>(component_count(accessor.type));
  const std::size_t size = component_size(accessor.componentType);
  if (sparse.count < 0 || static_cast<std::size_t>(sparse.count) > accessor.count ||
      sparse.indices.byteOffset < 0 || sparse.values.byteOffset < 0) {
    return bad_accessor(index, "invalid sparse count or offset");
  }
  const auto count = static_cast<std::size_t>(sparse.count);
  const int index_type = sparse.indices.componentType;
  if (index_type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE &&
      index_type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT &&
      index_type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT) {
    return bad_accessor(index,
                        fmt::format("invalid component type {} of sparse indices", index_type));
  }
  const auto indices = view_layout(
      sparse.indices.bufferView, static_cast<std::uint64_t>(sparse.indices.byteOffset), count,
      component_size(index_type), false, fmt::format("sparse indices of accessor {}", index));
  if (!indices) return indices.error();
  const auto values = view_layout(
      sparse.values.bufferView, static_cast<std::uint64_t>(sparse.values.byteOffset), count,
      size * components, false, fmt::format("sparse values of accessor {}", index));
  if (!values) return values.error();
  for (std::size_t i = 0; i < count; ++i) {
    const auto target =
        component<std::uint32_t>(indices->data.data() + i * indices->stride, index_type, false);
    if (target >= accessor.count) {
      return bad_accessor(
          index, fmt::format("sparse index {} is out of range, there are {} elements", target,
                             accessor.count));
    }
    const std::byte* element = values->data.data() + i * values->stride;
    for (std::size_t c = 0; c < components; ++c) {
      numbers[target * components + c] =
          component<Number>(element + c * size, accessor.componentType, accessor.normalized);
    }
  }
  return {};
}

template <typename T>
Result<Shared<T>> Accessors::cached(int index, int type, std::map<int, Shared<T>>& cache) {
  if (const auto found = cache.find(index); found != cache.end()) return found->second;
  const auto count = check_type(index, type);
  if (!count) return count.error();
  // Check the layout before allocating.
  if (const auto where = layout(index); !where) return where.error();
  if (auto taken = reserve(*count * sizeof(T)); !taken) return taken.error();
  std::vector<T> values(*count);
  if constexpr (!std::is_same_v<T, float>) {
    for (T& value : values) value.setZero();
  }
  const auto components = static_cast<std::size_t>(component_count(type));
  const std::span<float> numbers(reinterpret_cast<float*>(values.data()), *count * components);
  if (auto filled = fill(index, numbers); !filled) return filled.error();
  auto shared = std::make_shared<const std::vector<T>>(std::move(values));
  cache.emplace(index, shared);
  return Shared<T>(shared);
}

Result<Shared<float>> Accessors::scalars(int index) {
  return cached(index, TINYGLTF_TYPE_SCALAR, scalars_);
}

Result<Shared<Vec2f>> Accessors::vectors2(int index) {
  static_assert(sizeof(Vec2f) == 2 * sizeof(float));
  return cached(index, TINYGLTF_TYPE_VEC2, vectors2_);
}

Result<Shared<Vec3f>> Accessors::vectors3(int index) {
  static_assert(sizeof(Vec3f) == 3 * sizeof(float));
  return cached(index, TINYGLTF_TYPE_VEC3, vectors3_);
}

Result<Shared<Vec4f>> Accessors::colours(int index) {
  if (const auto known = colours_.find(index); known != colours_.end()) return known->second;
  const bool has_alpha =
      index >= 0 && static_cast<std::size_t>(index) < model_.accessors.size() &&
      model_.accessors[static_cast<std::size_t>(index)].type == TINYGLTF_TYPE_VEC4;
  std::vector<Vec4f> colours;
  if (has_alpha) {
    const auto read = vectors4(index);
    if (!read) return read.error();
    for (std::size_t i = 0; i < read->size(); i += 4) {
      colours.emplace_back(Eigen::Map<const Vec4f>(&(*read)[i]));
    }
  } else {
    const auto read = vectors3(index);
    if (!read) return read.error();
    for (const Vec3f& colour : **read) colours.emplace_back(colour.x(), colour.y(), colour.z(), 1);
  }
  if (auto taken = reserve(colours.size() * sizeof(Vec4f)); !taken) return taken.error();
  const Shared<Vec4f> shared = std::make_shared<const std::vector<Vec4f>>(std::move(colours));
  colours_.emplace(index, shared);
  return shared;
}

Result<Shared<float>> Accessors::flat(int index, int components) {
  if (components == 1) return scalars(index);
  const int type = components == 4 ? TINYGLTF_TYPE_VEC4 : TINYGLTF_TYPE_VEC3;
  const auto count = check_type(index, type);
  if (!count) return count.error();
  if (const auto where = layout(index); !where) return where.error();
  const std::size_t numbers = *count * static_cast<std::size_t>(components);
  if (auto taken = reserve(numbers * sizeof(float)); !taken) return taken.error();
  std::vector<float> values(numbers, 0.0f);
  if (auto filled = fill(index, std::span(values)); !filled) return filled.error();
  return Shared<float>(std::make_shared<const std::vector<float>>(std::move(values)));
}

Result<std::vector<Mat4>> Accessors::matrices(int index) {
  const auto count = check_type(index, TINYGLTF_TYPE_MAT4);
  if (!count) return count.error();
  if (model_.accessors[static_cast<std::size_t>(index)].componentType !=
      TINYGLTF_COMPONENT_TYPE_FLOAT) {
    return bad_accessor(index, "matrices must be floats");
  }
  if (const auto where = layout(index); !where) return where.error();
  if (auto taken = reserve(*count * sizeof(Mat4)); !taken) return taken.error();
  std::vector<Mat4> values(*count, Mat4::Zero());  // column-major, as in glTF
  const std::span<double> numbers(reinterpret_cast<double*>(values.data()), *count * 16);
  if (auto filled = fill(index, numbers); !filled) return filled.error();
  return values;
}

Result<std::vector<std::uint32_t>> Accessors::integers(int index, int type) {
  const auto count = check_type(index, type);
  if (!count) return count.error();
  const tinygltf::Accessor& accessor = model_.accessors[static_cast<std::size_t>(index)];
  if (accessor.componentType != TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE &&
      accessor.componentType != TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT &&
      accessor.componentType != TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT) {
    return bad_accessor(index, "indices must be unsigned integers");
  }
  if (const auto where = layout(index); !where) return where.error();
  const std::size_t numbers = *count * static_cast<std::size_t>(component_count(type));
  if (auto taken = reserve(numbers * sizeof(std::uint32_t)); !taken) return taken.error();
  std::vector<std::uint32_t> values(numbers, 0);
  if (auto filled = fill(index, std::span(values)); !filled) return filled.error();
  return values;
}

Result<std::vector<float>> Accessors::vectors4(int index) {
  const auto count = check_type(index, TINYGLTF_TYPE_VEC4);
  if (!count) return count.error();
  if (const auto where = layout(index); !where) return where.error();
  if (auto taken = reserve(*count * 4 * sizeof(float)); !taken) return taken.error();
  std::vector<float> values(*count * 4, 0.0f);
  if (auto filled = fill(index, std::span(values)); !filled) return filled.error();
  return values;
}

}  // namespace krok::gltf
