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
  EXPECT_EQ(kind_of_content(bytes_of("glTF\2")), Kind::glb);
  EXPECT_EQ(kind_of_content(bytes_of(" {\n \"asset\": {\"version\": \"2.0\"}}")), Kind::gltf);
  EXPECT_EQ(kind_of_content(bytes_of("{\"a\":1}")), Kind::unknown);
  EXPECT_EQ(kind_of_content(bytes_of("HIER")), Kind::unknown);
  EXPECT_EQ(kind_of_content(bytes_of("KROKANI")), Kind::unknown);
  EXPECT_EQ(kind_of_content({}), Kind::unknown);
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
  EXPECT_EQ(kind_of_name("b.glb"), Kind::glb);
  EXPECT_EQ(kind_of_name("b.gltf"), Kind::gltf);
  EXPECT_EQ(kind_of_name("b.fbx"), Kind::unknown);
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
  EXPECT_EQ(describe_content(bytes_of("\x89PNG\r\n")), "a PNG picture");
  EXPECT_EQ(describe_content(bytes_of("<?xml version")), "an XML text file");
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
  EXPECT_EQ(advice(Kind::unknown, Kind::anim), "");
}

}  // namespace
}  // namespace krok::registry
