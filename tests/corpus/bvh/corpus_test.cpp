// Every BVH of the corpus against a second, independent forward kinematics: through the library and
// through krok-import and its .anim file. Would break: a wrong channel order, a wrong reading of
// position channels, an End Site lost, a frame shifted, a conversion where none was asked for.

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "core/file.h"
#include "corpus/bvh/corpus_files.h"
#include "corpus/bvh/naive_bvh.h"
#include "formats/anim/anim.h"
#include "formats/bvh/bvh_reader.h"
#include "formats/bvh/bvh_writer.h"
#include "support/this_build.h"

namespace krok {
namespace {

using test::kBvhFolder;
using test::text_of_file;

struct Listed {
  std::string path;
  bool additive = false;
};

// The corpus's list, with the reading of position channels that it found.
std::vector<Listed> listed_files() {
  std::ifstream index(test::corpus_folder() + "/INDEX.tsv");
  std::vector<Listed> files;
  std::string line;
  std::getline(index, line);
  while (std::getline(index, line)) {
    const std::string convention = line.substr(line.rfind('\t') + 1);
    files.push_back(
        {line.substr(0, line.find('\t')), convention.find("additive") != std::string::npos ||
                                              convention.find("delta") != std::string::npos});
  }
  return files;
}

class Corpus : public testing::Test {
 protected:
  void SetUp() override {
    if (!std::filesystem::exists(kBvhFolder))
      GTEST_SKIP() << "skipped: no corpus at " << kBvhFolder;
    files_ = listed_files();
    ASSERT_GT(files_.size(), 50u);
  }
  std::vector<Listed> files_;
};

// The largest extent of a file's first frame, or of its OFFSETs where there is none.
double size_of(const naive::Bvh& bvh) {
  const std::vector<double> zeros(1000, 0.0);
  const auto points =
      naive::world_positions(bvh, bvh.rows.empty() ? zeros : bvh.rows.front(), false);
  double size = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto less = [&](const naive::Point& a, const naive::Point& b) {
      return a[axis] < b[axis];
    };
    const auto [low, high] = std::minmax_element(points.begin(), points.end(), less);
    size = std::max(size, (*high)[axis] - (*low)[axis]);
  }
  return size;
}

void expect_same_motion(const naive::Bvh& expected, const Clip& clip, bool additive) {
  ASSERT_EQ(clip.joint_count(), static_cast<int>(expected.joints.size()));
  ASSERT_EQ(clip.frame_count(), static_cast<int>(expected.rows.size()));
  double largest = 0;
  for (int frame = 0; frame < clip.frame_count(); ++frame) {
    const auto points =
        naive::world_positions(expected, expected.rows[static_cast<std::size_t>(frame)], additive);
    const auto positions = clip.frame_positions(frame);
    for (std::size_t j = 0; j < points.size(); ++j) {
      const double dx = points[j][0] - positions[j].x();
      const double dy = points[j][1] - positions[j].y();
      const double dz = points[j][2] - positions[j].z();
      largest = std::max(largest, std::sqrt(dx * dx + dy * dy + dz * dz));
    }
  }
  EXPECT_LE(largest, 2e-5 * size_of(expected));
  for (std::size_t j = 0; j < expected.joints.size(); ++j) {
    EXPECT_EQ(clip.skeleton.parents[j], expected.joints[j].parent);
    EXPECT_EQ(clip.skeleton.end_sites[j] != 0, expected.joints[j].name.empty());
    if (!expected.joints[j].name.empty()) {
      EXPECT_EQ(clip.skeleton.names[j], expected.joints[j].name);
    }
  }
}

bvh::ReadOptions unconverted(bool additive) {
  bvh::ReadOptions options;
  options.unit = Unit{};
  options.up = Direction::plus_y;
  options.forward = Direction::plus_z;
  options.positions = additive ? bvh::Positions::additive : bvh::Positions::absolute;
  return options;
}

TEST_F(Corpus, LibraryAgreesWithIndependentKinematicsInBothReadings) {
  for (const Listed& file : files_) {
    SCOPED_TRACE(file.path);
    const std::string text = text_of_file(kBvhFolder + file.path);
    const naive::Bvh expected = naive::parse(text);
    for (const bool additive : {false, true}) {
      const auto capture = bvh::read(text, file.path, unconverted(additive));
      ASSERT_TRUE(capture.ok()) << capture.error().message;
      EXPECT_TRUE(check(capture->clip).ok());
      EXPECT_TRUE(capture->clip.provenance.conversions.empty());
      expect_same_motion(expected, capture->clip, additive);
    }
  }
}

TEST_F(Corpus, ImportedFilesAgreeWithIndependentKinematics) {
  const std::string out =
      testing::TempDir() + "krok_corpus_bvh_" + std::to_string(getpid()) + ".anim";
  for (const Listed& file : files_) {
    SCOPED_TRACE(file.path);
    const std::string path = kBvhFolder + file.path;
    const std::string command =
        test::tools_folder() + "/krok-import -q --unit m --up y " + "--forward z --positions " +
        (file.additive ? "additive" : "absolute") + " '" + path + "' -o '" + out + "'";
    ASSERT_EQ(std::system(command.c_str()), 0);
    const auto bytes = InputFile::open(out);
    ASSERT_TRUE(bytes.ok());
    const auto clip = anim::read(bytes->bytes());
    ASSERT_TRUE(clip.ok()) << clip.error().message;
    expect_same_motion(naive::parse(text_of_file(path)), *clip, file.additive);
  }
  std::filesystem::remove(out);
}

// Which files mean additive channels was decided by looking at where the feet stand.
TEST_F(Corpus, PositionChannelsAreReadAsTheExporterMeansThem) {
  const std::vector<std::string> additive = {
      "iclone_cmu/003_01",   "iclone_cmu/005_01", "iclone_cmu/006_", "walkset_cmu07/",
      "makehuman/benchmark", "makehuman/debug",   "makehuman/face",  "makehuman/walk1"};
  for (const Listed& file : files_) {
    SCOPED_TRACE(file.path);
    const auto capture = bvh::read(text_of_file(kBvhFolder + file.path), file.path);
    ASSERT_TRUE(capture.ok()) << capture.error().message;
    const bool expected =
        std::any_of(additive.begin(), additive.end(),
                    [&](const std::string& start) { return file.path.starts_with(start); });
    EXPECT_EQ(capture->positions.choice, expected ? "additive" : "absolute");
    EXPECT_NE(capture->positions.confidence, Confidence::guess);
  }
}

// The three of iPi's files whose Frames: is one too many, and no other.
TEST_F(Corpus, StrictRefusesJustTheFilesWithFaults) {
  std::vector<std::string> refused;
  for (const Listed& file : files_) {
    bvh::ReadOptions options;
    options.strictness = Strictness::strict;
    const auto capture = bvh::read(text_of_file(kBvhFolder + file.path), file.path, options);
    if (capture.ok()) continue;
    refused.push_back(file.path);
    EXPECT_EQ(capture.error().code, "bvh-frame-count") << file.path;
  }
  EXPECT_EQ(refused, (std::vector<std::string>{"ipi_smartbody/SwatLeft.bvh",
                                               "ipi_smartbody/SwatUp_Center2.bvh",
                                               "ipi_smartbody/Up_Center.bvh"}));
}

TEST_F(Corpus, FramesInFrontOfCmuConversionsAreFoundAsRestPoses) {
  for (const char* name : {"assimp_testmodels/01_01.bvh", "pybvh/cmu_12_01_walk.bvh",
                           "walkset_cmu07/007_05.bvh", "makehuman/12_03.bvh"}) {
    const auto capture = bvh::read(text_of_file(kBvhFolder + name), name);
    ASSERT_TRUE(capture.ok());
    EXPECT_TRUE(capture->rest_frame_found) << name;
  }
  for (const char* name : {"ipi_smartbody/Center.bvh", "pymo/AV_8Walk_Meredith_HVHA_Rep1.bvh",
                           "walkset_cmu07/007_02.bvh", "deep-motion-editing/demo_3d_1_raw.bvh"}) {
    const auto capture = bvh::read(text_of_file(kBvhFolder + name), name);
    ASSERT_TRUE(capture.ok());
    EXPECT_FALSE(capture->rest_frame_found) << name;
  }
}

// Read, write, read: the same joints, and the same motion within what is printed.
TEST_F(Corpus, WrittenFilesReadBackAsTheSameMotion) {
  const std::string out =
      testing::TempDir() + "krok_corpus_written_" + std::to_string(getpid()) + ".bvh";
  for (const Listed& file : files_) {
    SCOPED_TRACE(file.path);
    const auto first = bvh::read(text_of_file(kBvhFolder + file.path), file.path);
    ASSERT_TRUE(first.ok());
    auto output = OutputFile::create(out);
    ASSERT_TRUE(output.ok());
    ASSERT_TRUE(bvh::write(first->clip, {}, *output).ok());
    ASSERT_TRUE(output->commit().ok());
    bvh::ReadOptions options = unconverted(false);
    options.unit = Unit{0.01, "cm"};
    options.strictness = Strictness::strict;
    const auto second = bvh::read(text_of_file(out), out, options);
    ASSERT_TRUE(second.ok()) << second.error().message;
    const Clip& a = first->clip;
    const Clip& b = second->clip;
    ASSERT_EQ(difference_in_structure(a.skeleton, b.skeleton), "");
    EXPECT_EQ(a.skeleton.end_sites, b.skeleton.end_sites);
    ASSERT_EQ(a.frame_count(), b.frame_count());
    EXPECT_DOUBLE_EQ(a.rate, b.rate);
    const double size = reference_extent(a.skeleton);
    double reach = size;
    for (const Vec3f& p : a.positions) {
      reach = std::max(reach, static_cast<double>(p.cwiseAbs().maxCoeff()));
    }
    double largest = 0;
    double turned = 0;
    for (std::size_t i = 0; i < a.positions.size(); ++i) {
      largest = std::max(largest, static_cast<double>((a.positions[i] - b.positions[i]).norm()));
      turned = std::max(turned,
                        static_cast<double>(a.orientations[i].angularDistance(b.orientations[i])));
    }
    // Floats far from the origin are coarser than the digits that are printed, and translations
    // that vary by less than the writer's tolerance are left out.
    EXPECT_LE(largest, 1e-5 * reach);
    EXPECT_LE(turned, 2e-3);
  }
  std::filesystem::remove(out);
}

}  // namespace
}  // namespace krok
