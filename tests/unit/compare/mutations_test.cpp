// If these fail, krok-diff passes a file in which something was broken, or stops a file in which
// nothing was: each of some hundred single changes of a character is made and must be told, in both
// directions and with each way of matching, and each of some changes that show nothing must not.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <numeric>

#include "compare/scene_difference.h"
#include "formats/gltf/gltf_reader.h"
#include "formats/image/decode_image.h"
#include "nodes/scene_of.h"
#include "support/glb_builder.h"
#include "support/small_images.h"

namespace krok::compare {
namespace {

using Json = nlohmann::ordered_json;
using test::GlbBuilder;

enum Way : unsigned { kAuto = 1, kOrder = 2, kName = 4, kNearest = 8, kAll = 15 };
constexpr std::array kWays = {std::pair(Matching::automatic, kAuto),
                              std::pair(Matching::order, kOrder), std::pair(Matching::name, kName),
                              std::pair(Matching::nearest, kNearest)};

// Places of accessors in the file below.
enum Accessor {
  kPositions,
  kNormals,
  kTangents,
  kCoordinates,
  kMoreCoordinates,
  kColours,
  kJoints,
  kWeights,
  kIndices,
  kClothIndices,
  kHatPositions,
  kHatNormals,
  kHatIndices,
  kSmile,
  kSmileNormals,
  kFrown,
  kBinds,
  kTimes,
  kUpperTurn,
  kRootWay,
  kLowerTurn,
  kFaceWeights,
  kHatWay,
  kShortTimes
};
enum NodeIndex { kRoot, kUpper, kLower, kBody, kHat, kFace, kCamera, kLamp, kSocket };

constexpr int kSide = 7;

// A body of two materials on three joints, a hat at the last one, and a face with two shapes; a
// clip "walk" of linear keys and a clip "wave" of a spline, weights and steps.
class File : public GlbBuilder {
 public:
  File() {
    add_vertices();
    add_motions();
    json["images"] = {{{"bufferView", add_view(test::png())}, {"mimeType", "image/png"}}};
    json["samplers"] = {{{"wrapS", 10497}}, {{"wrapS", 33071}}};
    json["textures"] = {{{"source", 0}, {"sampler", 0}}, {{"source", 0}, {"sampler", 1}}};
    json["materials"] = {{{"name", "skin"},
                          {"pbrMetallicRoughness",
                           {{"baseColorTexture", {{"index", 0}}},
                            {"metallicFactor", 0.2},
                            {"roughnessFactor", 0.7}}},
                          {"normalTexture", {{"index", 0}, {"scale", 0.5}}},
                          {"occlusionTexture", {{"index", 0}, {"texCoord", 1}, {"strength", 0.5}}}},
                         {{"name", "cloth"},
                          {"alphaMode", "MASK"},
                          {"alphaCutoff", 0.4},
                          {"pbrMetallicRoughness", {{"baseColorFactor", {0.2, 0.4, 0.6, 1}}}},
                          {"emissiveFactor", {0.1, 0, 0}}}};
    json["materials"][1]["extensions"] = {{"KHR_materials_ior", {{"ior", 1.4}}}};
    json["scenes"] = {{{"nodes", {kRoot, kBody, kFace, kCamera, kLamp}}}};
    json["scene"] = 0;
    add_others();
  }

  Json& accessor(int index) { return json["accessors"][static_cast<std::size_t>(index)]; }
  Json& node(int index) { return json["nodes"][static_cast<std::size_t>(index)]; }
  Json& mesh(int index) { return json["meshes"][static_cast<std::size_t>(index)]; }
  Json& primitive(int index) { return mesh(0)["primitives"][static_cast<std::size_t>(index)]; }
  Json& material(int index) { return json["materials"][static_cast<std::size_t>(index)]; }
  Json& channel(int animation, int index) {
    return json["animations"][static_cast<std::size_t>(animation)]["channels"]
               [static_cast<std::size_t>(index)];
  }
  Json& sampler(int animation, int index) {
    return json["animations"][static_cast<std::size_t>(animation)]["samplers"]
               [static_cast<std::size_t>(index)];
  }

  template <typename T = float>
  T* values(int index) {
    const auto view = accessor(index)["bufferView"].get<std::size_t>();
    return reinterpret_cast<T*>(bin.data() +
                                json["bufferViews"][view]["byteOffset"].get<std::size_t>());
  }
  std::uint16_t* triangle(int indices, int number) {
    return values<std::uint16_t>(indices) + 3 * number;
  }

