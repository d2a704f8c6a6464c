#include <draco/compression/decode.h>
#include <fmt/format.h>

#include <array>
#include <stdexcept>
#include <utility>

#include "core/bytes.h"
#include "core/child_process.h"
#include "formats/gltf/buffers_internal.h"
#include "formats/gltf/reader_internal.h"

namespace krok::gltf {

namespace {

// An attribute of a packed primitive, as its accessor declares it.
struct DracoAttribute {
  std::string name;
  std::uint32_t id = 0;  // in the packed mesh
  int accessor = -1;
  int component = 0;  // tinygltf's type
  std::size_t components = 0;
  std::size_t element_size = 0;  // bytes
};

struct DracoPrimitive {
  std::string name;
  std::span<const std::byte> bytes;
  std::vector<DracoAttribute> attributes;
};

Error bad_primitive(const std::string& name, const std::string& what) {
  return Error("gltf-compression", fmt::format("{} (KHR_draco_mesh_compression): {}", name, what),
               kDamagedHint);
}

Result<DracoPrimitive> look_up(const PackedPrimitive& packed, const tinygltf::Model& model,
                               const Buffers& buffers) {
  DracoPrimitive result;
  if (packed.mesh >= model.meshes.size() ||
      packed.primitive >= model.meshes[packed.mesh].primitives.size()) {
    return bad_primitive(fmt::format("mesh {}", packed.mesh), "cannot be read");
  }
  const tinygltf::Mesh& mesh = model.meshes[packed.mesh];
  const tinygltf::Primitive& primitive = mesh.primitives[packed.primitive];
  result.name =
      fmt::format("{}, primitive {}", label("mesh", packed.mesh, mesh.name), packed.primitive);
  if (packed.view >= model.bufferViews.size()) {
    return bad_primitive(result.name, fmt::format("buffer view {} does not exist", packed.view));
  }
  const tinygltf::BufferView& view = model.bufferViews[packed.view];
  if (!exists(view.buffer, buffers.views.size())) {
    return bad_primitive(result.name, fmt::format("buffer {} does not exist", view.buffer));
  }
  const auto buffer = buffers.views[static_cast<std::size_t>(view.buffer)];
  if (view.byteOffset > buffer.size() || view.byteLength > buffer.size() - view.byteOffset) {
    return bad_primitive(result.name, fmt::format("buffer view {} exceeds its buffer of {} bytes",
                                                  packed.view, buffer.size()));
  }
  result.bytes = buffer.subspan(view.byteOffset, view.byteLength);
  for (const auto& [name, id] : packed.attributes) {
    const auto declared = primitive.attributes.find(name);
    if (declared == primitive.attributes.end()) continue;
    if (!exists(declared->second, model.accessors.size()) || id > 0xFFFFFFFFu) {
      return bad_primitive(result.name, fmt::format("{} has no accessor", name));
    }
    const tinygltf::Accessor& accessor =
        model.accessors[static_cast<std::size_t>(declared->second)];
    const int size =
        tinygltf::GetComponentSizeInBytes(static_cast<std::uint32_t>(accessor.componentType));
    const int components =
        tinygltf::GetNumComponentsInType(static_cast<std::uint32_t>(accessor.type));
    if (size <= 0 || size > 4 || components <= 0 || components > 4) {
      return bad_primitive(result.name, fmt::format("{} has an invalid type", name));
    }
    result.attributes.push_back({name, static_cast<std::uint32_t>(id), declared->second,
                                 accessor.componentType, static_cast<std::size_t>(components),
                                 static_cast<std::size_t>(size * components)});
  }
  return result;
}

// ---- in the child process ----

template <typename Number>
void append_values(const draco::PointAttribute& values, std::uint32_t points,
                   std::size_t components, ByteWriter& out) {
  std::array<Number, 4> element{};
  for (draco::PointIndex i(0); i < points; ++i) {
    const bool converted = values.ConvertValue<Number>(
        values.mapped_index(i), static_cast<std::int8_t>(components), element.data());
    if (!converted) throw std::runtime_error("a value does not fit its accessor's type");
    out.append(std::as_bytes(std::span(element).first(components)));
  }
}

void append_attribute(const draco::Mesh& mesh, const DracoAttribute& wanted, ByteWriter& out) {
  const draco::PointAttribute* values = mesh.GetAttributeByUniqueId(wanted.id);
  if (values == nullptr) throw std::runtime_error(wanted.name + " is not in the packed mesh");
  const std::uint32_t points = mesh.num_points();
  switch (wanted.component) {
    case TINYGLTF_COMPONENT_TYPE_BYTE:
      return append_values<std::int8_t>(*values, points, wanted.components, out);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
      return append_values<std::uint8_t>(*values, points, wanted.components, out);
    case TINYGLTF_COMPONENT_TYPE_SHORT:
      return append_values<std::int16_t>(*values, points, wanted.components, out);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
      return append_values<std::uint16_t>(*values, points, wanted.components, out);
    case TINYGLTF_COMPONENT_TYPE_FLOAT:
      return append_values<float>(*values, points, wanted.components, out);
    default:
      return append_values<std::uint32_t>(*values, points, wanted.components, out);
  }
}

// For each primitive the numbers of points and faces, the indices, the attributes in their order.
std::vector<std::byte> decode(const std::vector<DracoPrimitive>& primitives) {
  ByteWriter out;
  for (const DracoPrimitive& primitive : primitives) {
    draco::DecoderBuffer buffer;
    buffer.Init(reinterpret_cast<const char*>(primitive.bytes.data()), primitive.bytes.size());
    draco::Decoder decoder;
    auto decoded = decoder.DecodeMeshFromBuffer(&buffer);
    if (!decoded.ok()) {
      throw std::runtime_error(primitive.name + ": " + decoded.status().error_msg_string());
    }
    const draco::Mesh& mesh = *decoded.value();
    out.write(static_cast<std::uint32_t>(mesh.num_points()));
    out.write(static_cast<std::uint32_t>(mesh.num_faces()));
    for (draco::FaceIndex f(0); f < mesh.num_faces(); ++f) {
      for (const auto& corner : mesh.face(f)) out.write(corner.value());
    }
    for (const DracoAttribute& wanted : primitive.attributes) append_attribute(mesh, wanted, out);
  }
  return std::move(out.buffer());
}

// ---- in the caller ----

// Lets a new accessor, like `like`, refer to bytes of the buffer that is appended next.
int add_unpacked(tinygltf::Model& model, const Buffers& buffers, tinygltf::Accessor like,
                 std::size_t offset, std::size_t size, std::size_t count) {
  tinygltf::BufferView view;
  view.buffer = static_cast<int>(buffers.views.size());
  view.byteOffset = offset;
  view.byteLength = size;
  model.bufferViews.push_back(std::move(view));
  like.bufferView = static_cast<int>(model.bufferViews.size()) - 1;
  like.byteOffset = 0;
  like.count = count;
  like.sparse.isSparse = false;
  model.accessors.push_back(std::move(like));
  return static_cast<int>(model.accessors.size()) - 1;
}

Status take(const PackedPrimitive& packed, const DracoPrimitive& decoded, ByteReader& in,
            tinygltf::Model& model, const Buffers& buffers) {
  tinygltf::Primitive& primitive = model.meshes[packed.mesh].primitives[packed.primitive];
  const std::size_t points = in.read<std::uint32_t>(), faces = in.read<std::uint32_t>();
  const auto next = [&](std::size_t count, std::size_t element_size) {
    const std::size_t offset = in.position();
    in.take(count * element_size);
    return offset;
  };
  tinygltf::Accessor indices;
  indices.componentType = TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT;
  indices.type = TINYGLTF_TYPE_SCALAR;
  const std::size_t corners = 3 * faces;
  primitive.indices = add_unpacked(model, buffers, indices, next(corners, 4), corners * 4, corners);
  primitive.mode = TINYGLTF_MODE_TRIANGLES;
  for (const DracoAttribute& one : decoded.attributes) {
    const std::size_t offset = next(points, one.element_size);
    primitive.attributes[one.name] =
        add_unpacked(model, buffers, model.accessors[static_cast<std::size_t>(one.accessor)],
                     offset, points * one.element_size, points);
  }
  if (!in.ok()) return bad_primitive(decoded.name, "the decoder's result is incomplete");
  return {};
}

Error error_of(const ChildReport& report) {
  if (report.end == ChildEnd::out_of_memory || report.end == ChildEnd::result_too_large) {
    return Error(
        "gltf-too-large", "the Draco data unpacks to far more than the file contains",
        std::string("allow more with --limit-memory; if that does not help, ") + kDamagedHint);
  }
  if (report.end == ChildEnd::not_started) {
    return Error("gltf-compression", "cannot start a process to unpack Draco data: " + report.what,
                 "close some programs and try again");
  }
  const std::string what = report.end == ChildEnd::out_of_time
                               ? "the decoder was stopped after " + report.what
                               : report.what;
  return Error(
      "gltf-compression", "cannot unpack Draco data: " + what,
      (report.end == ChildEnd::out_of_time ? "allow more with --limit-time; if that does not help, "
                                           : "") +
          std::string(kDamagedHint));
}

}  // namespace

Status unpack_draco(ParsedJson& parsed, Buffers& buffers, std::uint64_t most_bytes,
                    const GivenLimits& given) {
  if (parsed.packed_primitives.empty()) return {};
  std::vector<DracoPrimitive> primitives;
  std::uint64_t input_bytes = 0;
  for (const PackedPrimitive& packed : parsed.packed_primitives) {
    auto primitive = look_up(packed, parsed.model, buffers);
    if (!primitive) return primitive.error();
    input_bytes += primitive->bytes.size();
    primitives.push_back(std::move(*primitive));
  }
  ChildLimits limits;
  limits.seconds = given.seconds.value_or(15 + 5 * static_cast<double>(input_bytes) / (1 << 20));
  limits.memory_bytes = given.memory_bytes.value_or(4 * most_bytes);
  limits.result_bytes = most_bytes;
  const ChildReport report = run_in_child([&] { return decode(primitives); }, limits);
  if (report.end != ChildEnd::returned) return error_of(report);
  ByteReader in(report.bytes);
  for (std::size_t p = 0; p < primitives.size(); ++p) {
    const Status status =
        take(parsed.packed_primitives[p], primitives[p], in, parsed.model, buffers);
    if (!status) return status;
  }
  const auto* first = reinterpret_cast<const unsigned char*>(report.bytes.data());
  buffers.decoded.emplace_back(first, first + report.bytes.size());
  buffers.views.push_back(std::as_bytes(std::span(buffers.decoded.back())));
  return {};
}

}  // namespace krok::gltf
