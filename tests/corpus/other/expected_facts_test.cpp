// Every file of the corpus that is no BVH against a table of facts. The numbers are from outside of
// Krok: the JSON of the glTF files, the lines of the text files, Assimp's and three.js's own tools
// for the binary ones. If these fail, a reader loses or invents joints, frames, weights or units.

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>

#include "formats/acclaim/acclaim_reader.h"
#include "formats/assimp/assimp_reader.h"
#include "formats/gltf/gltf_reader.h"
#include "nodes/evaluate.h"
#include "support/this_build.h"

namespace krok {
namespace {

const std::filesystem::path kFolder = test::corpus_folder() + "/other";

struct SceneFacts {
  const char* path;
  std::size_t nodes;   // that the file has, and Assimp's roots
  std::size_t joints;  // of all skins together
  std::size_t triangles;
  std::size_t vertices;  // different ones
  int most_influences;   // of a vertex
  std::size_t animations;
  std::size_t most_keys;  // of a channel
  double seconds;         // from the first key to the last
  double metres;          // a unit; 0: the file does not say
  Vec3 up;                // zero: the file does not say
  std::size_t cameras;
};

const SceneFacts kScenes[] = {
    {"gltf/CesiumMan.glb", 2, 0, 4672, 12005, 0, 0, 0, 0.0, 1.0, Vec3::UnitY(), 0},
    {"gltf/rigged_simple.gltf", 5, 2, 188, 160, 2, 1, 50, 2.041666, 1.0, Vec3::UnitY(), 0},
    {"assimp/simple_skin.gltf", 3, 2, 8, 10, 2, 1, 12, 5.5, 1.0, Vec3::UnitY(), 0},
    // The camera has a node of its own below the file's, for FBX's look along +X.
    {"assimp/huesitos.fbx", 17, 9, 120, 128, 4, 1, 40, 1.56, 0.01, Vec3::UnitY(), 1},
    {"assimp/animation_with_skeleton.fbx", 22, 14, 2112, 2464, 6, 1, 14, 0.833333, 0.01,
     Vec3::UnitY(), 1},
    {"assimp/Wuson.ms3d", 1, 0, 3732, 2117, 0, 0, 0, 0.0, 0.0, Vec3::Zero(), 0},
    {"assimp/WusonSMD.smd", 2, 1, 3732, 2117, 1, 0, 0, 0.0, 0.0, Vec3::Zero(), 0},
    {"assimp/SimpleCube.md5mesh", 6, 2, 12, 24, 2, 0, 0, 0.0, 0.0, Vec3::Zero(), 0},
};

class OtherCorpus : public testing::Test {
 protected:
  void SetUp() override {
    if (!std::filesystem::exists(kFolder)) GTEST_SKIP() << "skipped: no corpus at " << kFolder;
  }
};

Result<nodes::Scene> read(const std::string& path) {
  const std::string ending = std::filesystem::path(path).extension();
  const bool gltf = ending == ".glb" || ending == ".gltf";
  return gltf ? gltf::read_file(path) : assimp::read_file(path);
}

int most_influences(const nodes::Scene& scene) {
  int most = 0;
  for (const nodes::Mesh& mesh : scene.meshes) {
    for (const nodes::Primitive& primitive : mesh.primitives) {
      const auto each = static_cast<std::size_t>(primitive.influences_per_vertex);
      for (std::size_t v = 0; v < primitive.vertex_count(); ++v) {
        int used = 0;
        double sum = 0;
        for (std::size_t k = 0; k < each; ++k) {
          used += primitive.influence_weights[v * each + k] > 0 ? 1 : 0;
          sum += static_cast<double>(primitive.influence_weights[v * each + k]);
        }
        if (each > 0) {
          EXPECT_NEAR(sum, 1.0, 1e-5);
        }
        most = std::max(most, used);
      }
    }
  }
  return most;
}

TEST_F(OtherCorpus, Scenes) {
  for (const SceneFacts& facts : kScenes) {
    SCOPED_TRACE(facts.path);
    const auto scene = read((kFolder / facts.path).string());
    ASSERT_TRUE(scene.ok()) << scene.error().message;
    EXPECT_EQ(scene->nodes.size(), facts.nodes);
    std::set<int> joints;
    for (const nodes::Skin& skin : scene->skins) {
      joints.insert(skin.joints.begin(), skin.joints.end());
    }
    EXPECT_EQ(joints.size(), facts.joints);
    std::size_t triangles = 0, vertices = 0;
    for (const nodes::Mesh& mesh : scene->meshes) {
      for (const nodes::Primitive& primitive : mesh.primitives) {
        triangles += primitive.triangles.size();
        vertices += primitive.vertex_count();
      }
    }
    EXPECT_EQ(triangles, facts.triangles);
    EXPECT_EQ(vertices, facts.vertices);
    EXPECT_EQ(most_influences(*scene), facts.most_influences);
    EXPECT_EQ(scene->animations.size(), facts.animations);
    std::size_t most_keys = 0;
    double first = 1e9, last = -1e9;
    for (const nodes::Animation& animation : scene->animations) {
      for (const nodes::Channel& channel : animation.channels) {
        most_keys = std::max(most_keys, channel.times->size());
        first = std::min(first, static_cast<double>(channel.times->front()));
        last = std::max(last, static_cast<double>(channel.times->back()));
      }
    }
    EXPECT_EQ(most_keys, facts.most_keys);
    EXPECT_NEAR(std::max(last - first, 0.0), facts.seconds, 1e-4);
    EXPECT_EQ(scene->space.metres.value_or(0.0), facts.metres);
    const Vec3 up = scene->space.file_to_krok
                        ? Vec3(scene->space.file_to_krok->conjugate() * Vec3::UnitY())
                        : Vec3::Zero();
    EXPECT_LT((up - facts.up).norm(), 1e-9);
    EXPECT_EQ(scene->cameras.size(), facts.cameras);
  }
}

// Where three.js 0.187 (FBXLoader) has joints of huesitos.fbx half a second into its motion, and
// the box around its skinned mesh.
TEST_F(OtherCorpus, JointsOfAnFbxInMotion) {
  const auto scene = read((kFolder / "assimp/huesitos.fbx").string());
  ASSERT_TRUE(scene.ok());
  const auto evaluator = nodes::Evaluator::create(*scene);
  ASSERT_TRUE(evaluator.ok());
  nodes::Evaluation state;
  evaluator->evaluate(0, 0.5, state);
  const std::pair<const char*, Vec3> expected[] = {
      {"Bone.002", {-32.7364, 208.2273, -307.1354}},
      {"Bone.005", {167.9538, 213.4608, -388.8249}},
      {"Bone.006_end", {324.7167, 265.3157, -235.5146}},
      {"Bone.008_end", {-271.7800, 412.5853, -307.1354}}};
  for (const auto& [name, position] : expected) {
    const auto node = std::ranges::find(scene->nodes, name, &nodes::Node::name);
    ASSERT_NE(node, scene->nodes.end()) << name;
    const auto index = static_cast<std::size_t>(node - scene->nodes.begin());
    EXPECT_LT((state.node_to_world[index].topRightCorner<3, 1>() - position).norm(), 2e-3) << name;
  }
  Vec3 low = Vec3::Constant(1e9), high = Vec3::Constant(-1e9);
  for (const Vec3& position : state.positions.at(0)) {
    low = low.cwiseMin(position);
    high = high.cwiseMax(position);
  }
  EXPECT_LT((low - Vec3(-276.8952, 0.3491, -427.9552)).norm(), 5e-3);
  EXPECT_LT((high - Vec3(358.4794, 500.4063, -207.3298)).norm(), 5e-3);
}

struct CaptureFacts {
  const char* asf;
  const char* amc;
  int joints;  // root, bones, and the ends of bones without children
  int frames;  // lines that are a number alone
};

// The unit: length 0.45 means that a number is 1/0.45 inch.
const CaptureFacts kCaptures[] = {{"asf_amc_cmu/01.asf", "asf_amc_cmu/01_01.amc", 31, 2751},
                                  {"asf_amc_cmu/11.asf", "asf_amc_cmu/11_01.amc", 31, 597}};

std::string text_of(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

TEST_F(OtherCorpus, Captures) {
  for (const CaptureFacts& facts : kCaptures) {
    SCOPED_TRACE(facts.amc);
    const auto capture = acclaim::read(text_of(kFolder / facts.asf), facts.asf,
                                       text_of(kFolder / facts.amc), facts.amc);
    ASSERT_TRUE(capture.ok()) << capture.error().message;
    const Skeleton& skeleton = capture->clip.skeleton;
    const auto ends = std::count(skeleton.end_sites.begin(), skeleton.end_sites.end(), 1);
    EXPECT_EQ(skeleton.joint_count() - static_cast<int>(ends), facts.joints);
    EXPECT_EQ(capture->clip.frame_count(), facts.frames);
    EXPECT_EQ(capture->clip.rate, 120.0);
    // A grown-up, upright.
    EXPECT_GT(reference_extent(skeleton), 1.2);
    EXPECT_LT(reference_extent(skeleton), 2.2);
  }
}

// No file of the corpus without facts.
TEST_F(OtherCorpus, NothingIsLeftOut) {
  std::set<std::string> known;
  for (const SceneFacts& facts : kScenes) known.insert(facts.path);
  for (const CaptureFacts& facts : kCaptures) known.insert({facts.asf, facts.amc});
  for (const auto& entry : std::filesystem::recursive_directory_iterator(kFolder)) {
    if (!entry.is_regular_file()) continue;
    const std::string path = std::filesystem::relative(entry.path(), kFolder).string();
    EXPECT_TRUE(known.contains(path)) << path;
  }
}

}  // namespace
}  // namespace krok
