// Would fail if morph targets beside a skeleton moved vertices elsewhere than the set has them,
// lost their names, or were animated apart from the joints.

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <random>

#include "formats/gltf/gltf_reader.h"
#include "formats/gltf/gltf_writer.h"
#include "formats/gltf/reduce_for_mesh.h"
#include "support/test_scenes.h"
#include "unit/gltf/glb.h"

namespace krok {
namespace {

struct Face {
  Model model = test::tube_model(test::human_skeleton());
  MorphSet morphs;
  MorphWeights weights;
  gltf::WriteOptions options;

  explicit Face(int frames) {
    morphs.names = {"smile", "\xc5\x99\xc3\xadha"};
    morphs.vertex_count = model.vertex_count();
    for (int t = 0; t < 2; ++t) {
      for (int v = 0; v < model.vertex_count(); ++v) {
        const auto at = static_cast<std::size_t>(v);
        morphs.positions.push_back(model.positions[at] +
                                   Vec3f(0, 0.01f * static_cast<float>(t + v % 5), 0));
        morphs.normals.push_back(Vec3f(static_cast<float>(t), 1, 0).normalized());
      }
    }
    weights = {24, morphs.names, {}};
    for (int f = 0; f < frames; ++f) {
      weights.values.push_back(0.25f * static_cast<float>(f * (4 - f)));  // no straight line
      weights.values.push_back(-0.5f);
    }
    options.morphs = &morphs;
    options.weights = &weights;
  }

