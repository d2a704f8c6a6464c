// If these fail, shapes from OBJ files have their vertices elsewhere or in another order than the
// file, which morph targets go by, or a damaged line is passed over or reported at the wrong place.

#include "formats/obj/obj_reader.h"

#include <gtest/gtest.h>

#include "formats/obj/obj_writer.h"
#include "support/test_scenes.h"
#include "support/written_bytes.h"

namespace krok::obj {
namespace {

using Triangles = std::vector<std::array<std::uint32_t, 3>>;

Shape read_good(const std::string& text, const ReadOptions& options = {}) {
  auto shape = read(text, "s.obj", options);
  EXPECT_TRUE(shape.ok()) << (shape ? "" : shape.error().message);
  return shape ? *std::move(shape) : Shape();
}

const std::string kSquare =
    "# a square\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nvn 0 0 1\n";

TEST(ObjReader, VerticesKeepTheirOrderAndPolygonsAreFans) {
  const Shape shape = read_good(kSquare + "f 1/1/1 2/2/1 3/3/1 4/4/1\n");
  const Model& model = shape.model;
  EXPECT_EQ(model.positions, (std::vector<Vec3f>{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}));
  EXPECT_EQ(model.triangles, (Triangles{{0, 1, 2}, {0, 2, 3}}));
  EXPECT_EQ(model.normals, std::vector<Vec3f>(4, Vec3f::UnitZ()));
  // v goes up in OBJ files and down here.
  EXPECT_EQ(model.texture_coordinates, (std::vector<Vec2f>{{0, 1}, {1, 1}, {1, 0}, {0, 0}}));
  EXPECT_EQ(model.skeleton.names, std::vector<std::string>{"root"});
  EXPECT_TRUE(check(model).ok());
  EXPECT_TRUE(shape.diagnostics.empty());
}

TEST(ObjReader, NegativeIndicesCountBack) {
  const Shape shape = read_good("v 0 0 0\nv 1 0 0\nv 0 1 0\nf -3 -2 -1\nv 0 0 1\nf -1 -4 1\n");
  EXPECT_EQ(shape.model.triangles, (Triangles{{0, 1, 2}, {3, 0, 0}}));
  EXPECT_TRUE(shape.model.normals.empty());
}

TEST(ObjReader, LinesGoOnAfterABackslashAndMayEndAnyhow) {
  const std::string text =
      "\xEF\xBB\xBFv 0 0 \\\r\n 0 # first\r\nv 1 0 0\rv\t0 1 0\n\n  f 1 2\\\n 3";
  const Shape shape = read_good(text);
  EXPECT_EQ(shape.model.positions, (std::vector<Vec3f>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}));
  EXPECT_EQ(shape.model.triangles, (Triangles{{0, 1, 2}}));
}

TEST(ObjReader, GroupsAndMaterialsMakeParts) {
  const std::string face = "f 1 2 3\n";
  const Shape shape = read_good(kSquare + face + "o left arm\nusemtl skin\n" + face + face +
                                "g none\ng hand\n" + face + "usemtl\n" + face);
  const auto& parts = shape.model.parts;
  ASSERT_EQ(parts.size(), 4u);
  EXPECT_EQ(parts[0].name, "");
  EXPECT_EQ(parts[1].name, "left arm");
  EXPECT_EQ(parts[1].material, "skin");
  EXPECT_EQ(parts[1].triangle_count, 2u);
  EXPECT_EQ(parts[2].name, "hand");
  EXPECT_EQ(parts[3].material, "");
}

TEST(ObjReader, SeveralNormalsAtAVertexAreAveraged) {
  const Shape shape = read_good(
      "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 2\nvn 0 2 0\nf 1//1 2//1 3//1\nf 1//2 3//1 2//1\n");
  ASSERT_EQ(shape.model.normals.size(), 3u);
  EXPECT_LT((shape.model.normals[0] - Vec3f(0, 1, 1).normalized()).norm(), 1e-6f);
  EXPECT_EQ(shape.model.normals[1], Vec3f::UnitZ());
  // With one corner that has none, the file's are no whole.
  EXPECT_TRUE(
      read_good("v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 1\nf 1//1 2//1 3\n").model.normals.empty());
}

TEST(ObjReader, WhatIsLeftOutIsSaid) {
  const Shape shape =
      read_good(kSquare + "s 1\nmtllib a.mtl\nl 1 2\np 1\nf 1/1 2/2 3/3\nf 1/2 2/2 4/4\n");
  ASSERT_EQ(shape.diagnostics.size(), 2u);
  EXPECT_EQ(shape.diagnostics[0].code, "obj-left-out");
  EXPECT_NE(shape.diagnostics[0].message.find("l, p"), std::string::npos);
  EXPECT_EQ(shape.diagnostics[1].code, "obj-several");
}

TEST(ObjReader, UnitsAndFurtherNumbers) {
  const Shape shape = read_good("v 100 -50 1e2 0.5 0.5 0.5\nv 0 0 0 1\nv +1 .5 -0.\nf 1 2 3\n",
                                {.metres_per_unit = 0.01});
  EXPECT_EQ(shape.model.positions[0], Vec3f(1, -0.5f, 1));
}

TEST(ObjReader, MistakesAreFoundWhereTheyAre) {
  struct Case {
    const char *line, *code;
    int column;
  };
  for (const Case& one : {
           Case{"v 1 2", "obj-number", 1},
           Case{"v 1 2 x", "obj-number", 7},
           Case{"v 1 nan 2", "obj-number", 5},
           Case{"v 1 2 1e39", "obj-number", 7},
           Case{"vn 1", "obj-number", 1},
           Case{"vt", "obj-number", 1},
           Case{"f 1 2", "obj-face", 1},
           Case{"f 1 2 5", "obj-index", 7},
           Case{"f 1 2 0", "obj-index", 7},
           Case{"f 1 2 -5", "obj-index", 7},
           Case{"f 1 2 99999999999999999999", "obj-index", 7},
           Case{"f 1 2 3/9", "obj-index", 7},
           Case{"f 1 2 3//2", "obj-index", 7},
           Case{"f 1 2 3/1/1/1", "obj-index", 7},
           Case{"f 1 2 /1", "obj-index", 7},
           Case{"hello", "obj-text", 1},
       }) {
    const auto shape = read(kSquare + one.line + "\nv 0 0 0\n", "s.obj");
    ASSERT_FALSE(shape.ok()) << one.line;
    EXPECT_EQ(shape.error().code, one.code) << one.line;
    EXPECT_EQ(shape.error().where.file, "s.obj");
    EXPECT_EQ(shape.error().where.line, 11) << one.line;
    EXPECT_EQ(shape.error().where.column, one.column) << one.line;
  }
  EXPECT_EQ(read("# nothing\n", "s.obj").error().code, "obj-empty");
  std::string groups = kSquare;
  for (int i = 0; i < 65'537; ++i) groups += "g a\nf 1 2 3\n";
  EXPECT_EQ(read(groups, "s.obj").error().code, "obj-limit");
}

TEST(ObjReader, WhatTheWriterWritesComesBackToTheBit) {
  const Model model = test::tube_model(test::human_skeleton());
  Status status;
  const std::string text = test::bytes_of(
      [&](OutputFile& file) {
        return write(model, {model.positions, model.normals, {}}, {}, file);
      },
      status);
  ASSERT_TRUE(status.ok()) << status.error().message;
  const Shape shape = read_good(text);
  EXPECT_EQ(shape.model.positions, model.positions);
  EXPECT_EQ(shape.model.triangles, model.triangles);
  ASSERT_EQ(shape.model.normals.size(), model.normals.size());
  for (std::size_t v = 0; v < model.normals.size(); ++v) {
    EXPECT_LT((shape.model.normals[v] - model.normals[v]).norm(), 1e-6f);
  }
}

}  // namespace
}  // namespace krok::obj
