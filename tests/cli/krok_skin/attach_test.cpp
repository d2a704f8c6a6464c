// krok-skin --attach. Would fail if what a hand holds were off its joint, missing, painted as the
// body is, or in the way of what the file is read for.

#include "cli/hero_character.h"
#include "formats/anim/anim.h"
#include "formats/gltf/gltf_reader.h"
#include "math/quaternion.h"
#include "nodes/evaluate.h"

namespace krok::test {
namespace {

class SkinAttach : public HeroCharacter {
 protected:
  void SetUp() override {
    HeroCharacter::SetUp();
    // One triangle, whose corners are a frame's axes.
    put("axes.gltf",
        R"({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}],
         "nodes": [{"mesh": 0}], "materials": [{"name": "Skin"}],
         "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "material": 0}]}],
         "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3",
                        "min": [0, 0, 0], "max": [1, 1, 1]}],
         "bufferViews": [{"buffer": 0, "byteLength": 36}],
         "buffers": [{"byteLength": 36, "uri": "data:application/octet-stream;base64,)"
        "AACAPwAAAAAAAAAAAAAAAAAAgD8AAAAAAAAAAAAAAAAAAIA/\"}]}");
    put("held.character",
        R"({"schema": "krok.character/1", "model": "in.model", "materials": ["in.material"],
            "parts": [{"name": "body", "material": "Skin"}],
            "sockets": [{"name": "grip", "joint": "Head", "offset": [0.1, -0.2, 0.3],
                         "orientation": [0.5, 0.5, -0.5, 0.5]}]})");
  }

  // Corners of the triangle in each frame, and where joint and socket have the axes.
  void expect_carried(const std::string& file, const std::string& joint, const Transform& socket,
                      double tolerance = 1e-6) {
    const auto scene = gltf::read_file(path(file));
    ASSERT_TRUE(scene.ok()) << scene.error().message;
    const auto evaluator = nodes::Evaluator::create(*scene);
    const InputFile input = *InputFile::open(path("in.anim"));
    const auto clip = anim::read(input.bytes());
    ASSERT_TRUE(clip.ok());
    std::size_t thing = 0;
    while (evaluator->primitive(evaluator->instances()[thing]).vertex_count() != 3) ++thing;
    nodes::Evaluation shown;
    std::vector<Transform> pose(clip->skeleton.names.size());
    for (int f = 0; f < clip->frame_count(); ++f) {
      evaluator->evaluate(0, f / clip->rate, shown);
      clip->get_pose(f, pose);
      const Transform place = pose[static_cast<std::size_t>(clip->skeleton.find(joint))] * socket;
      for (int axis = 0; axis < 3; ++axis) {
        const Vec3 there = place * Vec3(Vec3::Unit(axis));
        const Vec3 here = shown.positions[thing][static_cast<std::size_t>(axis)];
        EXPECT_LT((here - there).norm(), tolerance) << file << ' ' << f;
      }
    }
  }
};

TEST_F(SkinAttach, AThingStaysInItsSocketToAThousandthOfAMillimetre) {
  const Transform grip{Vec3(0.1, -0.2, 0.3), Quat(0.5, 0.5, 0.5, -0.5)};
  tool("krok-skin", {"held.character", "in.anim", "--attach", "grip=axes.gltf", "-o", "a.glb"});
  expect_carried("a.glb", "Head", grip);
  tool("krok-skin", {"in.model", "in.anim", "--attach", "Spine=axes.gltf", "-o", "b.glb"});
  expect_carried("b.glb", "Spine", {});
  // Small files are measured on the body alone.
  tool("krok-skin", {"held.character", "in.anim", "--attach", "grip=axes.gltf", "--reduce",
                     "0.001mm", "-o", "c.glb"});
  tool("krok-skin", {"held.character", "in.anim", "--attach", "grip=axes.gltf", "--quantize",
                     "--compress", "-o", "d.glb"});
  expect_carried("d.glb", "Head", grip, 1e-4);  // rotations of joints have 16 bits
}

TEST_F(SkinAttach, NodesAreBelowTheJointAndPaintIsItsOwn) {
  tool("krok-skin", {"held.character", "in.anim", "--attach", "grip=axes.gltf", "-o", "a.gltf"});
  const json made = json::parse(get(path("a.gltf")));
  const auto node = [&](const std::string& name) {
    for (const json& one : made["nodes"]) {
      if (one["name"] == name) return one;
    }
    return json();
  };
  const json grip = node("grip");
  EXPECT_THAT(node("Head")["children"].dump(), Not(IsEmpty()));
  ASSERT_EQ(grip["children"].size(), 1u);
  EXPECT_EQ(made["nodes"][grip["children"][0].get<std::size_t>()]["name"], "axes");
  EXPECT_EQ(made["materials"].size(), 2u);
  EXPECT_EQ(made["materials"][1]["name"], "Skin_2");
  // Sockets are no joints of the skeleton when the file is read.
  const std::string info = tool("krok-info", {"a.gltf", "--json"}).out;
  EXPECT_EQ(json::parse(info)["result"].dump().find("\"grip\""), std::string::npos);
}

TEST_F(SkinAttach, AnObjIsAttachedToo) {
  put("axes.obj", "v 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\n");
  tool("krok-skin", {"in.model", "in.anim", "--attach", "Spine=axes.obj", "-o", "b.glb"});
  expect_carried("b.glb", "Spine", {});
}

// Would fail if a thing in centimetres, or far from its hand, went along without a word.
TEST_F(SkinAttach, AThingOfAnOddSizeOrPlaceIsWarnedOf) {
  const auto warning = [&](const std::string& corners) {
    put("cup.obj", corners + "f 1 2 3\n");
    return tool("krok-skin", {"in.model", "in.anim", "--attach", "Spine=cup.obj", "-o", "b.glb"})
        .err;
  };
  EXPECT_THAT(warning("v 0 0 0\nv 0 40 0\nv 8 0 0\n"),
              AllOf(HasSubstr("40 m in size"), HasSubstr("[skin-attach]")));
  EXPECT_THAT(warning("v 0 0 9\nv 0 0.1 9\nv 0.1 0 9\n"), HasSubstr("begins 9 m from the place"));
  EXPECT_THAT(warning("v 0 0 0\nv 0 0.1 0\nv 0.1 0 0\n"), Not(HasSubstr("warning")));
}

TEST_F(SkinAttach, MistakesAreTold) {
  const auto error_of = [&](const std::vector<std::string>& more) {
    std::vector<std::string> all = {"held.character", "in.anim", "-o", "x.glb"};
    all.insert(all.end(), more.begin(), more.end());
    return tool("krok-skin", all, 2).err;
  };
  EXPECT_TRUE(has_code(error_of({"--attach", "Tail=axes.gltf"}), "skin-attach"));
  EXPECT_TRUE(has_code(error_of({"--attach", "axes.gltf"}), "usage"));
  EXPECT_TRUE(has_code(error_of({"--attach", "grip=in.anim"}), "skin-attach"));
  EXPECT_TRUE(has_code(error_of({"--attach", "grip=axes.gltf", "--as", "pose"}), "usage"));
}

}  // namespace
}  // namespace krok::test
