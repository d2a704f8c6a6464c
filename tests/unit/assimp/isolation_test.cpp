// If these fail, a file that makes Assimp crash, hang or eat memory takes the program with it, or
// is reported in a way that does not tell what happened.

#include <gtest/gtest.h>
#include <sys/wait.h>

#include <atomic>
#include <thread>

#include "formats/assimp/scene_transfer.h"
#include "support/this_build.h"
#include "unit/assimp/reading.h"
#include "unit/assimp/sample_files.h"

namespace krok {
namespace {

using test::sanitized;

using namespace test;

TEST(Isolation, AFileThatCrashesAssimpIsAnError) {
  // CVE-2025-2757: Assimp 5.2 copies a name into 1024 bytes, however long it is.
  std::string text = md5mesh(MovingRig());
  text.replace(text.find("\"Hips\""), 6, "\"" + std::string(4 << 20, 'A') + "\"");
  const Folder folder;
  const std::string path = folder.add("evil.md5mesh", text);
  const auto scene = assimp::read_file(path);
  ASSERT_FALSE(scene.ok());
  EXPECT_EQ(scene.error().code, "assimp-crash");
  EXPECT_EQ(scene.error().where.file, path);
  EXPECT_NE(scene.error().message.find("crashed"), std::string::npos);
  EXPECT_FALSE(scene.error().hint.empty());
  EXPECT_EQ(waitpid(-1, nullptr, WNOHANG), -1) << "a process was left behind";
  // And the next file is read as if nothing had been.
  EXPECT_TRUE(assimp::read_file(folder.add("good.md5mesh", md5mesh(MovingRig()))).ok());
}

TEST(Isolation, TimeIsLimited) {
  const Folder folder;
  assimp::ReadOptions options;
  options.most_seconds = options.seconds_per_mebibyte = 0;
  const auto scene = assimp::read_file(folder.add("body.fbx", FbxSample().text()), options);
  ASSERT_FALSE(scene.ok());
  EXPECT_EQ(scene.error().code, "assimp-time");
}

TEST(Isolation, MemoryIsLimited) {
  if (sanitized()) GTEST_SKIP() << "skipped: sanitizers reserve more address space than any limit";
  // SMD: the number of a bone decides how many there are.
  const Folder folder;
  const std::string path = folder.add(
      "evil.smd", "version 1\nnodes\n0 \"a\" -1\n99999999 \"b\" 0\nend\nskeleton\ntime 0\nend\n");
  const auto scene = assimp::read_file(path);
  ASSERT_FALSE(scene.ok());
  EXPECT_EQ(scene.error().code, "assimp-memory");
  EXPECT_NE(scene.error().message.find("256 MiB"), std::string::npos);
}

TEST(Isolation, WhatAssimpRefusesIsToldInItsWords) {
  const Folder folder;
  const auto scene =
      assimp::read_file(folder.add("bad.fbx", "; FBX 7.4.0 project file\nObjects: {"));
  ASSERT_FALSE(scene.ok());
  EXPECT_EQ(scene.error().code, "assimp-refused");
  EXPECT_NE(scene.error().message.find("Assimp reports: "), std::string::npos);
}

TEST(Isolation, WhatAssimpWouldSearchForEverIsRefusedAtOnce) {
  const Folder folder;
  const std::string text = smd(MovingRig(), false, true);
  const auto scene = assimp::read_file(folder.add("cut.smd", text.substr(0, text.find("end") - 1)));
  ASSERT_FALSE(scene.ok());
  EXPECT_EQ(scene.error().code, "assimp-refused");
  EXPECT_NE(scene.error().message.find("nodes"), std::string::npos) << scene.error().message;
}

TEST(Isolation, OtherFilesAreNotGivenToAssimp) {
  const Folder folder;
  for (const char* name : {"a.obj", "a.png", "a.bvh"}) {
    const auto scene = assimp::read_file(folder.add(name, "solid nothing\n"));
    ASSERT_FALSE(scene.ok());
    EXPECT_EQ(scene.error().code, "assimp-kind");
  }
  EXPECT_EQ(assimp::read_file(folder.add("deep/a.fbx", "") + "x").error().code, "file-missing");
  EXPECT_FALSE(assimp::read_file(folder.add("empty.fbx", "")).ok());
}

TEST(Isolation, ContentDecidesWhateverTheName) {
  const Folder folder;
  EXPECT_EQ(read_or_fail(folder.add("body.fbx", ms3d(MovingRig()))).meshes.size(), 1u);
  EXPECT_EQ(read_or_fail(folder.add("body", FbxSample().text())).meshes.size(), 1u);
}

TEST(Isolation, SeveralThreadsReadAtOnce) {
  const Folder folder;
  const std::string good = folder.add("body.dae", collada(MovingRig()));
  const std::string bad = folder.add("bad.dae", "<COLLADA><library_geometries>");
  const assimp::ReadOptions patient = {.most_seconds = 200};
  std::atomic<int> right{0};
  std::vector<std::thread> threads;
  // One thread under a sanitizer: the locks of its allocator, unlike glibc's, are not freed in a
  // child that was forked while another thread held one, and the child would wait for ever.
  for (int t = 0; t < (sanitized() ? 1 : 6); ++t) {
    threads.emplace_back([&] {
      for (int i = 0; i < 5; ++i) {
        if (assimp::read_file(good, patient).ok()) ++right;
        if (!assimp::read_file(bad, patient).ok()) ++right;
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(right.load(), 10 * static_cast<int>(threads.size()));
}

TEST(Isolation, TheSameFileGivesTheSameScene) {
  const Folder folder;
  const std::string path = folder.add("body.fbx", FbxSample().text());
  EXPECT_TRUE(assimp::pack(read_or_fail(path)) == assimp::pack(read_or_fail(path)));
}

// ---- What comes back from the child ----

std::vector<std::byte> packed_sample() {
  const Folder folder;
  return assimp::pack(read_or_fail(folder.add("body.fbx", FbxSample().text())));
}

TEST(Transfer, AScenePackedAndUnpackedIsTheSame) {
  const auto bytes = packed_sample();
  const auto scene = assimp::unpack(bytes);
  ASSERT_TRUE(scene.ok()) << scene.error().message;
  EXPECT_TRUE(assimp::pack(*scene) == bytes);
  EXPECT_FALSE(scene->nodes.empty());
  EXPECT_FALSE(scene->meshes[0].primitives[0].targets.empty());
}

TEST(Transfer, EveryTruncationIsAnError) {
  const auto bytes = packed_sample();
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    const auto scene = assimp::unpack(std::span(bytes).first(size));
    ASSERT_FALSE(scene.ok()) << size;
    EXPECT_EQ(scene.error().code, "assimp-result");
  }
}

TEST(Transfer, ChangedBytesNeverBreakWhatASceneIs) {
  const auto bytes = packed_sample();
  std::size_t survived = 0;
  for (std::size_t i = 0; i < bytes.size(); i += sanitized() ? 7 : 1) {
    for (const int value : {0x00, 0x01, 0x7F, 0xFF}) {
      auto changed = bytes;
      changed[i] = static_cast<std::byte>(value);
      const auto scene = assimp::unpack(changed);
      if (!scene) continue;
      ++survived;
      // Whatever was let through can be shown.
      if (const auto evaluator = nodes::Evaluator::create(*scene); evaluator) {
        nodes::Evaluation state;
        for (int a = -1; a < static_cast<int>(scene->animations.size()); ++a) {
          evaluator->evaluate(a, 0.3, state);
        }
      }
    }
  }
  EXPECT_GT(survived, 0u);
}

}  // namespace
}  // namespace krok
