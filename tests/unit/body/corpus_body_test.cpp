// Bodies around the skeletons of real captures: if this fails, someone's capture gives no body or a
// broken one.

#include <filesystem>
#include <set>
#include <string>

#include "core/file.h"
#include "formats/bvh/bvh_reader.h"
#include "unit/body/mesh_checks.h"

namespace krok {
namespace {

namespace fs = std::filesystem;

TEST(CorpusBody, EverySkeletonGetsAValidBody) {
  const fs::path root = fs::path(KROK_CORPUS_DIR) / "bvh";
  if (!fs::exists(root)) GTEST_SKIP() << "skipped: no corpus at " << root;
  std::set<fs::path> files;
  for (const auto& entry : fs::recursive_directory_iterator(root)) {
    if (entry.path().extension() == ".bvh") files.insert(entry.path());
  }
  std::set<std::string> seen;  // one body for each different skeleton
  int people = 0;
  for (const fs::path& path : files) {
    SCOPED_TRACE(path.filename().string());
    auto input = InputFile::open(path.string());
    ASSERT_TRUE(input.ok());
    auto capture = bvh::read(input->text(), path.filename().string(), {});
    ASSERT_TRUE(capture.ok()) << capture.error().message;
    const Skeleton& skeleton = capture->clip.skeleton;
    std::string signature;
    for (int j = 0; j < skeleton.joint_count(); ++j) {
      signature += skeleton.names[static_cast<std::size_t>(j)] + " ";
    }
    if (!seen.insert(signature).second) continue;
    const auto body = make_body(capture->clip, {.detail = BodyDetail::low});
    ASSERT_TRUE(body.ok()) << body.error().message;
    test::expect_valid_body(*body);
    if (body->human) {
      ++people;
      const double relative = body->volume / std::pow(body->stature / 1.75, 3);
      EXPECT_GT(relative, 0.045);
      EXPECT_LT(relative, 0.11);
    }
  }
  EXPECT_GT(people, 10);
}

}  // namespace
}  // namespace krok
