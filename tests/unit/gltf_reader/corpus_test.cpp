// If these fail, glTF files of other exporters are shown otherwise than other programs show them.
// The figures are vertices that three.js r160 computes from the same files (rotation keys brought
// to length 1 first, which the specification asks of files and one of these neglects).

#include <gtest/gtest.h>

#include <filesystem>

#include "formats/gltf/gltf_reader.h"
#include "nodes/evaluate.h"
#include "support/this_build.h"

namespace krok {
namespace {

struct Known {
  const char* file;
  int animation;
  double time;
  std::size_t vertex;
  Vec3 position;
};

TEST(GltfCorpus, VerticesStandWhereThreeJsPutsThem) {
  const std::string corpus = test::corpus_folder() + "/other/";
  if (!std::filesystem::exists(corpus)) GTEST_SKIP() << "skipped: no corpus at " << corpus;
  const Known known[] = {
      {"gltf/rigged_simple.gltf",
       0,
       0.7,
       7,
       {0.7071067977809645, -4.575077056884766, 0.7071064423656892}},
      {"gltf/rigged_simple.gltf",
       0,
       0.7,
       159,
       {1.6028004065026815, 4.299724693473152, 0.4158197704100273}},
      {"gltf/rigged_simple.gltf",
       0,
       1.6,
       159,
       {1.0894311934337024, 4.4545605641990385, 0.41581979570298744}},
      {"assimp/simple_skin.gltf", 0, 0.8, 7, {-0.1158579106104165, 1.5974801202589024, 0}},
      {"assimp/simple_skin.gltf", 0, 2.25, 7, {0.32782785710794793, 1.6150110822628247, 0}},
      {"assimp/simple_skin.gltf", 0, 2.25, 9, {0.0789816593740128, 2.1152407359309477, 0}},
      {"gltf/CesiumMan.glb",
       -1,
       0,
       7,
       {0.16423200070858002, 0.8343350291252137, -0.5041099190711973}},
      {"gltf/CesiumMan.glb",
       -1,
       0,
       12004,
       {0.12339100241661072, 0.02369588054716588, -0.050185788422822945}},
  };
  for (const Known& one : known) {
    const auto asset = gltf::read_file(corpus + one.file);
    ASSERT_TRUE(asset.ok()) << one.file << ": " << asset.error().message;
    const auto evaluator = nodes::Evaluator::create(*asset);
    ASSERT_TRUE(evaluator.ok()) << one.file;
    nodes::Evaluation state;
    evaluator->evaluate(one.animation, one.time, state);
    ASSERT_EQ(state.positions.size(), 1u) << one.file;
    const Vec3& vertex = state.positions[0].at(one.vertex);
    EXPECT_LT((vertex - one.position).norm(), 1e-6)
        << one.file << " at " << one.time << " s: " << vertex.transpose();
  }
}

}  // namespace
}  // namespace krok
