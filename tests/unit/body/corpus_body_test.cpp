// Bodies around the skeletons of real captures: if this fails, someone's capture gives no body or a
// broken one.

#include <filesystem>
#include <set>
#include <sstream>
#include <string>
#include <string_view>

#include "core/file.h"
#include "formats/bvh/bvh_reader.h"
#include "support/this_build.h"
#include "unit/body/mesh_checks.h"

namespace krok {
namespace {

namespace fs = std::filesystem;

// The names in the hierarchy of a BVH file, without reading it whole.
std::string joint_names(std::string_view text) {
  text = text.substr(0, text.find("MOTION"));
  std::istringstream words{std::string(text)};
  std::string names, word;
  while (words >> word) {
    if (word != "ROOT" && word != "JOINT") continue;
    std::getline(words, word);
    names += word + "\n";
  }
  return names;
}

// A body takes ten times as long under a sanitizer, so there every fifth skeleton has to do.
const std::size_t kEvery = test::sanitized() ? 5 : 1;

TEST(CorpusBody, EverySkeletonGetsAValidBody) {
  const fs::path root = fs::path(test::corpus_folder()) / "bvh";
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
    if (!seen.insert(joint_names(input->text())).second) continue;
    if (seen.size() % kEvery != 0) continue;
    auto capture = bvh::read(input->text(), path.filename().string(), {});
    ASSERT_TRUE(capture.ok()) << capture.error().message;
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
  EXPECT_GT(people, kEvery == 1 ? 20 : 0);
}

}  // namespace
}  // namespace krok