  test::Glb rig() const {
    const Clip clip = test::swinging_clip(model.skeleton, 5, 30);
    return test::written(
        [&](OutputFile& file) { return gltf::write_rig(model, clip, options, file); });
  }
  test::Glb mesh() const {
    return test::written([&](OutputFile& file) {
      return gltf::write_mesh(model, {model.positions, model.normals, {}}, options, file);
    });
  }
  std::string mesh_error() const {
    Status status;
    test::bytes_of(
        [&](OutputFile& file) {
          return gltf::write_mesh(model, {model.positions, model.normals, {}}, options, file);
        },
        status);
    return status ? "none" : status.error().code;
  }
};

TEST(GltfMorphTargets, AreDisplacementsWithNames) {
  const Face face(3);
  for (const test::Glb& glb : {face.rig(), face.mesh()}) {
    const auto& mesh = glb.json["meshes"][0];
    EXPECT_EQ(mesh["extras"]["targetNames"], nlohmann::json(face.morphs.names));
    for (const auto& primitive : mesh["primitives"]) {
      ASSERT_EQ(primitive["targets"].size(), 2u);
      for (std::size_t t = 0; t < 2; ++t) {
        const auto moved = glb.values<float>(primitive["targets"][t]["POSITION"]);
        const auto turned = glb.values<float>(primitive["targets"][t]["NORMAL"]);
        ASSERT_EQ(moved.size(), 3 * face.model.positions.size());
        for (std::size_t v = 0; v < face.model.positions.size(); ++v) {
          const auto target = face.morphs.target_positions(static_cast<int>(t))[v];
          const auto normal = face.morphs.target_normals(static_cast<int>(t))[v];
          for (int axis = 0; axis < 3; ++axis) {
            const std::size_t at = 3 * v + static_cast<std::size_t>(axis);
            EXPECT_EQ(moved[at], target[axis] - face.model.positions[v][axis]);
            EXPECT_EQ(turned[at], normal[axis] - face.model.normals[v][axis]);
          }
        }
        EXPECT_TRUE(
            glb.json["accessors"][primitive["targets"][t]["POSITION"].get<int>()].contains("min"));
      }
    }
  }
}

TEST(GltfMorphTargets, WeightsAreInTheAnimationOfTheJoints) {
  const Face face(3);
  const test::Glb glb = face.rig();
  ASSERT_EQ(glb.json["animations"].size(), 1u);
  const auto& animation = glb.json["animations"][0];
  int found = 0;
  for (const auto& channel : animation["channels"]) {
    if (channel["target"]["path"] != "weights") continue;
    ++found;
    EXPECT_TRUE(glb.json["nodes"][channel["target"]["node"].get<int>()].contains("mesh"));
    const auto& sampler = animation["samplers"][channel["sampler"].get<int>()];
    EXPECT_EQ(glb.values<float>(sampler["input"]),
              (std::vector<float>{0, static_cast<float>(1 / 24.0), static_cast<float>(2 / 24.0)}));
    EXPECT_EQ(glb.values<float>(sampler["output"]), face.weights.values);
  }
  EXPECT_EQ(found, 1);
  EXPECT_GT(animation["channels"].size(), 10u);
}

// A face at rest, or one that was keyed at a few frames, would take as many keys as its motion has
// frames.
TEST(GltfMorphTargets, StraightWeightsHaveKeysAtTheirEnds) {
  Face face(5);
  const std::vector<float> smile = {0.25f, 0.5f, 0.75f, 0.75f, 0.75f};
  for (std::size_t f = 0; f < smile.size(); ++f) face.weights.values[2 * f] = smile[f];
  const test::Glb glb = face.rig();
  for (const auto& channel : glb.json["animations"][0]["channels"]) {
    if (channel["target"]["path"] != "weights") continue;
    const auto& sampler = glb.json["animations"][0]["samplers"][channel["sampler"].get<int>()];
    EXPECT_EQ(glb.values<float>(sampler["input"]), (std::vector<float>{0, 2 / 24.0f, 4 / 24.0f}));
    EXPECT_EQ(glb.values<float>(sampler["output"]),
              (std::vector<float>{0.25f, -0.5f, 0.75f, -0.5f, 0.75f, -0.5f}));
  }
}

// Weights would be further off than asked, or files hold other keys than were chosen.
TEST(GltfMorphTargets, FewerKeysStayWithinTheirSlack) {
  std::mt19937 random(7);
  std::uniform_real_distribution<float> step(-0.1f, 0.1f);
  for (const int bits : {8, 16, 32}) {
    MorphWeights weights{30, {"smile", "jaw"}, {0.5f, 0.5f}};
    for (int i = 0; i < 400; ++i) {
      const float before = weights.values[weights.values.size() - 2];
      weights.values.push_back(std::clamp(before + step(random), 0.0f, 1.0f));
    }
    const std::vector<float> slack = {0.05f, 0.2f};
    const MorphWeights kept = gltf::on_keys(weights, slack, bits);
    const auto keys = gltf::weight_keys(weights, slack);
    EXPECT_LT(keys.size(), 150u);
    EXPECT_EQ(keys.back(), 200u);
    const float rounding = bits == 32 ? 1e-6f : 0.5f / (bits == 8 ? 255.0f : 65535.0f) + 1e-6f;
    for (std::size_t i = 0; i < weights.values.size(); ++i) {
      EXPECT_LE(std::abs(kept.values[i] - weights.values[i]), slack[i % 2] + rounding) << i;
    }
    const auto again = gltf::weight_keys(kept, std::vector<float>(2, 1e-6f));
    EXPECT_TRUE(std::ranges::includes(keys, again));
  }
}

// A viewer would read other weights than were meant, or files be as large as those of floats.
TEST(GltfMorphTargets, QuantizedWeightsAreWholeNumbers) {
  for (const bool compressed : {false, true}) {
    for (const bool is_signed : {false, true}) {
      for (const int bits : {8, 16}) {
        Face face(4);
        for (std::size_t i = 1; !is_signed && i < face.weights.values.size(); i += 2) {
          face.weights.values[i] = 0.3f;
        }
        face.weights = gltf::on_keys(face.weights, std::vector<float>(2, 0.0f), bits);
        face.options.quantized = gltf::Quantization();
        face.options.compressed = compressed;
        const Clip clip = test::swinging_clip(face.model.skeleton, 4, 24);
        Status status;
        const std::string bytes = test::bytes_of(
            [&](OutputFile& file) { return gltf::write_rig(face.model, clip, face.options, file); },
            status);
        ASSERT_TRUE(status);
        const auto scene = gltf::read(std::as_bytes(std::span(bytes)));
        ASSERT_TRUE(scene.ok()) << scene.error().message;
        int found = 0;
        for (const auto& channel : scene->animations.at(0).channels) {
          if (channel.path != nodes::Path::weights) continue;
          ++found;
          ASSERT_EQ(channel.values->size(), face.weights.values.size());
          for (std::size_t i = 0; i < channel.values->size(); ++i) {
            EXPECT_NEAR((*channel.values)[i], face.weights.values[i], 1e-6);
          }
        }
        EXPECT_EQ(found, 1);
      }
    }
  }
}

// Targets would have normals that the file they come from has not.
TEST(GltfMorphTargets, NormalsThatNoTargetTurnsAreNotWritten) {
  for (const bool quantized : {false, true}) {
    Face face(3);
    if (quantized) face.options.quantized = gltf::Quantization();
    for (const bool turned : {true, false}) {
      if (!turned) {
        face.morphs.normals = face.model.normals;
        face.morphs.normals.insert(face.morphs.normals.end(), face.model.normals.begin(),
                                   face.model.normals.end());
      }
      const auto targets = face.rig().json["meshes"][0]["primitives"][0]["targets"];
      for (const auto& target : targets) EXPECT_EQ(target.contains("NORMAL"), turned);
    }
  }
}

TEST(GltfMorphTargets, EachClipHasItsOwnWeights) {
  const Face face(3);
  const Clip clip = test::swinging_clip(face.model.skeleton, 5, 30);
  const auto tracks = gltf::joint_tracks(face.model.skeleton, clip);
  ASSERT_TRUE(tracks.ok());
  MorphWeights other = face.weights;
  for (float& weight : other.values) weight = 1 - weight;
  const std::vector<gltf::NamedTracks> clips = {
      {"walk", &*tracks, &face.weights}, {"still", &*tracks}, {"talk", &*tracks, &other}};
  gltf::WriteOptions options = face.options;
  options.weights = nullptr;
  const test::Glb glb = test::written(
      [&](OutputFile& file) { return gltf::write_rig(face.model, clips, options, file); });
  ASSERT_EQ(glb.json["animations"].size(), 3u);
  const std::vector<std::vector<float>> expected = {face.weights.values, {}, other.values};
  for (std::size_t i = 0; i < 3; ++i) {
    const auto& animation = glb.json["animations"][i];
    std::vector<float> found;
    for (const auto& channel : animation["channels"]) {
      if (channel["target"]["path"] != "weights") continue;
      found = glb.values<float>(animation["samplers"][channel["sampler"].get<int>()]["output"]);
    }
    EXPECT_EQ(found, expected[i]) << i;
    EXPECT_EQ(animation["extras"]["rate"], 30.0);
  }
}

// Equal weights of two clips are one accessor in compressed files. Would fail if a clip took a
// sampler of another one's: files were broken, or the program crashed.
TEST(GltfMorphTargets, ClipsOfEqualWeightsKeepSamplersOfTheirOwn) {
  const Face face(3);
  Clip still = test::swinging_clip(face.model.skeleton, 5, 30);
  for (int f = 0; f < 5; ++f) still.set_pose(f, face.model.skeleton.reference);
  const auto many =
      gltf::joint_tracks(face.model.skeleton, test::swinging_clip(face.model.skeleton, 5, 30));
  const auto few = gltf::joint_tracks(face.model.skeleton, still);
  ASSERT_TRUE(many.ok() && few.ok());
  const std::vector<gltf::NamedTracks> clips = {{"many", &*many, &face.weights},
                                                {"few", &*few, &face.weights}};
  gltf::WriteOptions options = face.options;
  options.weights = nullptr;
  options.compressed = true;
  const test::Glb glb = test::written(
      [&](OutputFile& file) { return gltf::write_rig(face.model, clips, options, file); });
  for (const auto& animation : glb.json["animations"]) {
    for (const auto& channel : animation["channels"]) {
      if (channel["target"]["path"] != "weights") continue;
      const auto& sampler = animation["samplers"][channel["sampler"].get<std::size_t>()];
      EXPECT_EQ(glb.json["accessors"][sampler["output"].get<std::size_t>()]["type"], "SCALAR");
    }
  }
}

// Would fail if each mesh of a character had the targets of its face: 15 kB of 141 for a robot of
// 19 meshes, three of which move.
TEST(GltfMorphTargets, AreOnlyOnMeshesThatTheyMove) {
  Face face(3);
  Model& model = face.model;
  const auto vertices = model.positions.size(), triangles = model.triangles.size();
  const auto twice = [](auto& values) {
    const auto once = values;
    values.insert(values.end(), once.begin(), once.end());
  };
  twice(model.positions);
  twice(model.normals);
  twice(model.texture_coordinates);
  twice(model.tangents);
  twice(model.influence_joints);
  twice(model.influence_weights);
  twice(model.triangles);
  for (std::size_t t = triangles; t < 2 * triangles; ++t) {
    for (auto& corner : model.triangles[t]) corner += static_cast<std::uint32_t>(vertices);
  }
  const auto count = static_cast<std::uint32_t>(triangles);
  model.parts = {{"body", "skin", 0, count, "body"}, {"head", "skin", count, count, "head"}};
  face.morphs.vertex_count = model.vertex_count();
  face.morphs.positions.clear();
  face.morphs.normals.clear();
  for (std::size_t t = 0; t < 2; ++t) {
    for (std::size_t v = 0; v < 2 * vertices; ++v) {
      const bool moves = t == 1 && v == vertices + 3;
      face.morphs.positions.push_back(model.positions[v] + Vec3f(moves ? 0.25f : 0, 0, 0));
      face.morphs.normals.push_back(model.normals[v]);
    }
  }
  const test::Glb glb = face.rig();
  ASSERT_EQ(glb.json["meshes"].size(), 2u);
  const auto& body = glb.json["meshes"][0];
  EXPECT_FALSE(body["primitives"][0].contains("targets"));
  EXPECT_FALSE(body.contains("extras"));
  const auto& head = glb.json["meshes"][1];
  ASSERT_EQ(head["primitives"][0]["targets"].size(), 2u);
  EXPECT_EQ(head["extras"]["targetNames"], nlohmann::json(face.morphs.names));
  int animated = 0;
  for (const auto& channel : glb.json["animations"][0]["channels"]) {
    if (channel["target"]["path"] != "weights") continue;
    ++animated;
    EXPECT_EQ(glb.json["nodes"][channel["target"]["node"].get<int>()]["mesh"], 1);
  }
  EXPECT_EQ(animated, 1);
}

// A target that moves a few vertices of many must not take as much as one that moves all.
TEST(GltfMorphTargets, ThatMoveLittleAreSparse) {
  Face face(2);
  for (int t = 0; t < 2; ++t) {
    for (int v = 0; v < face.model.vertex_count(); ++v) {
      const auto at = static_cast<std::size_t>(t * face.model.vertex_count() + v);
      const auto own = static_cast<std::size_t>(v);
      face.morphs.positions[at] = face.model.positions[own];
      face.morphs.normals[at] = face.model.normals[own];
      if (v % 50 == 7) face.morphs.positions[at] += Vec3f(0, 0.5f, 0);
    }
  }
  const test::Glb glb = face.rig();
  const auto& targets = glb.json["meshes"][0]["primitives"][0]["targets"];
  for (int t = 0; t < 2; ++t) {
    const auto index = static_cast<std::size_t>(t);
    const auto& accessor = glb.json["accessors"][targets[index]["POSITION"].get<std::size_t>()];
    EXPECT_FALSE(accessor.contains("bufferView"));
    EXPECT_LT(accessor["sparse"]["count"], face.model.vertex_count() / 40);
    EXPECT_EQ(accessor["max"], nlohmann::json({0.0, 0.5, 0.0}));
  }
  const auto scene = gltf::read(std::as_bytes(std::span(glb.bytes)));
  ASSERT_TRUE(scene.ok()) << scene.error().message;
  const auto& read = scene->meshes.at(0).primitives.at(0).targets.at(1);
  for (std::size_t v = 0; v < face.model.positions.size(); ++v) {
    EXPECT_EQ(
        (*read.positions)[v].y(),
        v % 50 == 7 ? (face.model.positions[v].y() + 0.5f) - face.model.positions[v].y() : 0.0f);
  }
}

// --quantize made such files three times as large: 3.7 MB where floats took 1.25.
TEST(GltfMorphTargets, ThatMoveLittleAreSparseWhenQuantized) {
  Face face(2);
  face.options.quantized.emplace();
  for (int v = 0; v < face.model.vertex_count(); ++v) {
    const auto own = static_cast<std::size_t>(v);
    face.morphs.positions[own] = face.model.positions[own];
    face.morphs.normals[own] = face.model.normals[own];
    if (v % 50 != 7) continue;
    face.morphs.positions[own] += Vec3f(0, 0.5f, 0);
    face.morphs.normals[own] = -face.model.normals[own].normalized() * 0.25f;
  }
  const test::Glb glb = face.rig();
  const auto& target = glb.json["meshes"][0]["primitives"][0]["targets"][0];
  const auto& accessor = glb.json["accessors"][target["POSITION"].get<std::size_t>()];
  EXPECT_FALSE(accessor.contains("bufferView"));
  EXPECT_LT(accessor["sparse"]["count"], face.model.vertex_count() / 40);
  const auto scene = gltf::read(std::as_bytes(std::span(glb.bytes)));
  ASSERT_TRUE(scene.ok()) << scene.error().message;
  // What the file holds is in the unit of its grid, which the skin's matrices undo.
  const auto& read = scene->meshes.at(0).primitives.at(0).targets.at(0);
  const float scale = (*read.positions)[7].y() / 0.5f;
  EXPECT_GT(scale, 0.1f);
  for (std::size_t v = 0; v < face.model.positions.size(); ++v) {
    EXPECT_NEAR((*read.positions)[v].y(), v % 50 == 7 ? 0.5f * scale : 0.0f, 2e-4f) << v;
    EXPECT_EQ((*read.positions)[v].x(), 0.0f);
  }
}

TEST(GltfMorphTargets, OneFrameIsAShapeForGood) {
  const test::Glb glb = Face(1).mesh();
  EXPECT_EQ(glb.json["meshes"][0]["weights"], nlohmann::json({0.0, -0.5}));
  EXPECT_FALSE(glb.json.contains("animations"));
}

TEST(GltfMorphTargets, WithoutWeightsTheyStandReady) {
  Face face(0);
  face.options.weights = nullptr;
  const test::Glb glb = face.mesh();
  EXPECT_EQ(glb.json["meshes"][0]["primitives"][0]["targets"].size(), 2u);
  EXPECT_FALSE(glb.json.contains("animations"));
  EXPECT_FALSE(glb.json["meshes"][0].contains("weights"));
}

TEST(GltfMorphTargets, NormalsMoveOnlyWhereBothHaveThem) {
  Face face(2);
  face.morphs.normals.clear();
  EXPECT_FALSE(face.mesh().json["meshes"][0]["primitives"][0]["targets"][0].contains("NORMAL"));
  Face bare(2);
  bare.model.normals.clear();
  EXPECT_FALSE(bare.mesh().json["meshes"][0]["primitives"][0]["targets"][0].contains("NORMAL"));
}

TEST(GltfMorphTargets, WhatDoesNotFitIsRefused) {
  EXPECT_EQ(Face(2).mesh_error(), "none");
  Face other(2);
  other.weights.names[0] = "frown";
  EXPECT_EQ(other.mesh_error(), "gltf-morphs");
  Face nan(2);
  nan.weights.values[1] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(nan.mesh_error(), "gltf-morphs");
  Face torn(2);
  torn.weights.values.pop_back();
  EXPECT_EQ(torn.mesh_error(), "gltf-morphs");
  Face alone(2);
  alone.options.morphs = nullptr;
  EXPECT_EQ(alone.mesh_error(), "gltf-morphs");
  Face fewer(2);
  --fewer.morphs.vertex_count;
  fewer.morphs.positions.resize(2 * static_cast<std::size_t>(fewer.morphs.vertex_count));
  fewer.morphs.normals.clear();
  EXPECT_EQ(fewer.mesh_error(), "gltf-morphs");
}

}  // namespace
}  // namespace krok
