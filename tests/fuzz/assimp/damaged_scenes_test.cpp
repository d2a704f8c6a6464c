// Damaged files of every format that is read through Assimp. If these fail, such a file crashes or
// hangs the program, or is read as a scene that violates nodes/scene.h. Crashes of Assimp itself
// are expected; they must stay in its process.

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <map>
#include <random>
#include <sstream>

#include "support/this_build.h"
#include "unit/assimp/reading.h"
#include "unit/assimp/sample_files.h"

namespace krok {
namespace {

using namespace test;

const std::size_t kRounds = sanitized() ? 8 : 28;

class DamagedScenes : public testing::Test {
 protected:
  // Reads it; if that succeeds, evaluates it at rest and in motion.
  void survive(const std::string& name, const std::string& content) {
    const std::string path = folder_.add(name, content);
    assimp::ReadOptions options;
    // Assimp 5.2 hangs on some files; the intact sample has a generous time limit.
    options.most_seconds = outcomes_.empty() ? 60 : 0.3;
    options.seconds_per_mebibyte = 0;
    options.most_bytes = std::uint64_t{128} << 20;
    const auto scene = assimp::read_file(path, options);
    if (!scene) {
      ++outcomes_[scene.error().code];
      if (scene.error().code == "assimp-result") std::cout << scene.error().message << "\n";
      EXPECT_EQ(scene.error().where.file, path);
      EXPECT_FALSE(scene.error().message.empty());
      EXPECT_LT(scene.error().message.size(), 1000u);
      return;
    }
    ++outcomes_["read"];
    const auto evaluator = nodes::Evaluator::create(*scene);
    if (!evaluator) return;
    nodes::Evaluation state;
    for (int a = -1; a < static_cast<int>(scene->animations.size()); ++a) {
      evaluator->evaluate(a, 0.2, state);
    }
  }

  void damage(const std::string& name, const std::string& whole) {
    std::mt19937 random(static_cast<unsigned>(whole.size()));
    survive(name, whole);
    EXPECT_EQ(outcomes_["read"], 1u) << name << " is no sample of its format";
    for (std::size_t round = 0; round < kRounds; ++round) {
      survive(name, whole.substr(0, whole.size() * round / kRounds));
      std::string changed = whole;
      const std::size_t changes = 1 + random() % 4;
      for (std::size_t k = 0; k < changes; ++k) {
        changed[random() % changed.size()] = static_cast<char>(random() % 256);
      }
      survive(name, changed);
      // Another number: texts contain digits, binary files bytes of the same value.
      changed = whole;
      const std::size_t digit = changed.find_first_of("0123456789", random() % changed.size());
      if (digit != std::string::npos) changed.replace(digit, 1, round % 2 == 0 ? "-9999999" : "77");
      survive(name, changed);
      // A piece duplicated or removed.
      changed = whole;
      const std::size_t begin = random() % changed.size();
      const std::string piece = changed.substr(begin, 1 + random() % 200);
      changed.replace(begin, piece.size(), round % 2 == 0 ? piece + piece : "");
      survive(name, changed);
    }
    // Prints how the cases ended; no process may be left.
    std::ostringstream counts;
    for (const auto& [outcome, count] : outcomes_) counts << outcome << " " << count << "  ";
    RecordProperty(name, counts.str());
    std::cout << name << ": " << counts.str() << "\n";
    EXPECT_EQ(outcomes_["assimp-result"], 0u) << "the conversion lets nonsense through";
    EXPECT_EQ(waitpid(-1, nullptr, WNOHANG), -1) << "a process was left behind";
    outcomes_.clear();
  }

  Folder folder_;
  std::map<std::string, std::size_t> outcomes_;
};

TEST_F(DamagedScenes, Fbx) {
  damage("a.fbx", FbxSample().text());
}
TEST_F(DamagedScenes, Collada) {
  damage("a.dae", collada(MovingRig()));
}
TEST_F(DamagedScenes, SmdMesh) {
  damage("a.smd", smd(MovingRig(), true, false));
}
TEST_F(DamagedScenes, SmdMotion) {
  damage("a.smd", smd(MovingRig(), false, true));
}
TEST_F(DamagedScenes, Ms3d) {
  damage("a.ms3d", ms3d(MovingRig()));
}
TEST_F(DamagedScenes, Max3ds) {
  damage("a.3ds", max_3ds());
}
TEST_F(DamagedScenes, Ase) {
  damage("a.ase", ase());
}
TEST_F(DamagedScenes, Md5Mesh) {
  damage("a.md5mesh", md5mesh(MovingRig()));
}
TEST_F(DamagedScenes, Md5Motion) {
  damage("a.md5anim", md5anim(MovingRig()));
}

TEST_F(DamagedScenes, FilesOfTheCorpus) {
  const std::filesystem::path corpus = test::corpus_folder() + "/other/assimp";
  if (!std::filesystem::exists(corpus)) GTEST_SKIP() << "skipped: no corpus at " << corpus;
  for (const char* name : {"huesitos.fbx", "SimpleCube.md5mesh"}) {
    std::ifstream in(corpus / name, std::ios::binary);
    std::ostringstream text;
    text << in.rdbuf();
    damage(name, text.str());
  }
}

}  // namespace
}  // namespace krok
