// If these fail, other programs see another mesh in an OBJ file than the model has, or its floats
// do not come back as they were.

#include "formats/obj/obj_writer.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <limits>
#include <random>

#include "formats/obj/obj_reader.h"
#include "scene/skeleton.h"
#include "support/human_skeleton.h"
#include "support/test_scenes.h"
#include "support/written_bytes.h"

namespace krok {
namespace {

using testing::HasSubstr;
using testing::Not;

// Two triangles, each a part.
Model square() {
  Model model;
  model.skeleton.add("root", -1, {Vec3::Zero(), Quat::Identity()});
  model.positions = {Vec3f(0, 0, 0), Vec3f(1, 0, 0), Vec3f(1, 1, 0.25f), Vec3f(0, 1, -2e-7f)};
  model.influences_per_vertex = 1;
  model.influence_joints.assign(4, 0);
  model.influence_weights.assign(4, 1.0f);
  model.triangles = {{0, 1, 2}, {0, 2, 3}};
  model.parts = {{"lower", "skin", 0, 1}, {"upper", "hair", 1, 1}};
  return model;
}

std::string written(const Model& model, const obj::WriteOptions& options = {}) {
  return test::bytes_of([&](OutputFile& file) {
    return obj::write(model, {model.positions, model.normals, {}}, options, file);
  });
}

TEST(ObjWriter, WritesWhatTheFormatSays) {
  Model model = square();
  obj::WriteOptions options;
  options.name = "body";
  options.provenance.tool = "krok-skin";
  options.provenance.version = "1.2.3";
  EXPECT_EQ(written(model, options),
            "# krok-skin 1.2.3\n# metres, +Y up\no body\n"
            "v 0 0 0\nv 1 0 0\nv 1 1 0.25\nv 0 1 -2e-07\n"
            "g lower\nusemtl skin\nf 1 2 3\n"
            "g upper\nusemtl hair\nf 1 3 4\n");
  model.texture_coordinates = {Vec2f(0, 1), Vec2f(1, 1), Vec2f(1, 0.25f), Vec2f(0, 0)};
  EXPECT_THAT(written(model), HasSubstr("vt 0 0\nvt 1 0\nvt 1 0.75\nvt 0 1\n"));
  EXPECT_THAT(written(model), HasSubstr("f 1/1 2/2 3/3\n"));
  model.normals.assign(4, Vec3f::UnitZ());
  EXPECT_THAT(written(model), HasSubstr("vn 0 0 1\n"));
  EXPECT_THAT(written(model), HasSubstr("f 1/1/1 2/2/2 3/3/3\n"));
  model.texture_coordinates.clear();
  EXPECT_THAT(written(model), HasSubstr("f 1//1 3//3 4//4\n"));
}

TEST(ObjWriter, EveryFloatComesBackToTheBit) {
  Model model = test::tube_model(test::human_skeleton(), 1, 12, 12);
  std::mt19937 random(7);
  const auto any_near = [&] {
    float value = std::numeric_limits<float>::infinity();
    while (!(std::abs(value) <= kFarthest))
      value = std::bit_cast<float>(static_cast<std::uint32_t>(random()));
    return value;
  };
  for (Vec3f& position : model.positions) position = Vec3f(any_near(), any_near(), any_near());
  model.positions[0] = Vec3f(-1.17549435e-38f, 1e-45f, -999999936.0f);
  model.positions[1] = Vec3f(-0.0f, 16777217.0f, 0.1f);
  const auto shape = obj::read(written(model), "t.obj");
  ASSERT_TRUE(shape.ok()) << shape.error().message;
  ASSERT_EQ(shape->model.positions.size(), model.positions.size());
  for (std::size_t v = 0; v < model.positions.size(); ++v) {
    for (int i = 0; i < 3; ++i) {
      ASSERT_EQ(std::bit_cast<std::uint32_t>(shape->model.positions[v][i]),
                std::bit_cast<std::uint32_t>(model.positions[v][i]))
          << model.positions[v][i];
    }
  }
  EXPECT_EQ(shape->model.triangles, model.triangles);
  ASSERT_EQ(shape->model.normals.size(), model.normals.size());
  ASSERT_EQ(shape->model.texture_coordinates.size(), model.texture_coordinates.size());
  for (std::size_t v = 0; v < model.positions.size(); ++v) {
    EXPECT_LT((shape->model.normals[v] - model.normals[v]).norm(), 1e-6f);
    EXPECT_LT((shape->model.texture_coordinates[v] - model.texture_coordinates[v]).norm(), 1e-6f);
  }
}

TEST(ObjWriter, PartsComeBackByNameAndMaterial) {
  const auto shape = obj::read(written(square()), "t.obj");
  ASSERT_TRUE(shape.ok());
  ASSERT_EQ(shape->model.parts.size(), 2u);
  EXPECT_EQ(shape->model.parts[0].material, "skin");
  EXPECT_EQ(shape->model.parts[1].material, "hair");
  EXPECT_THAT(shape->model.parts[1].name, HasSubstr("upper"));
}

TEST(ObjWriter, NamesNeitherEndALineNorMeetAnother) {
  Model model = square();
  model.parts = {{"a b", "one\ntwo#\\", 0, 1}, {"a_b", "", 1, 1}};
  obj::WriteOptions options;
  options.name = "";
  const std::string text = written(model, options);
  EXPECT_THAT(text, HasSubstr("o default\n"));
  EXPECT_THAT(text, HasSubstr("g a_b\nusemtl one_two__\nf 1"));
  EXPECT_THAT(text, HasSubstr("g a_b_2\nusemtl default\nf 1"));
  model.parts = {{"", "", 0, 0}, {"", "", 0, 2}};
  EXPECT_THAT(written(model), Not(HasSubstr("usemtl")));
  EXPECT_THAT(written(model), Not(HasSubstr("\ng ")));
}

// A motion is a file a frame of one writer; more text than is written at once.
TEST(ObjWriter, OneWriterWritesEachShape) {
  const Model model = test::tube_model(test::human_skeleton(), 1, 30, 30);
  const auto writer = obj::Writer::create(model, {});
  ASSERT_TRUE(writer.ok());
  for (int frame = 0; frame < 3; ++frame) {
    std::vector<Vec3f> positions = model.positions;
    for (Vec3f& position : positions) position.x() += 0.1f * static_cast<float>(frame);
    const std::string text = test::bytes_of([&](OutputFile& file) {
      return writer->write({positions, model.normals, {}}, file);
    });
    EXPECT_GT(text.size(), std::size_t{3} << 18);
    const auto shape = obj::read(text, "t.obj");
    ASSERT_TRUE(shape.ok()) << shape.error().message;
    EXPECT_EQ(shape->model.positions, positions);
    EXPECT_EQ(shape->model.triangles, model.triangles);
  }
}

TEST(ObjWriter, RefusesWhatIsNoMesh) {
  const auto code_of = [](const Model& model, const MeshShape& shape) {
    return test::error_code([&](OutputFile& file) { return obj::write(model, shape, {}, file); });
  };
  Model model = square();
  const std::vector<Vec3f> normals(4, Vec3f::UnitZ());
  EXPECT_EQ(code_of(model, {model.positions, {}, {}}), "none");
  EXPECT_EQ(code_of(model, {normals, normals, {}}), "obj-shape");
  EXPECT_EQ(code_of(model, {std::span(normals).first(3), {}, {}}), "obj-shape");
  std::vector<Vec3f> bad = model.positions;
  bad[2].y() = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(code_of(model, {bad, {}, {}}), "obj-shape");
  model.normals = normals;
  EXPECT_EQ(code_of(model, {model.positions, {}, {}}), "obj-shape");
  bad = normals;
  bad[0].x() = std::numeric_limits<float>::infinity();
  EXPECT_EQ(code_of(model, {model.positions, bad, {}}), "obj-shape");
  model.normals[1] = Vec3f(0, 0, 7);
  EXPECT_EQ(code_of(model, {model.positions, model.normals, {}}), "model-value");
  model = square();
  model.triangles.clear();
  model.parts.clear();
  EXPECT_EQ(code_of(model, {model.positions, {}, {}}), "obj-empty-mesh");
}

}  // namespace
}  // namespace krok