 private:
  // What has no mesh.
  void add_others() {
    json["cameras"] = {{{"type", "perspective"}, {"perspective", {{"yfov", 0.7}, {"znear", 0.1}}}}};
    json["extensions"] = {
        {"KHR_lights_punctual",
         {{"lights", {{{"type", "spot"}, {"intensity", 5}, {"spot", {{"outerConeAngle", 0.5}}}}}}}},
        {"KHR_materials_variants", {{"variants", {{{"name", "red"}}}}}}};
    mesh(1)["primitives"][0]["extensions"] = {
        {"KHR_materials_variants", {{"mappings", {{{"material", 0}, {"variants", {0}}}}}}}};
    json["nodes"].push_back({{"name", "camera"}, {"camera", 0}, {"translation", {0, 1, 4}}});
    json["nodes"].push_back({{"name", "lamp"},
                             {"translation", {0, 3, 0}},
                             {"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}});
    json["nodes"].push_back(
        {{"name", "socket"}, {"translation", {0.1, 0, 0}}, {"extras", {{"kind", "grip"}}}});
    node(kLower)["children"].push_back(kSocket);
    json["animations"][0]["extras"] = {{"velocity", {0, 0, 1.4}}};
  }

  void add_vertices() {
    std::vector<float> positions, normals, tangents, first, second, colours, weights;
    std::vector<float> smile, smile_normals, frown;
    std::vector<std::uint8_t> joints;
    std::vector<std::uint16_t> skin, cloth;
    for (int v = 0; v < kSide * kSide; ++v) {
      const float x = static_cast<float>(v % kSide) / (kSide - 1);
      const float y = static_cast<float>(v / kSide) / (kSide - 1);
      const Vec3f normal = Vec3f(-0.6f * std::cos(3 * x), 0.4f * std::sin(4 * y), 1).normalized();
      const Vec3f tangent = Vec3f(1, 0, 0.6f * std::cos(3 * x)).normalized();
      positions.insert(positions.end(),
                       {x, 2 * y, 0.2f * std::sin(3 * x) + 0.1f * std::cos(4 * y)});
      normals.insert(normals.end(), {normal.x(), normal.y(), normal.z()});
      tangents.insert(tangents.end(), {tangent.x(), tangent.y(), tangent.z(), 1});
      first.insert(first.end(), {x, 1 - y});
      second.insert(second.end(), {0.5f * y, 0.5f * x});
      colours.insert(colours.end(), {x, y, 0.5f, 1});
      joints.insert(joints.end(), {0, 1, 2, 0});
      const float upper = std::max(0.0f, 1 - std::abs(2 * y - 1));
      weights.insert(weights.end(), {y < 0.5f ? 1 - upper : 0, upper, y < 0.5f ? 0 : 1 - upper, 0});
      smile.insert(smile.end(), {0.02f * y, 0.01f * x, 0.05f * x * y});
      smile_normals.insert(smile_normals.end(), {0, 0.02f * x, 0});
      frown.insert(frown.end(), {0, -0.03f * x * x, 0.02f * y});
      if (v % kSide + 1 == kSide || v / kSide + 1 == kSide) continue;
      auto& to = v / kSide < kSide / 2 ? skin : cloth;
      for (const int corner : {v, v + 1, v + kSide, v + kSide, v + 1, v + kSide + 1}) {
        to.push_back(static_cast<std::uint16_t>(corner));
      }
    }
    Json attributes;
    const auto attribute = [&](const char* name, int index) { attributes[name] = index; };
    attribute("POSITION", add(positions, "VEC3"));
    attribute("NORMAL", add(normals, "VEC3"));
    attribute("TANGENT", add(tangents, "VEC4"));
    attribute("TEXCOORD_0", add(first, "VEC2"));
    attribute("TEXCOORD_1", add(second, "VEC2"));
    attribute("COLOR_0", add(colours, "VEC4"));
    attribute("JOINTS_0", add(joints, "VEC4"));
    attribute("WEIGHTS_0", add(weights, "VEC4"));
    const int skin_indices = add(skin, "SCALAR"), cloth_indices = add(cloth, "SCALAR");
    const std::vector<float> hat = {0, 0, 0, 0.4f, 0, 0, 0, 0.3f, 0.1f, 0, 0, 0.5f};
    std::vector<float> hat_normals;
    for (int v = 0; v < 4; ++v) hat_normals.insert(hat_normals.end(), {0, 0.6f, 0.8f});
    const int hat_positions = add(hat, "VEC3");
    const Json hat_attributes = {{"POSITION", hat_positions}, {"NORMAL", add(hat_normals, "VEC3")}};
    const std::vector<std::uint16_t> hat_corners = {0, 1, 2, 0, 3, 1, 0, 2, 3, 1, 3, 2};
    const int hat_indices = add(hat_corners, "SCALAR");
    Json smiling = {{"POSITION", add(smile, "VEC3")}};
    smiling["NORMAL"] = add(smile_normals, "VEC3");
    const Json frowning = {{"POSITION", add(frown, "VEC3")}};
    json["meshes"] = {
        {{"name", "body"},
         {"primitives",
          {{{"attributes", attributes}, {"indices", skin_indices}, {"material", 0}},
           {{"attributes", attributes}, {"indices", cloth_indices}, {"material", 1}}}}},
        {{"name", "hat"},
         {"primitives",
          {{{"attributes", hat_attributes}, {"indices", hat_indices}, {"material", 1}}}}},
        {{"name", "face"},
         {"weights", {0.1, 0.2}},
         {"extras", {{"targetNames", {"smile", "frown"}}}},
         {"primitives",
          {{{"attributes", {{"POSITION", 0}, {"NORMAL", 1}}},
            {"indices", skin_indices},
            {"material", 1},
            {"targets", {smiling, frowning}}}}}}};
    json["nodes"] = {{{"name", "root"}, {"children", {kUpper}}},
                     {{"name", "upper"}, {"translation", {0, 1, 0}}, {"children", {kLower}}},
                     {{"name", "lower"}, {"translation", {0, 0.7, 0}}, {"children", {kHat}}},
                     {{"name", "body"}, {"mesh", 0}, {"skin", 0}},
                     {{"name", "hat"}, {"mesh", 1}, {"translation", {0.1, 0.3, 0}}},
                     {{"name", "face"}, {"mesh", 2}, {"translation", {3, 0, 0}}}};
    std::vector<float> binds;
    for (const float up : {0.0f, 1.0f, 1.7f}) {
      binds.insert(binds.end(), {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, -up, 0, 1});
    }
    json["skins"] = {
        {{"joints", {kRoot, kUpper, kLower}}, {"inverseBindMatrices", add(binds, "MAT4")}}};
  }

  void add_motions() {
    const std::vector<float> times = {0, 0.25f, 0.5f, 0.75f, 1}, two = {0, 0.5f};
    std::vector<float> turns, ways, spline, weights;
    const auto turn = [](std::vector<float>& to, double angle, const Vec3& axis) {
      const Quatf q(Quat(Eigen::AngleAxisd(angle, axis.normalized())).cast<float>());
      to.insert(to.end(), {q.x(), q.y(), q.z(), q.w()});
    };
    for (int k = 0; k < 5; ++k) {
      const auto t = static_cast<float>(k);
      turn(turns, 0.3 * k * (k % 2 == 0 ? 1 : -1), Vec3(0, 0.3, 1));
      ways.insert(ways.end(), {0.1f * t, 0.02f * t * t, 0});
      spline.insert(spline.end(), {0.1f, 0, 0.2f, 0});
      turn(spline, 0.25 * k, Vec3(1, 0.2, 0));
      spline.insert(spline.end(), {0.1f, 0, -0.3f, 0});
      weights.insert(weights.end(), {0.2f * t, 1 - 0.2f * t});
    }
    const int input = add(times, "SCALAR");
    const int upper = add(turns, "VEC4"), root = add(ways, "VEC3"), lower = add(spline, "VEC4");
    const int face = add(weights, "SCALAR");
    const std::vector<float> steps = {0.1f, 0.3f, 0, 0.1f, 0.5f, 0};
    const int hat = add(steps, "VEC3"), short_times = add(two, "SCALAR");
    const auto channel = [](int sampler, int node, const char* path) {
      return Json{{"sampler", sampler}, {"target", {{"node", node}, {"path", path}}}};
    };
    json["animations"] = {
        {{"name", "walk"},
         {"samplers",
          {{{"input", input}, {"output", upper}}, {{"input", input}, {"output", root}}}},
         {"channels", {channel(0, kUpper, "rotation"), channel(1, kRoot, "translation")}}},
        {{"name", "wave"},
         {"samplers",
          {{{"input", input}, {"output", lower}, {"interpolation", "CUBICSPLINE"}},
           {{"input", input}, {"output", face}},
           {{"input", short_times}, {"output", hat}, {"interpolation", "STEP"}}}},
         {"channels",
          {channel(0, kLower, "rotation"), channel(1, kFace, "weights"),
           channel(2, kHat, "translation")}}}};
  }
};

struct Mutation {
  const char* what;
  std::function<void(File&)> make;
  unsigned ways = kAll;  // in which it is told, or for those that show nothing, not
};

std::optional<double> pixels(const EncodedImage& first, const EncodedImage& second) {
  const auto a = image::decode(first.bytes), b = image::decode(second.bytes);
  if (!a || !b || a->rgba.size() != b->rgba.size()) return std::nullopt;
  int most = 0;
  for (std::size_t i = 0; i < a->rgba.size(); ++i) {
    most = std::max(most, std::abs(a->rgba[i] - b->rgba[i]));
  }
  return most / 255.0;
}

Scene scene_of_file(const File& file, const char* what) {
  gltf::ReadOptions reading;
  reading.with_materials = true;
  auto read = gltf::read(file.glb(), reading);
  EXPECT_TRUE(read.ok()) << what << ": " << (read.ok() ? "" : read.error().message);
  if (!read) return {};
  auto scene = nodes::scene_of(std::make_shared<const nodes::Scene>(*std::move(read)));
  EXPECT_TRUE(scene.ok()) << what;
  return scene.ok() ? *std::move(scene) : Scene();
}

// The ways, as bits, in which a change is told; twice, for both directions.
std::array<unsigned, 2> told(const Mutation& change, std::string* texts = nullptr) {
  File file;
  change.make(file);
  const Scene a = scene_of_file(File(), "the file"), b = scene_of_file(file, change.what);
  std::array<unsigned, 2> result{};
  Progress progress;
  for (const auto& [matching, bit] : kWays) {
    for (const std::size_t back : {0, 1}) {
      SceneOptions options;
      options.matching = matching;
      options.materials = true;
      options.images = pixels;
      const auto found = difference(back == 0 ? a : b, back == 0 ? b : a, options, 1, progress);
      EXPECT_TRUE(found.ok()) << change.what;
      if (!found.ok() || found->same()) continue;
      result[back] |= bit;
      if (texts == nullptr) continue;
      *texts += found->structure.empty() ? " (measured)" : " (" + found->structure.front() + ")";
    }
  }
  return result;
}

// A chunk that changes no pixel, with its checksum (ISO/IEC 15948, annex D).
std::vector<std::byte> png_with_text() {
  std::vector<std::byte> chunk;
  for (const char c : std::string_view("tEXtk\0v", 7)) chunk.push_back(static_cast<std::byte>(c));
  std::uint32_t crc = ~0u;
  for (const std::byte byte : chunk) {
    crc ^= static_cast<std::uint32_t>(byte);
    for (int k = 0; k < 8; ++k) crc = (crc & 1u) != 0 ? 0xEDB88320u ^ (crc >> 1) : crc >> 1;
  }
  const auto put = [&](auto place, std::uint32_t value) {
    for (int k = 3; k >= 0; --k) place = chunk.insert(place, std::byte(value >> (8 * (3 - k))));
  };
  put(chunk.begin(), 3);
  for (int k = 3; k >= 0; --k) chunk.push_back(std::byte(~crc >> (8 * k)));
  std::vector<std::byte> png = test::png();
  png.insert(png.end() - 12, chunk.begin(), chunk.end());  // before IEND
  return png;
}

// The body's vertices in another order or number: `old_of_new` has their former places.
void renumber(File& file, const std::vector<std::uint16_t>& old_of_new,
              const std::function<std::uint16_t(int corner, std::uint16_t old)>& place) {
  constexpr std::array kSizes = {12, 12, 16, 8, 8, 16, 4, 16};
  for (int a = kPositions; a <= kWeights; ++a) {
    const auto* from = file.values<std::byte>(a);
    const auto size = static_cast<std::size_t>(kSizes[static_cast<std::size_t>(a)]);
    std::vector<std::byte> bytes;
    for (const std::uint16_t old : old_of_new) {
      bytes.insert(bytes.end(), from + old * size, from + (old + 1u) * size);
    }
    const Json before = file.accessor(a);
    const int added =
        file.add_accessor(file.add_view(bytes), before["type"].get<std::string>().c_str(),
                          before["componentType"].get<int>(), old_of_new.size());
    for (const int p : {0, 1}) {
      for (auto& [name, index] : file.primitive(p)["attributes"].items()) {
        if (index == a) index = added;
      }
    }
  }
  int corner = 0;
  for (const int p : {0, 1}) {
    const int indices = p == 0 ? kIndices : kClothIndices;
    const auto count = file.accessor(indices)["count"].get<int>();
    std::vector<std::uint16_t> corners;
    for (int i = 0; i < count; ++i) {
      corners.push_back(place(corner++, file.values<std::uint16_t>(indices)[i]));
    }
    file.primitive(p)["indices"] = file.add(corners, "SCALAR");
  }
}

std::vector<std::uint16_t> counted_to(std::size_t count) {
  std::vector<std::uint16_t> list(count);
  std::iota(list.begin(), list.end(), std::uint16_t{0});
  return list;
}

constexpr int kVertex = 17;  // inside the skin's part of the body

Json& light_of(File& file) {
  return file.json["extensions"]["KHR_lights_punctual"]["lights"][0];
}

// Sets, or with `by` adds to, a number of an accessor.
Mutation number(const char* what, int accessor, int index, float by, unsigned ways = kAll) {
  return {what, [=](File& file) { file.values(accessor)[index] += by; }, ways};
}

Mutation json_change(const char* what, std::function<void(File&)> make, unsigned ways = kAll) {
  return {what, std::move(make), ways};
}

// What must be told. Two things are documented as not compared: names with `order` (and those of
// animations with `nearest`), and morph targets with `nearest`, but for what they do to the shape.
const std::vector<Mutation> kChanges = {
    // Shape.
    number("a vertex is 0.5 mm out of the surface", kPositions, 3 * kVertex + 2, 5e-4f),
    number("a vertex of the rim is 0.5 mm out", kPositions, 0, -5e-4f),
    number("a vertex of the hat is moved", kHatPositions, 11, 1e-3f),
    number("a normal is tilted", kNormals, 3 * kVertex, 0.1f),
    {"a normal points back",
     [](File& file) {
       for (int c = 0; c < 3; ++c) file.values(kNormals)[3 * kVertex + c] *= -1;
     }},
    {"a tangent is turned", [](File& file) { file.values(kTangents)[4 * kVertex + 1] += 0.2f; }},
    {"a tangent's handedness is flipped",
     [](File& file) { file.values(kTangents)[4 * kVertex + 3] = -1; }},
    number("a texture coordinate is off", kCoordinates, 2 * kVertex, 0.01f),
    number("a used coordinate of the second set is off", kMoreCoordinates, 2 * kVertex, 0.01f),
    number("a colour is another", kColours, 4 * kVertex, 0.1f),
    json_change(
        "the body has no normals",
        [](File& file) {
          for (int p : {0, 1}) file.primitive(p)["attributes"].erase("NORMAL");
        },
        kAll),
    json_change("the body has no texture coordinates",
                [](File& file) {
                  for (int p : {0, 1}) {
                    file.primitive(p)["attributes"].erase("TEXCOORD_0");
                    file.primitive(p)["attributes"].erase("TEXCOORD_1");
                  }
                }),
    json_change("the body has no second texture coordinates",
                [](File& file) {
                  for (int p : {0, 1}) file.primitive(p)["attributes"].erase("TEXCOORD_1");
                }),
    json_change("the body has no tangents",
                [](File& file) {
                  for (int p : {0, 1}) file.primitive(p)["attributes"].erase("TANGENT");
                }),
    json_change("the body has no colours",
                [](File& file) {
                  for (int p : {0, 1}) file.primitive(p)["attributes"].erase("COLOR_0");
                }),
    json_change("a triangle is dropped",
                [](File& file) { file.accessor(kClothIndices)["count"] = 3 * 35; }),
    {"a triangle inside is dropped",
     [](File& file) {
       std::uint16_t* const t = file.triangle(kIndices, 9);
       t[1] = t[2] = t[0];
     }},
    {"a triangle is wound the other way",
     [](File& file) {
       std::uint16_t* const t = file.triangle(kIndices, 9);
       std::swap(t[1], t[2]);
     }},
    {"all triangles of the cloth are wound the other way",
     [](File& file) {
       const int count = file.accessor(kClothIndices)["count"].get<int>() / 3;
       for (int t = 0; t < count; ++t) {
         std::swap(file.triangle(kClothIndices, t)[1], file.triangle(kClothIndices, t)[2]);
       }
     }},
    {"a triangle has another corner",
     [](File& file) { file.triangle(kIndices, 9)[0] = static_cast<std::uint16_t>(kVertex + 8); }},
    {"most triangles of the hat are gone",
     [](File& file) { file.accessor(kHatIndices)["count"] = 3; }},
    {"a triangle is there that was not",
     [](File& file) {
       std::vector<std::uint16_t> corners(file.triangle(kHatIndices, 0),
                                          file.triangle(kHatIndices, 4));
       const std::vector<std::uint16_t> more = {0, 6, 48};
       std::vector<std::uint16_t> all(
           file.triangle(kClothIndices, 0),
           file.triangle(kClothIndices, 0) + file.accessor(kClothIndices)["count"].get<int>());
       all.insert(all.end(), more.begin(), more.end());
       file.primitive(1)["indices"] = file.add(all, "SCALAR");
     }},
    // Binding.
    {"a vertex hangs on another joint",
     [](File& file) {
       auto* const joints = file.values<std::uint8_t>(kJoints) + 4 * kVertex;
       std::swap(joints[0], joints[2]);
     }},
    {"weights of a vertex are shifted",
     [](File& file) {
       float* const weights = file.values(kWeights) + 4 * kVertex;
       weights[0] += 0.05f;
       weights[1] -= 0.05f;
     }},
    number("a bind matrix is off", kBinds, 16 + 13, 0.01f),
    json_change("the skin has its joints swapped",
                [](File& file) {
                  file.json["skins"][0]["joints"] = {kRoot, kLower, kUpper};
                }),
    json_change("the face is 1 mm higher",
                [](File& file) {
                  file.node(kFace)["translation"] = {3, 0.001, 0};
                }),
    // Scene.
    json_change(
        "a joint is renamed", [](File& file) { file.node(kUpper)["name"] = "over"; },
        kAuto | kName | kNearest),
    json_change("a joint rests elsewhere",
                [](File& file) {
                  file.node(kLower)["translation"] = {0, 0.71, 0};
                }),
    json_change("a joint is turned at rest alone",
                [](File& file) {
                  file.node(kUpper)["rotation"] = {0, 0, 0.3826834, 0.9238795};
                }),
    json_change("a joint has another parent",
                [](File& file) {
                  file.node(kRoot)["children"] = {kUpper, kLower};
                  file.node(kUpper).erase("children");
                }),
    json_change("the character is scaled",
                [](File& file) {
                  file.node(kRoot)["scale"] = {1.01, 1.01, 1.01};
                }),
    json_change("the hat is scaled",
                [](File& file) {
                  file.node(kHat)["scale"] = {1, 1.02, 1};
                }),
    json_change("the hat is mirrored",
                [](File& file) {
                  file.node(kHat)["scale"] = {-1, 1, 1};
                }),
    json_change("the hat is gone", [](File& file) { file.node(kHat).erase("mesh"); }),
    json_change("the face is not in the scene",
                [](File& file) {
                  file.json["scenes"][0]["nodes"] = {kRoot, kBody};
                }),
    json_change("the hat is there twice",
                [](File& file) {
                  file.json["nodes"].push_back({{"name", "hat2"}, {"mesh", 1}});
                  file.json["scenes"][0]["nodes"].push_back(kSocket + 1);
                }),
    json_change("the face is hidden",
                [](File& file) {
                  file.json["extensionsUsed"] = nlohmann::json::array({"KHR_node_visibility"});
                  file.node(kFace)["extensions"] = {{"KHR_node_visibility", {{"visible", false}}}};
                }),
    json_change("the hat has the mesh of the body",
                [](File& file) { file.node(kHat)["mesh"] = 0; }),
    // Looks.
    json_change("base colour",
                [](File& file) {
                  file.material(1)["pbrMetallicRoughness"]["baseColorFactor"] = {0.2, 0.4, 0.61, 1};
                }),
    json_change(
        "metallic",
        [](File& file) { file.material(0)["pbrMetallicRoughness"]["metallicFactor"] = 0.3; }),
    json_change(
        "roughness",
        [](File& file) { file.material(0)["pbrMetallicRoughness"]["roughnessFactor"] = 0.6; }),
    json_change("emissive",
                [](File& file) {
                  file.material(1)["emissiveFactor"] = {0.1, 0, 0.1};
                }),
    json_change("alpha mode", [](File& file) { file.material(1)["alphaMode"] = "BLEND"; }),
    json_change("alpha cutoff", [](File& file) { file.material(1)["alphaCutoff"] = 0.5; }),
    json_change("double sided", [](File& file) { file.material(0)["doubleSided"] = true; }),
    json_change(
        "a texture is gone",
        [](File& file) { file.material(0)["pbrMetallicRoughness"].erase("baseColorTexture"); }),
    json_change("normal texture is gone",
                [](File& file) { file.material(0).erase("normalTexture"); }),
    json_change("normal scale",
                [](File& file) { file.material(0)["normalTexture"]["scale"] = 0.6; }),
    json_change("occlusion strength",
                [](File& file) { file.material(0)["occlusionTexture"]["strength"] = 1; }),
    json_change("a texture uses other coordinates",
                [](File& file) { file.material(0)["occlusionTexture"]["texCoord"] = 0; }),
    json_change("a texture has another sampler",
                [](File& file) { file.material(0)["normalTexture"]["index"] = 1; }),
    json_change("another picture",
                [](File& file) {
                  file.json["images"].push_back(
                      {{"bufferView", file.add_view(test::jpeg())}, {"mimeType", "image/jpeg"}});
                  file.json["textures"][0]["source"] = 1;
                }),
    json_change("a texture is shifted",
                [](File& file) {
                  file.json["extensionsUsed"] = nlohmann::json::array({"KHR_texture_transform"});
                  file.material(0)["pbrMetallicRoughness"]["baseColorTexture"]["extensions"] = {
                      {"KHR_texture_transform", {{"offset", {0.1, 0}}}}};
                }),
    json_change("unlit",
                [](File& file) {
                  file.json["extensionsUsed"] = nlohmann::json::array({"KHR_materials_unlit"});
                  file.material(0)["extensions"] = {{"KHR_materials_unlit", Json::object()}};
                }),
    json_change("a coat",
                [](File& file) {
                  file.json["extensionsUsed"] = nlohmann::json::array({"KHR_materials_clearcoat"});
                  file.material(0)["extensions"] = {
                      {"KHR_materials_clearcoat", {{"clearcoatFactor", 0.5}}}};
                }),
    json_change(
        "a material is renamed", [](File& file) { file.material(0)["name"] = "hide"; },
        kAll & ~kOrder),
    json_change("a part has another material",
                [](File& file) { file.primitive(1)["material"] = 0; }),
    json_change("a part has no material", [](File& file) { file.primitive(1).erase("material"); }),
    json_change("materials are swapped",
                [](File& file) { std::swap(file.material(0), file.material(1)); }),
    // Motion.
    number("a key turns by another angle", kUpperTurn, 4 * 2 + 1, 0.01f),
    number("a key is elsewhere", kRootWay, 3 * 3 + 1, 0.002f),
    number("the last key is elsewhere", kRootWay, 3 * 4, 0.002f),
    number("the first key is elsewhere", kRootWay, 0, 0.002f),
    number("a spline's tangent is another", kLowerTurn, 12 * 1 + 8, 0.2f),
    number("a spline's key is another", kLowerTurn, 12 * 2 + 4, 0.02f),
    number("a weight is another", kFaceWeights, 2 * 2, 0.05f),
    number("a step goes elsewhere", kHatWay, 3 + 1, 0.01f),
    number("a key is later", kTimes, 2, 0.02f),
    number("a step is earlier", kShortTimes, 1, -0.1f),
    {"the motion is slower",
     [](File& file) {
       for (int k = 0; k < 5; ++k) file.values(kTimes)[k] *= 1.1f;
     }},
    {"the motion begins later",
     [](File& file) {
       for (int k = 0; k < 5; ++k) file.values(kTimes)[k] += 0.1f;
     }},
    json_change("the last keys are gone",
                [](File& file) {
                  for (const int a : {kTimes, kUpperTurn, kRootWay, kFaceWeights, kLowerTurn}) {
                    const int each = a == kLowerTurn ? 3 : a == kFaceWeights ? 2 : 1;
                    file.accessor(a)["count"] = 4 * each;
                  }
                }),
    json_change("linear keys step",
                [](File& file) { file.sampler(0, 1)["interpolation"] = "STEP"; }),
    json_change("steps are linear",
                [](File& file) { file.sampler(1, 2)["interpolation"] = "LINEAR"; }),
    json_change("a channel is gone",
                [](File& file) { file.json["animations"][0]["channels"].erase(0); }),
    json_change("the weights' channel is gone",
                [](File& file) { file.json["animations"][1]["channels"].erase(1); }),
    json_change("a channel turns another joint",
                [](File& file) { file.channel(0, 0)["target"]["node"] = kLower; }),
    json_change("a clip is gone", [](File& file) { file.json["animations"].erase(1); }),
    json_change("a clip is there twice",
                [](File& file) { file.json["animations"].push_back(file.json["animations"][0]); }),
    json_change(
        "a clip is renamed", [](File& file) { file.json["animations"][0]["name"] = "run"; },
        kAuto | kName),
    json_change(
        "clips have changed names",
        [](File& file) {
          std::swap(file.json["animations"][0]["name"], file.json["animations"][1]["name"]);
        },
        kAll & ~kOrder),
    json_change("no clips", [](File& file) { file.json.erase("animations"); }),
    // Morph targets.
    number("a target is another", kSmile, 3 * kVertex + 2, 0.02f),
    number("a target's normal is another", kSmileNormals, 3 * kVertex, 0.3f),
    number("a target that is little used is another", kFrown, 3 * kVertex + 2, 0.02f),
    json_change(
        "a target is renamed",
        [](File& file) { file.mesh(2)["extras"]["targetNames"] = {"grin", "frown"}; }, kName),
    json_change(
        "targets have changed names",
        [](File& file) { file.mesh(2)["extras"]["targetNames"] = {"frown", "smile"}; },
        kAuto | kName),
    json_change("targets are swapped",
                [](File& file) {
                  Json& targets = file.mesh(2)["primitives"][0]["targets"];
                  std::swap(targets[0], targets[1]);
                }),
    json_change("another weight at rest",
                [](File& file) {
                  file.mesh(2)["weights"] = {0.15, 0.2};
                }),
    // Nodes without a mesh, and what they carry.
    json_change("a camera is moved", [](File& file) { file.node(kCamera)["translation"][2] = 5; }),
    json_change("a camera is turned",
                [](File& file) {
                  file.node(kCamera)["rotation"] = {0, 0.6, 0, 0.8};
                }),
    json_change("a camera sees more",
                [](File& file) { file.json["cameras"][0]["perspective"]["yfov"] = 0.8; }),
    json_change("a camera is gone", [](File& file) { file.node(kCamera).erase("camera"); }),
    json_change("a light is brighter", [](File& file) { light_of(file)["intensity"] = 6; }),
    json_change("a light's cone is wider",
                [](File& file) { light_of(file)["spot"]["outerConeAngle"] = 0.6; }),
    json_change("a light is gone", [](File& file) { file.node(kLamp).erase("extensions"); }),
    json_change("a socket is moved",
                [](File& file) { file.node(kSocket)["translation"][0] = 0.2; }),
    json_change("a socket is scaled",
                [](File& file) {
                  file.node(kSocket)["scale"] = {2, 2, 2};
                }),
    json_change(
        "a socket is gone", [](File& file) { file.node(kLower)["children"] = {kHat}; },
        kAuto | kName),
    json_change("extras of a node are others",
                [](File& file) { file.node(kSocket)["extras"]["kind"] = "hook"; }),
    json_change("a clip's velocity is another",
                [](File& file) { file.json["animations"][0]["extras"]["velocity"][2] = 1.5; }),
    json_change("a clip's velocity is gone",
                [](File& file) { file.json["animations"][0].erase("extras"); }),
    json_change("a variant has another material",
                [](File& file) {
                  file.mesh(1)["primitives"][0]["extensions"]["KHR_materials_variants"]["mappings"]
                              [0]["material"] = 1;
                }),
    json_change(
        "a refraction index is another",
        [](File& file) { file.material(1)["extensions"]["KHR_materials_ior"]["ior"] = 1.6; }),
    json_change("extras of a material are there",
                [](File& file) {
                  file.material(1)["extras"] = {{"surface", "wet"}};
                }),
};

// What shows nothing.
const std::vector<Mutation> kRewritings = {
    {"nothing", [](File&) {}},
    {"other extras and names of accessors",
     [](File& file) {
       file.json["asset"]["generator"] = "another";
       file.json["extras"] = {{"a", 1}};
       file.accessor(3)["name"] = "uv";
     }},
    {"triangles in another order, from another corner",
     [](File& file) {
       std::uint16_t* const t = file.triangle(kIndices, 0);
       std::rotate(t, t + 1, t + 3);
       std::swap_ranges(t, t + 3, file.triangle(kIndices, 5));
     }},
    {"indices of 32 bits",
     [](File& file) {
       const auto* from = file.values<std::uint16_t>(kIndices);
       const std::vector<std::uint32_t> wide(from,
                                             from + file.accessor(kIndices)["count"].get<int>());
       file.primitive(0)["indices"] = file.add(wide, "SCALAR");
     }},
    {"quaternions of the other sign",
     [](File& file) {
       for (int c = 0; c < 4; ++c) file.values(kUpperTurn)[4 * 2 + c] *= -1;
     }},
    {"influences of a vertex in another order",
     [](File& file) {
       std::swap(file.values(kWeights)[4 * kVertex], file.values(kWeights)[4 * kVertex + 1]);
       std::swap(file.values<std::uint8_t>(kJoints)[4 * kVertex],
                 file.values<std::uint8_t>(kJoints)[4 * kVertex + 1]);
     }},
    {"joints without weight are others",
     [](File& file) { file.values<std::uint8_t>(kJoints)[4 * kVertex + 3] = 2; }},
    {"materials in another order",
     [](File& file) {
       std::swap(file.material(0), file.material(1));
       for (Json& mesh : file.json["meshes"]) {
         for (Json& primitive : mesh["primitives"]) {
           primitive["material"] = 1 - primitive["material"].get<int>();
         }
       }
       file.mesh(
           1)["primitives"][0]["extensions"]["KHR_materials_variants"]["mappings"][0]["material"] =
           1;
     }},
    {"a node as a matrix",
     [](File& file) {
       file.node(kFace).erase("translation");
       file.node(kFace)["matrix"] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 3, 0, 0, 1};
     }},
    {"a key more on a straight way",
     [](File& file) {
       const float* const times = file.values(kTimes);
       const float* const ways = file.values(kRootWay);
       std::vector<float> more(times, times + 5), places(ways, ways + 15);
       more.insert(more.begin() + 1, 0.125f);
       places.insert(places.begin() + 3, {0.05f, 0.01f, 0});
       file.sampler(0, 1)["input"] = file.add(more, "SCALAR");
       file.sampler(0, 1)["output"] = file.add(places, "VEC3");
     }},
    {"the same picture in other bytes",
     [](File& file) { file.json["images"][0]["bufferView"] = file.add_view(png_with_text()); }},
    {"a sparse target",
     [](File& file) {
       const float* const values = file.values(kSmile);
       const std::vector<float> all(values, values + 3 * kSide * kSide);
       const int view = file.add_view(std::as_bytes(std::span(all)));
       const auto places = counted_to(kSide * kSide);
       const int indices = file.add_view(std::as_bytes(std::span(places)));
       file.accessor(kSmile).erase("bufferView");
       file.accessor(kSmile)["sparse"] = {
           {"count", kSide * kSide},
           {"indices", {{"bufferView", indices}, {"componentType", 5123}}},
           {"values", {{"bufferView", view}}}};
     }},
    {"a node more",
     [](File& file) {
       file.json["nodes"].push_back({{"name", "light"}});
       file.json["scenes"][0]["nodes"].push_back(kSocket + 1);
     },
     kOrder | kNearest},
    {"whole numbers with a fraction",
     [](File& file) {
       file.accessor(kIndices)["count"] = file.accessor(kIndices)["count"].get<double>();
       file.json["buffers"] = {{{"byteLength", static_cast<double>(file.bin.size())}}};
     }},
    {"meshes in another order",
     [](File& file) {
       file.json["scenes"][0]["nodes"] = {kFace, kBody, kRoot, kCamera, kLamp};
     },
     kAll & ~kOrder},
    {"vertices in another order",
     [](File& file) {
       std::vector<std::uint16_t> order = counted_to(kSide * kSide);
       std::ranges::reverse(order);
       renumber(file, order, [](int, std::uint16_t old) {
         return static_cast<std::uint16_t>(kSide * kSide - 1 - old);
       });
     },
     kNearest},
    {"vertices that nothing uses",
     [](File& file) {
       std::vector<std::uint16_t> order = counted_to(kSide * kSide);
       order.push_back(kVertex);
       renumber(file, order, [](int, std::uint16_t old) { return old; });
     },
     kNearest},
    {"each triangle with vertices of its own",
     [](File& file) {
       std::vector<std::uint16_t> order;
       for (const int indices : {kIndices, kClothIndices}) {
         const auto* from = file.values<std::uint16_t>(indices);
         order.insert(order.end(), from, from + file.accessor(indices)["count"].get<int>());
       }
       renumber(file, order,
                [](int corner, std::uint16_t) { return static_cast<std::uint16_t>(corner); });
     },
     kNearest},
};

std::string words_of(unsigned ways) {
  std::string words;
  for (const auto& [matching, bit] : kWays) {
    if ((ways & bit) == 0) continue;
    words += bit == kAuto    ? " auto"
             : bit == kOrder ? " order"
             : bit == kName  ? " name"
                             : " nearest";
  }
  return words;
}

TEST(Mutations, EachIsToldInEachWayAndBothDirections) {
  EXPECT_GE(kChanges.size(), 100u);
  int missed = 0;
  for (const Mutation& change : kChanges) {
    for (const unsigned ways : told(change)) {
      if ((change.ways & ~ways) == 0) continue;
      ++missed;
      ADD_FAILURE() << change.what << ": missed with" << words_of(change.ways & ~ways);
    }
  }
  RecordProperty("missed", missed);
}

TEST(Mutations, NoneIsToldWhereNothingShows) {
  for (const Mutation& change : kRewritings) {
    std::string texts;
    for (const unsigned ways : told(change, &texts)) {
      EXPECT_EQ(change.ways & ways, 0u)
          << change.what << ": told with" << words_of(change.ways & ways) << texts;
    }
  }
}

}  // namespace
}  // namespace krok::compare
