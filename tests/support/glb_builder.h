#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <vector>

#include "core/bytes.h"

// Small glTF files assembled by hand from JSON and bytes, so that reader tests do not depend on the
// writer.

namespace krok::test {

struct GlbBuilder {
  nlohmann::ordered_json json = {{"asset", {{"version", "2.0"}}}};
  std::vector<std::byte> bin;

  // Adds a buffer view of these bytes, aligned to 4; returns its index.
  int add_view(std::span<const std::byte> bytes, int stride = 0) {
    while (bin.size() % 4 != 0) bin.push_back(std::byte{0});
    nlohmann::ordered_json view = {
        {"buffer", 0}, {"byteOffset", bin.size()}, {"byteLength", bytes.size()}};
    if (stride != 0) view["byteStride"] = stride;
    bin.insert(bin.end(), bytes.begin(), bytes.end());
    json["bufferViews"].push_back(view);
    return static_cast<int>(json["bufferViews"].size()) - 1;
  }

  int add_accessor(int view, const char* type, int component_type, std::size_t count,
                   bool normalized = false) {
    nlohmann::ordered_json accessor = {
        {"bufferView", view}, {"componentType", component_type}, {"count", count}, {"type", type}};
    if (normalized) accessor["normalized"] = true;
    json["accessors"].push_back(accessor);
    return static_cast<int>(json["accessors"].size()) - 1;
  }

  template <typename T>
  int add(const std::vector<T>& values, const char* type, bool normalized = false) {
    const int view = add_view(std::as_bytes(std::span(values)));
    const std::string name = type;
    const std::size_t components = name == "SCALAR" ? 1 : name == "MAT4" ? 16 : name[3] - '0';
    return add_accessor(view, type, component_type<T>(), values.size() / components, normalized);
  }

  template <typename T>
  static int component_type() {
    if (std::is_same_v<T, std::int8_t>) return 5120;
    if (std::is_same_v<T, std::uint8_t>) return 5121;
    if (std::is_same_v<T, std::int16_t>) return 5122;
    if (std::is_same_v<T, std::uint16_t>) return 5123;
    if (std::is_same_v<T, std::uint32_t>) return 5125;
    return 5126;
  }

  std::vector<std::byte> glb() const {
    nlohmann::ordered_json whole = json;
    if (!bin.empty() && !whole.contains("buffers")) {
      whole["buffers"] = {{{"byteLength", bin.size()}}};
    }
    std::string text = whole.dump();
    while (text.size() % 4 != 0) text += ' ';
    const std::size_t bin_size = (bin.size() + 3) / 4 * 4;
    ByteWriter out;
    out.append_text("glTF");
    out.write(std::uint32_t{2});
    const std::size_t chunks = 8 + text.size() + (bin.empty() ? 0 : 8 + bin_size);
    out.write(static_cast<std::uint32_t>(12 + chunks));
    out.write(static_cast<std::uint32_t>(text.size()));
    out.append_text("JSON");
    out.append_text(text);
    if (!bin.empty()) {
      out.write(static_cast<std::uint32_t>(bin_size));
      out.append_text(std::string_view("BIN\0", 4));
      out.append(bin);
      out.align(4);
    }
    return out.buffer();
  }
};

// A square of two triangles in the plane z = 0, corners (0,0), (1,0), (1,1), (0,1).
inline std::vector<float> square_positions() {
  return {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0};
}
inline std::vector<float> square_normals() {
  return {0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1};
}

// A mesh "Square" at a node "Body": no skin, no animation.
inline GlbBuilder square() {
  GlbBuilder builder;
  const int positions = builder.add(square_positions(), "VEC3");
  const int normals = builder.add(square_normals(), "VEC3");
  const int indices = builder.add(std::vector<std::uint16_t>{0, 1, 2, 0, 2, 3}, "SCALAR");
  builder.json["meshes"] = {
      {{"name", "Square"},
       {"primitives",
        {{{"attributes", {{"POSITION", positions}, {"NORMAL", normals}}}, {"indices", indices}}}}}};
  builder.json["nodes"] = {{{"name", "Body"}, {"mesh", 0}}};
  builder.json["scenes"] = {{{"nodes", {0}}}};
  builder.json["scene"] = 0;
  return builder;
}

// The square skinned to two joints, Root at the origin and Tip one metre above it: its lower
// corners to Root, its upper ones to Tip. "Bend" turns Tip by a quarter about Z in one second, with
// keys at 0, 0.5 and 1 s.
inline GlbBuilder rig() {
  GlbBuilder builder = square();
  auto& attributes = builder.json["meshes"][0]["primitives"][0]["attributes"];
  attributes["JOINTS_0"] = builder.add(
      std::vector<std::uint8_t>{0, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0}, "VEC4");
  attributes["WEIGHTS_0"] =
      builder.add(std::vector<float>{1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0}, "VEC4");
  std::vector<float> binds(32, 0.0f);
  for (const std::size_t i : {0, 5, 10, 15}) binds[i] = binds[16 + i] = 1.0f;
  binds[16 + 13] = -1.0f;  // Tip's is a translation by -1 along Y
  builder.json["skins"] = {
      {{"joints", {1, 2}}, {"inverseBindMatrices", builder.add(binds, "MAT4")}}};
  builder.json["nodes"][0]["skin"] = 0;
  builder.json["nodes"].push_back({{"name", "Root"}, {"children", {2}}});
  builder.json["nodes"].push_back({{"name", "Tip"}, {"translation", {0, 1, 0}}});
  builder.json["scenes"][0]["nodes"] = {0, 1};
  const float eighth = 0.38268343f, eighth_cosine = 0.92387953f, quarter = 0.70710678f;
  const int times = builder.add(std::vector<float>{0, 0.5f, 1}, "SCALAR");
  const int turns = builder.add(
      std::vector<float>{0, 0, 0, 1, 0, 0, eighth, eighth_cosine, 0, 0, quarter, quarter}, "VEC4");
  builder.json["animations"] = {
      {{"name", "Bend"},
       {"samplers", {{{"input", times}, {"output", turns}}}},
       {"channels", {{{"sampler", 0}, {"target", {{"node", 2}, {"path", "rotation"}}}}}}}};
  return builder;
}

// The rig baked at its three keys: two morph targets, keyed so that each key shows one state.
inline GlbBuilder baked_rig() {
  GlbBuilder builder = square();
  const double root = 0.70710678118654752;
  const auto state = [](double x2, double y2) {
    // Displacements of the corner at (1, 1), one metre beside Tip; the others do not move.
    return std::vector<float>{
        0, 0, 0, 0, 0, 0, static_cast<float>(x2 - 1), static_cast<float>(y2 - 1), 0, 0, 0, 0};
  };
  nlohmann::ordered_json targets = nlohmann::ordered_json::array();
  targets.push_back({{"POSITION", builder.add(state(root, 1 + root), "VEC3")}});
  targets.push_back({{"POSITION", builder.add(state(0, 2), "VEC3")}});
  builder.json["meshes"][0]["primitives"][0]["targets"] = targets;
  builder.json["meshes"][0]["extras"] = {{"targetNames", {"half", "full"}}};
  const int times = builder.add(std::vector<float>{0, 0.5f, 1}, "SCALAR");
  const int weights = builder.add(std::vector<float>{0, 0, 1, 0, 0, 1}, "SCALAR");
  builder.json["animations"] = {
      {{"name", "Baked"},
       {"samplers", {{{"input", times}, {"output", weights}}}},
       {"channels", {{{"sampler", 0}, {"target", {{"node", 0}, {"path", "weights"}}}}}}}};
  return builder;
}

}  // namespace krok::test
