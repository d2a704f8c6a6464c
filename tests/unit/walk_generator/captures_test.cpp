// If these fail, samples/captures is not what the generator makes, or its contacts files do not say
// what happens in the captures beside them.

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "core/numbers.h"
#include "formats/bvh/bvh_reader.h"
#include "measure.h"
#include "support/this_build.h"

namespace krok::samples {
namespace {

namespace fs = std::filesystem;

const fs::path kCaptures = fs::path(krok::test::source_folder()) / "samples/captures";
const char* const kNames[] = {"walk", "stairs", "turn"};

std::string text_of(const fs::path& path) {
  std::ifstream file(path);
  return {std::istreambuf_iterator<char>(file), {}};
}

class Captures : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / ("krok_captures_" + std::to_string(::getpid()));
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  void make_anew(const std::string& sub_folder) {
    const std::string command =
        "MAKE_WALK='" + krok::test::make_walk() + "' '" + (kCaptures / "make.sh").string() + "' '" +
        (folder_ / sub_folder).string() + "' 2> '" + (folder_ / "log.txt").string() + "'";
    const int status = std::system(command.c_str());
    ASSERT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0) << text_of(folder_ / "log.txt");
  }

  fs::path folder_;
};

// The same words, and numbers that differ by no more than `tolerance`.
void expect_same_numbers(const std::string& made, const std::string& kept, double tolerance) {
  std::istringstream made_words(made), kept_words(kept);
  std::string a, b;
  long long count = 0;
  while (kept_words >> b) {
    ASSERT_TRUE(made_words >> a) << "shorter, after " << count << " words";
    ++count;
    if (a == b) continue;
    const auto bare = [](std::string word) {
      while (!word.empty() && word.back() == ',') word.pop_back();
      return parse_finite(word);
    };
    const auto x = bare(a), y = bare(b);
    ASSERT_TRUE(x && y) << "word " << count << ": " << a << " instead of " << b;
    ASSERT_NEAR(*x, *y, tolerance) << "word " << count;
  }
  EXPECT_FALSE(made_words >> a) << "longer";
  EXPECT_GT(count, 100);
}

TEST_F(Captures, AreWhatTheGeneratorMakes) {
  ASSERT_NO_FATAL_FAILURE(make_anew("once"));
  for (const std::string name : kNames) {
    // A digit of the last decimal: machines may differ in the last bit of a sine.
    expect_same_numbers(text_of(folder_ / "once" / (name + ".bvh")),
                        text_of(kCaptures / (name + ".bvh")), 1.01e-4);
    expect_same_numbers(text_of(folder_ / "once" / (name + ".contacts.json")),
                        text_of(kCaptures / (name + ".contacts.json")), 1.01e-6);
  }
}

TEST_F(Captures, AreMadeTheSameTwice) {
  ASSERT_NO_FATAL_FAILURE(make_anew("once"));
  ASSERT_NO_FATAL_FAILURE(make_anew("again"));
  for (const std::string name : kNames) {
    for (const std::string kind : {".bvh", ".contacts.json"}) {
      EXPECT_EQ(text_of(folder_ / "once" / (name + kind)),
                text_of(folder_ / "again" / (name + kind)));
    }
  }
}

