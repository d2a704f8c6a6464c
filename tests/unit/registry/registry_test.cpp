// If these fail, a tool takes a file for something else than it is, or its message misleads.

#include "formats/registry/registry.h"

#include <gtest/gtest.h>

#include <vector>

#include "golden/samples/samples.h"

namespace krok::registry {
namespace {

std::span<const std::byte> bytes_of(std::string_view text) {
  return std::as_bytes(std::span(text));
}

TEST(Registry, ContentTellsTheKind) {
  EXPECT_EQ(kind_of_content(samples::bytes_of(samples::clip())), Kind::anim);
  EXPECT_EQ(kind_of_content(samples::bytes_of(samples::model())), Kind::model);
  EXPECT_EQ(kind_of_content(samples::bytes_of(samples::camera())), Kind::cam);
  EXPECT_EQ(kind_of_content(bytes_of("HIERARCHY\r\nROOT")), Kind::bvh);
  EXPECT_EQ(kind_of_content(bytes_of("\xEF\xBB\xBF \n\tHierarchy\r")), Kind::bvh);
  EXPECT_EQ(kind_of_content(bytes_of("# AST/ASF file\n#\n:version 1.10\n")), Kind::asf);
  EXPECT_EQ(kind_of_content(bytes_of("\r\n:UNITS\r\n")), Kind::asf);
  EXPECT_EQ(kind_of_content(bytes_of("#!OML:ASF F:\\a.ASF\n:FULLY-SPECIFIED\n")), Kind::amc);
  EXPECT_EQ(kind_of_content(bytes_of(":degrees")), Kind::amc);
  EXPECT_EQ(kind_of_content(bytes_of(":unheard-of\n")), Kind::unknown);
  EXPECT_EQ(kind_of_content(bytes_of("# a comment alone")), Kind::unknown);
  EXPECT_EQ(kind_of_content(bytes_of(std::string_view("POINTCACHE2\0\1", 13))), Kind::pc2);
  EXPECT_EQ(kind_of_content(bytes_of("POINTCACHE2")), Kind::unknown);
  EXPECT_EQ(kind_of_content(bytes_of("glTF\2")), Kind::glb);
  EXPECT_EQ(kind_of_content(bytes_of(" {\n \"asset\": {\"version\": \"2.0\"}}")), Kind::gltf);
  // A material called "asset" is none of glTF.
  EXPECT_EQ(kind_of_content(bytes_of("{\"schema\": \"krok.material/1\", \"asset\": 1}")),
            Kind::material);
  EXPECT_EQ(kind_of_content(bytes_of("\n{ \"schema\":\"krok.character/1\"}")), Kind::character);
  EXPECT_EQ(kind_of_content(bytes_of("{\"schema\": \"krok.ragdoll/1\"}")), Kind::ragdoll);
  EXPECT_EQ(kind_of_content(bytes_of("{\"schema\": \"krok.correctives/1\"}")), Kind::correctives);
  EXPECT_EQ(kind_of_content(bytes_of("{\"schema\": \"krok.timeline/1\"}")), Kind::unknown);
  EXPECT_EQ(kind_of_content(bytes_of("{\"a\":1}")), Kind::unknown);
  EXPECT_EQ(kind_of_content(bytes_of("HIER")), Kind::unknown);
  EXPECT_EQ(kind_of_content(bytes_of("KROKANI")), Kind::unknown);
  EXPECT_EQ(kind_of_content({}), Kind::unknown);
}

TEST(Registry, ContentTellsTheKindOfScenes) {
  EXPECT_EQ(kind_of_content(bytes_of("Kaydara FBX Binary  ")), Kind::fbx);
  EXPECT_EQ(kind_of_content(bytes_of("; FBX 7.4.0 project file\n")), Kind::fbx);
  EXPECT_EQ(kind_of_content(bytes_of("FBXHeaderExtension:  {\n")), Kind::fbx);
  EXPECT_EQ(kind_of_content(bytes_of("<?xml version=\"1.0\"?>\n<COLLADA xmlns=\"\">")),
            Kind::collada);
  EXPECT_EQ(kind_of_content(bytes_of("<?xml version=\"1.0\"?>\n<html>")), Kind::unknown);
  EXPECT_EQ(kind_of_content(bytes_of("// a comment\nversion 1\r\nnodes\r\n")), Kind::smd);
  EXPECT_EQ(kind_of_content(bytes_of("version 1\n")), Kind::unknown);
  EXPECT_EQ(kind_of_content(bytes_of("MS3D000000\4")), Kind::ms3d);
  EXPECT_EQ(kind_of_content(bytes_of("*3DSMAX_ASCIIEXPORT 200\n")), Kind::ase);
  EXPECT_EQ(kind_of_content(bytes_of("MD5Version 10\nnumJoints 1\nnumMeshes 1\n")), Kind::md5mesh);
  EXPECT_EQ(kind_of_content(bytes_of("MD5Version 10\nnumAnimatedComponents 6\n")), Kind::md5anim);
  EXPECT_EQ(kind_of_content(bytes_of("MD5Version 10\nnumCuts 0\n")), Kind::unknown);
  const std::string_view sized("MM\x10\0\0\0\0\0\0\0\0\0\0\0\0\0", 16);
  const std::string_view versioned("MM\xFF\0\0\0\2\0\0\0\0\0\0\0\0\0", 16);
  const std::string_view letters("MMMMMMMMMMMMMMMM", 16);
  EXPECT_EQ(kind_of_content(bytes_of(sized)), Kind::max_3ds);
  EXPECT_EQ(kind_of_content(bytes_of(versioned)), Kind::max_3ds);
  EXPECT_EQ(kind_of_content(bytes_of(letters)), Kind::unknown);
  EXPECT_EQ(kind_of_content(bytes_of(versioned.substr(0, 15))), Kind::unknown);
}

TEST(Registry, ScenesOfOtherProgramsGoThroughAssimp) {
  for (const Kind kind : {Kind::fbx, Kind::collada, Kind::smd, Kind::ms3d, Kind::max_3ds, Kind::ase,
                          Kind::md5mesh, Kind::md5anim}) {
    EXPECT_TRUE(is_read_through_assimp(kind)) << kind_name(kind);
    EXPECT_EQ(kind_of_name("a." + std::string(kind_name(kind))), kind);
    EXPECT_EQ(advice(kind, Kind::anim), "import it with krok-import");
  }
  for (const Kind kind :
       {Kind::unknown, Kind::anim, Kind::model, Kind::cam, Kind::material, Kind::character,
        Kind::ragdoll, Kind::bvh, Kind::asf, Kind::amc, Kind::pc2, Kind::glb, Kind::gltf}) {
    EXPECT_FALSE(is_read_through_assimp(kind)) << kind_name(kind);
  }
}

TEST(Registry, GltfIsRecognisedWhereTheAssetStandsLast) {
  const std::string text =
      "{\"buffers\": [{\"uri\": \"" + std::string(300000, 'A') + "\"}], \"asset\": {}}";
  EXPECT_EQ(kind_of_content(bytes_of(text)), Kind::gltf);
}

TEST(Registry, NameTellsTheKindInAnyCase) {
  EXPECT_EQ(kind_of_name("a/b.anim"), Kind::anim);
  EXPECT_EQ(kind_of_name("b.MODEL"), Kind::model);
  EXPECT_EQ(kind_of_name("b.x.cam"), Kind::cam);
  EXPECT_EQ(kind_of_name("Walk.BVH"), Kind::bvh);
  EXPECT_EQ(kind_of_name("01.ASF"), Kind::asf);
  EXPECT_EQ(kind_of_name("01_01.amc"), Kind::amc);
  EXPECT_EQ(kind_of_name("b.PC2"), Kind::pc2);
  EXPECT_EQ(kind_of_name("b.glb"), Kind::glb);
  EXPECT_EQ(kind_of_name("b.gltf"), Kind::gltf);
  EXPECT_EQ(kind_of_name("b.FBX"), Kind::fbx);
  EXPECT_EQ(kind_of_name("b.dae"), Kind::collada);
  EXPECT_EQ(kind_of_name("b.smd"), Kind::smd);
  EXPECT_EQ(kind_of_name("b.ms3d"), Kind::ms3d);
  EXPECT_EQ(kind_of_name("b.3DS"), Kind::max_3ds);
  EXPECT_EQ(kind_of_name("b.ase"), Kind::ase);
  EXPECT_EQ(kind_of_name("b.md5mesh"), Kind::md5mesh);
  EXPECT_EQ(kind_of_name("b.md5anim"), Kind::md5anim);
  EXPECT_EQ(kind_of_name("b.obj"), Kind::unknown);
  EXPECT_EQ(kind_of_name("anim"), Kind::unknown);
  EXPECT_EQ(kind_of_name("b."), Kind::unknown);
  EXPECT_EQ(kind_of_name(""), Kind::unknown);
  EXPECT_EQ(kind_of_name("-"), Kind::unknown);
}

TEST(Registry, ContentOutweighsTheName) {
  EXPECT_EQ(identify("walk.anim", bytes_of("HIERARCHY\n")), Kind::bvh);
  EXPECT_EQ(identify("walk.bvh", bytes_of("nonsense")), Kind::bvh);
  EXPECT_EQ(identify("walk.txt", bytes_of("nonsense")), Kind::unknown);
}

TEST(Registry, ForeignFilesAreDescribed) {
  EXPECT_EQ(describe_content({}), "an empty file");
  EXPECT_EQ(describe_content(bytes_of("Kaydara FBX Binary  ")), "an FBX file");
  EXPECT_EQ(describe_content(bytes_of("\x89PNG\r\n")), "a PNG image");
  EXPECT_EQ(describe_content(bytes_of("<?xml version")), "an XML text file");
  EXPECT_EQ(describe_content(bytes_of(std::string_view("POINTCACHE2", 12))),
            "a point cache (.pc2)");
  EXPECT_EQ(describe_content(bytes_of("# by hand\nmtllib a.mtl\nv 0 0 0\n")),
            "an OBJ mesh (without joints)");
  EXPECT_EQ(describe_content(bytes_of("\x02P\x01")), "a C3D file (markers, no skeleton)");
  EXPECT_EQ(describe_content(bytes_of("hello\n")), "a text file of unknown kind");
  EXPECT_EQ(describe_content(bytes_of("\x01\x02")), "a binary file of unknown kind");
}

TEST(Registry, AdviceIsGivenWhereThereIsSome) {
  for (const Kind capture : {Kind::bvh, Kind::asf, Kind::amc}) {
    EXPECT_EQ(advice(capture, Kind::anim), "import it with krok-import");
  }
  EXPECT_EQ(advice(Kind::anim, Kind::model), "krok-body makes a model for a motion");
  EXPECT_NE(advice(Kind::model, Kind::anim), "");
  EXPECT_EQ(advice(Kind::anim, Kind::anim), "");
  EXPECT_NE(advice(Kind::unknown, Kind::anim), "");
  EXPECT_EQ(advice(Kind::unknown, Kind::cam), "");
}

}  // namespace
}  // namespace krok::registry
