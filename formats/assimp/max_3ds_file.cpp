#include "formats/assimp/max_3ds_file_internal.h"

#include <algorithm>
#include <cmath>

#include "core/bytes.h"
#include "core/text.h"

namespace krok::assimp {

namespace {

constexpr std::uint16_t kMain = 0x4D4D;
constexpr std::uint16_t kEditor = 0x3D3D;
constexpr std::uint16_t kObject = 0x4000;
constexpr std::uint16_t kCamera = 0x4700;

struct Chunk {
  std::uint16_t id = 0;
  std::span<const std::byte> content;
};

// The next chunk, truncated to the available bytes; `in` is not ok() if there is none.
Chunk take_chunk(ByteReader& in) {
  constexpr std::uint32_t kHeader = 6;
  Chunk chunk;
  chunk.id = in.read<std::uint16_t>();
  const auto size = in.read<std::uint32_t>();
  if (!in.ok() || size < kHeader) {
    in.seek(in.position() + in.remaining() + 1);
    return {};
  }
  chunk.content = in.take(std::min<std::size_t>(size - kHeader, in.remaining()));
  return chunk;
}

template <typename Use>
void for_each_chunk(std::span<const std::byte> bytes, std::uint16_t id, Use use) {
  ByteReader in(bytes);
  while (in.remaining() > 0) {
    const Chunk chunk = take_chunk(in);
    if (!in.ok()) return;
    if (chunk.id == id) use(chunk.content);
  }
}

Vec3 take_vector(ByteReader& in) {
  Vec3 vector;
  for (int k = 0; k < 3; ++k) vector[k] = static_cast<double>(in.read<float>());
  return vector;
}

}  // namespace

std::map<std::string, Max3dsCamera> read_3ds_cameras(std::span<const std::byte> bytes) {
  std::map<std::string, Max3dsCamera> cameras;
  const auto read_camera = [&](const std::string& name, std::span<const std::byte> content) {
    ByteReader in(content);
    Max3dsCamera camera;
    camera.position = take_vector(in);
    camera.target = take_vector(in);
    camera.roll = static_cast<double>(in.read<float>()) * kRadiansPerDegree;
    camera.lens = static_cast<double>(in.read<float>());
    const bool finite = camera.position.allFinite() && camera.target.allFinite() &&
                        std::isfinite(camera.roll) && std::isfinite(camera.lens);
    if (in.ok() && finite && camera.lens > 0) cameras.emplace(name, camera);
  };
  const auto read_object = [&](std::span<const std::byte> content) {
    const auto end = std::find(content.begin(), content.end(), std::byte{0});
    if (end == content.end()) return;
    const auto size = static_cast<std::size_t>(end - content.begin());
    const std::string name = to_utf8({reinterpret_cast<const char*>(content.data()), size});
    for_each_chunk(content.subspan(size + 1), kCamera,
                   [&](std::span<const std::byte> camera) { read_camera(name, camera); });
  };
  for_each_chunk(bytes, kMain, [&](std::span<const std::byte> main) {
    for_each_chunk(main, kEditor, [&](std::span<const std::byte> editor) {
      for_each_chunk(editor, kObject, read_object);
    });
  });
  return cameras;
}

}  // namespace krok::assimp