TEST_F(Captures, AreSmall) {
  for (const std::string name : kNames) {
    EXPECT_LT(fs::file_size(kCaptures / (name + ".bvh")), 700'000u) << name;
  }
}

Vec3 vector(const nlohmann::json& json) {
  return Vec3(json.at(0).get<double>(), json.at(1).get<double>(), json.at(2).get<double>());
}

// The capture and its contacts file as a user has them: two files and nothing else.
class Capture : public testing::TestWithParam<const char*> {
 protected:
  void SetUp() override {
    const std::string name = GetParam();
    Result<bvh::Capture> read = bvh::read(text_of(kCaptures / (name + ".bvh")), name + ".bvh");
    ASSERT_TRUE(read.ok()) << read.error().message;
    clip_ = std::move(read->clip);
    truth_ = nlohmann::json::parse(text_of(kCaptures / (name + ".contacts.json")));
  }
  std::vector<Vec3> contact_point(const std::string& side, const std::string& kind) const {
    const auto& point = truth_.at("contact_points").at(side).at(kind);
    return test::track(clip_, point.at("joint").get<std::string>(), vector(point.at("offset")));
  }
  Clip clip_;
  nlohmann::json truth_;
};

INSTANTIATE_TEST_SUITE_P(Committed, Capture, testing::ValuesIn(kNames),
                         [](const auto& kind) { return std::string(kind.param); });

TEST_P(Capture, FramesAgree) {
  EXPECT_EQ(clip_.frame_count(), truth_.at("frames").get<int>());
  EXPECT_EQ(clip_.rate, truth_.at("rate").get<double>());
  EXPECT_EQ(clip_.joint_count(), 29);
}

TEST_P(Capture, ContactPointsStandWhereAndWhenTheFileSays) {
  int contacts = 0;
  for (const std::string side : {"left", "right"}) {
    for (const std::string kind : {"heel", "toe"}) {
      const std::vector<Vec3> places = contact_point(side, kind);
      for (const auto& contact : truth_.at("contacts").at(side).at(kind)) {
        ++contacts;
        const int from = contact.at("from_frame").get<int>();
        const int to = contact.at("to_frame").get<int>();
        for (int frame = from; frame <= to; ++frame) {
          const Vec3& place = places.at(static_cast<std::size_t>(frame));
          EXPECT_LT((place - vector(contact.at("place"))).norm(), 1e-4) << side << kind << frame;
          if (frame == from) continue;
          const Vec3 moved = place - places.at(static_cast<std::size_t>(frame - 1));
          EXPECT_LT(moved.norm() * clip_.rate, 2e-3) << "metres a second, frame " << frame;
        }
        // And just outside it moves, or the contact would be longer than it says.
        if (!contact.at("open_end").get<bool>() && to + 8 < clip_.frame_count()) {
          const auto later = static_cast<std::size_t>(to + 8);
          EXPECT_GT((places.at(later) - vector(contact.at("place"))).norm(), 1e-3) << side << kind;
        }
      }
    }
  }
  EXPECT_GE(contacts, 12);
}

TEST_P(Capture, StepLengthsMeasuredFromHeelContacts) {
  // In the order of their beginning, over both feet.
  std::vector<std::pair<double, Vec3>> strikes;
  for (const std::string side : {"left", "right"}) {
    const std::vector<Vec3> places = contact_point(side, "heel");
    for (const auto& contact : truth_.at("contacts").at(side).at("heel")) {
      if (contact.at("open_start").get<bool>()) continue;
      const int middle =
          (contact.at("from_frame").get<int>() + contact.at("to_frame").get<int>()) / 2;
      strikes.emplace_back(contact.at("from").get<double>(),
                           places.at(static_cast<std::size_t>(middle)));
    }
  }
  std::sort(strikes.begin(), strikes.end(),
            [](const auto& a, const auto& b) { return a.first < b.first; });
  const auto& asked = truth_.at("parameters");
  const double turn = asked.at("turn").get<double>() * kRadiansPerDegree;
  const double width = asked.at("step_width").get<double>();
  // Of a closing step beside the other foot nothing is asked.
  const std::size_t last = strikes.size() - (asked.at("from_standing").get<bool>() ? 1 : 0);
  ASSERT_GE(last, 4u);
  for (std::size_t i = 1; i < last; ++i) {
    const Vec3 step = strikes[i].second - strikes[i - 1].second;
    EXPECT_NEAR(step.y(), asked.at("rise").get<double>(), 1e-3);
    if (turn != 0) continue;
    EXPECT_NEAR(step.z(), asked.at("step_length").get<double>(), 1e-3);
    EXPECT_NEAR(std::abs(step.x()), width, 1e-3);
  }
  // In a turn each step is the one before, turned: every other one, for left and right.
  for (std::size_t i = 3; i < last; ++i) {
    const Vec3 before = strikes[i - 2].second - strikes[i - 3].second;
    const Vec3 step = strikes[i].second - strikes[i - 1].second;
    const Quat turned(Eigen::AngleAxisd(2 * turn, Vec3::UnitY()));
    EXPECT_LT((step - turned * before).norm(), 1e-3);
  }
}

TEST_P(Capture, KneesNeverBendBackward) {
  for (const Side side : {Side::left, Side::right}) {
    EXPECT_EQ(test::leg_angles(clip_, side).hyperextension, 0);
  }
}

}  // namespace
}  // namespace krok::samples
