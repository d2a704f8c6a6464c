// Would fail if the table of world positions had another header, order or number of rows, lost
// digits, or broke on a name with a comma.

#include "formats/csv/csv_writer.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <limits>

#include "core/numbers.h"
#include "formats/csv/table.h"
#include "support/test_scenes.h"

namespace krok {
namespace {

std::string written(const Clip& clip) {
  const std::string path = testing::TempDir() + "krok_csv_" + std::to_string(getpid());
  {
    auto file = OutputFile::create(path);
    EXPECT_TRUE(file.ok());
    EXPECT_TRUE(csv::write(frames_of(clip), *file).ok());
    EXPECT_TRUE(file->commit().ok());
  }
  const auto input = InputFile::open(path);
  EXPECT_TRUE(input.ok());
  std::string text(input->text());
  std::filesystem::remove(path);
  return text;
}

Clip two_joints() {
  Clip clip;
  const int root = clip.skeleton.add("hips", Skeleton::kNoParent, {});
  clip.skeleton.add("arm, \"left\"", root, {});
  clip.rate = 30;
  clip.resize(2);
  for (Quatf& orientation : clip.orientations) orientation = Quatf::Identity();
  clip.positions = {{0, 1, -2.5f}, {0.1f, -0.0f, 1e-7f}, {5e8f, 16777216, 3}, {1, 2, 3}};
  return clip;
}

TEST(CsvWriter, WritesARowForEachFrameAndJoint) {
  EXPECT_EQ(written(two_joints()),
            "frame,time,joint,x,y,z\n"
            "0,0,hips,0,1,-2.5\n"
            "0,0,\"arm, \"\"left\"\"\",0.1,0,1e-07\n"
            "1,0.03333333333333333,hips,500000000,16777216,3\n"
            "1,0.03333333333333333,\"arm, \"\"left\"\"\",1,2,3\n");
}

// If this failed, a spreadsheet would run a stranger's joint name, a terminal would obey it, or a
// table would no longer find the name that it was written under.
TEST(CsvWriter, NamesAreNoFormulasAndReadBack) {
  Clip clip = two_joints();
  const std::vector<std::string> names = {
      "=cmd|' /C calc'!A0", "@sum(1)", "+1,2", "-x", "'=y", "it's", "'a"};
  for (const std::string& name : names) {
    clip.skeleton.names[1] = name;
    const std::string text = written(clip);
    for (const char* raw : {",=", ",@", ",+", ",\"=", ",\"+", ",-x"}) {
      EXPECT_EQ(text.find(raw), std::string::npos) << text;
    }
    const auto table = csv::Table::read(text, "walk.csv");
    ASSERT_TRUE(table.ok());
    EXPECT_EQ(table->texts(2)[1], name) << text;
  }
  clip.skeleton.names[1] = "a\x1b[31m\xc2\x9b";
  EXPECT_NE(written(clip).find(",a?[31m?,"), std::string::npos);
}

TEST(CsvWriter, NumbersReadBackTheSame) {
  const Clip clip = test::swinging_clip(test::human_skeleton(), 50, 120 / 1.001);
  const std::string text = written(clip);
  std::size_t at = text.find('\n') + 1;
  for (int f = 0; f < clip.frame_count(); ++f) {
    for (int j = 0; j < clip.joint_count(); ++j) {
      std::vector<std::string> fields;
      const std::size_t end = text.find('\n', at);
      for (std::size_t from = at; from <= end;) {
        const std::size_t comma = std::min(text.find(',', from), end);
        fields.push_back(text.substr(from, comma - from));
        from = comma + 1;
      }
      at = end + 1;
      ASSERT_EQ(fields.size(), 6u);
      EXPECT_EQ(fields[0], std::to_string(f));
      EXPECT_EQ(parse_finite(fields[1]), f / clip.rate);
      EXPECT_EQ(fields[2], clip.skeleton.names[j]);
      for (int i = 0; i < 3; ++i) {
        EXPECT_EQ(static_cast<float>(parse_finite(fields[3 + i]).value()),
                  clip.frame_positions(f)[j][i]);
      }
    }
  }
  EXPECT_EQ(at, text.size());
}

TEST(CsvWriter, AClipWithoutFramesGivesTheHeader) {
  Clip clip = two_joints();
  clip.resize(0);
  EXPECT_EQ(written(clip), "frame,time,joint,x,y,z\n");
}

TEST(CsvWriter, RefusesWhatIsNotFinite) {
  Clip clip = two_joints();
  clip.positions[2].x() = std::numeric_limits<float>::quiet_NaN();
  auto file = OutputFile::create(testing::TempDir() + "krok_csv_nan_" + std::to_string(getpid()));
  ASSERT_TRUE(file.ok());
  const Status status = csv::write(frames_of(clip), *file);
  ASSERT_FALSE(status.ok());
  EXPECT_EQ(status.error().code, "clip-value");
}

}  // namespace
}  // namespace krok
