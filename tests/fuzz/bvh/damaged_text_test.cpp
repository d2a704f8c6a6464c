// If these fail, a damaged or malicious BVH file crashes or hangs a program or exhausts memory. Run
// with the address and undefined-behaviour sanitizers.

#include <chrono>
#include <memory>
#include <random>

#include "unit/bvh/bvh_text.h"

namespace krok::bvh {
namespace {

const std::string kSmall =
    "HIERARCHY\r\nROOT Hip Bone\r\n{\r\n\tOFFSET 0 1.5e1 0\r\n"
    "\tCHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation\r\n"
    "\tJOINT L\xC3\xA9g {\r\n\t\tOFFSET 1 -2 .5\r\n\t\tCHANNELS 2 Xrotation Yrotation\r\n"
    "\t\tEnd Site\r\n\t\t{\r\n\t\t\tOFFSET 0 -3 0\r\n\t\t}\r\n\t}\r\n}\r\n"
    "MOTION\r\nFrames:\t3\r\nFrame Time: 0.0333333\r\n"
    "0 15 0 1 2 3 4 5\r\n1 16 -1 2 3 4 5 6\r\n2 15 0 3.5 4 5e0 6 7\r\n";

// Reads with each strictness. A value must pass check(), an Error must have a code, a message and
// the file.
void read_and_check(const std::string& text) {
  // An exact-size copy, so that the sanitizer detects reads past the end.
  const std::unique_ptr<char[]> copy(new char[text.size()]);
  std::copy(text.begin(), text.end(), copy.get());
  const std::string_view view(copy.get(), text.size());
  for (const Strictness strictness : {Strictness::normal, Strictness::strict, Strictness::repair}) {
    for (const Positions positions : {Positions::automatic, Positions::additive}) {
      ReadOptions options;
      options.strictness = strictness;
      options.positions = positions;
      options.jobs = 1;
      const auto capture = read(view, "damaged.bvh", options);
      if (capture.ok()) {
        const Status status = check(capture->clip);
        ASSERT_TRUE(status.ok()) << status.error().message << "\n" << text;
      } else {
        ASSERT_FALSE(capture.error().code.empty());
        ASSERT_FALSE(capture.error().message.empty());
        ASSERT_EQ(capture.error().where.file, "damaged.bvh");
      }
    }
  }
}

TEST(DamagedBvh, TruncatedAtEveryByte) {
  read_and_check(kSmall);
  for (std::size_t size = 0; size < kSmall.size(); ++size) read_and_check(kSmall.substr(0, size));
}

TEST(DamagedBvh, ATruncationNeverPassesSilently) {
  const auto whole = read(kSmall, "whole.bvh");
  ASSERT_TRUE(whole.ok());
  ASSERT_EQ(whole->clip.frame_count(), 3);
  // The file is still complete without its final line ending.
  for (std::size_t size = 0; size + 2 < kSmall.size(); ++size) {
    const auto capture = read(kSmall.substr(0, size), "cut.bvh");
    if (!capture.ok()) continue;
    bool warned = false;
    for (const Diagnostic& told : capture->diagnostics) {
      warned = warned || (told.severity == Severity::warning &&
                          (told.code == "bvh-frame-count" || told.code == "bvh-channel-count" ||
                           told.code == "bvh-no-motion"));
    }
    EXPECT_TRUE(warned) << size;
    EXPECT_LT(capture->clip.frame_count(), 3) << size;
    // The remaining frames are those of the file.
    for (std::size_t i = 0; i < capture->clip.positions.size(); ++i) {
      ASSERT_LT((capture->clip.positions[i] / capture->conventions.unit.metres -
                 whole->clip.positions[i] / whole->conventions.unit.metres)
                    .norm(),
                1e-3)
          << size;
    }
  }
}

TEST(DamagedBvh, EveryByteChanged) {
  std::string text = kSmall;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char was = text[i];
    for (const char now :
         {'\0', '\n', '\r', ' ', '{', '}', '-', '.', '9', 'e', 'N', '\x7F', '\xFF'}) {
      text[i] = now;
      read_and_check(text);
    }
    text[i] = was;
  }
}

TEST(DamagedBvh, BytesTakenOutPutInAndRepeated) {
  std::mt19937 random(7);
  const auto below = [&](std::size_t count) {
    return std::uniform_int_distribution<std::size_t>(0, count - 1)(random);
  };
  for (int i = 0; i < 2000; ++i) {
    std::string text = kSmall;
    for (std::size_t edits = 1 + below(4); edits > 0; --edits) {
      const std::size_t at = below(text.size());
      const std::size_t length = std::min(text.size() - at, 1 + below(20));
      if (below(2) == 0) {
        text.erase(at, length);
      } else {
        text.insert(below(text.size()), text.substr(at, length));
      }
      if (text.empty()) text = "H";
    }
    read_and_check(text);
  }
}

// A file with unusual but accepted syntax: text before and between sections, commas, a second
// motion.
const std::string kOdd =
    "made by hand\nHIERARCHY\n# one\nROOT a\n{\nOFFSET 0 1 0\nCHANNELS 3 Xrotation, Xrotation,"
    " Xscale\nEndSite\n{\nOFFSET 0 1 0\nCHANNELS 1 Yrotation\n}\n}\nMOTION\nFrames: 3.0 in all\n"
    "Frame Time: 0,04 s\nFrame Rate: 25\n0,5 1\n2 1\n# two\n1 2 3 4\n5\n6 7 8\nMOTION\nFrames: 1\n";

TEST(DamagedBvh, OddTextsCutAndChangedAtEveryByte) {
  for (std::size_t size = 0; size <= kOdd.size(); ++size) read_and_check(kOdd.substr(0, size));
  std::string text = kOdd;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char was = text[i];
    for (const char now : {'\0', '\n', ' ', '{', '}', ',', '#', '9', '\xFF'}) {
      text[i] = now;
      read_and_check(text);
    }
    text[i] = was;
  }
}

// Texts of a few hundred kilobytes that would exhaust time or memory if a loop over the text were
// nested in another.
TEST(DamagedBvh, TextsMadeToBeSlowAreNot) {
  const auto repeated = [](const std::string& part, int count) {
    std::string text;
    for (int i = 0; i < count; ++i) text += part;
    return text;
  };
  const std::string head =
      "HIERARCHY\nROOT a\n{\nOFFSET 0 0 0\nCHANNELS 2 Xrotation Yrotation\n}\n";
  const std::vector<std::string> texts = {
      "HIERARCHY\n" + repeated("ROOT a\n{\n}\n", 30000) + motion(1, "1\n"),
      "HIERARCHY\nROOT a\n{\n" + repeated("End Site\n{\n}\n", 30000) + "}\n" + motion(1, "1\n"),
      "HIERARCHY\nROOT a\n{\n" + repeated("JOINT \xFF\n{\n", 30000) + repeated("}\n", 30001) +
          motion(1, "1\n"),
      "HIERARCHY\nROOT a\n{\nCHANNELS 100000 " + repeated("foo ", 100000) + "}\n" +
          motion(1, "1\n"),
      head + motion(100000, "1 2\n" + repeated("1\n", 100000)),
      head + motion(100000, "1 2\n" + repeated("nan 1\n", 100000) + "1 2\n"),
      head + motion(100000, repeated("nan\n", 100000)),
      head + motion(1000000, repeated("\n", 300000) + repeated("1 ", 100000)),
      head + "MOTION\nFrames: 1\nFrame Time: 1\n" + repeated("x\n", 100000) + "1 2\n",
      head + motion(2, "1 2\n" + repeated("# x\n", 100000) + "1 2\n"),
      head + motion(100000, repeated("1\n2 x\n", 100000)),
      head + motion(100000, repeated("0,5 1\n", 100000)),
      "HIERARCHY\nROOT a\n{\nCHANNELS 30000 " + repeated("Xrotation ", 30000) + "}\n" +
          motion(1, "1\n"),
      repeated("# x\n", 15000) + "HIERARCHY\n" + repeated("# x\n", 50000),
      "HIERARCHY\nROOT a\n{\n" + repeated("// x\n", 50000) + "}\n" + motion(1, "1\n"),
      "HIERARCHY\n" + repeated("{", 300000),
      std::string(300000, ' ') + "HIERARCHY",
  };
  for (const std::string& text : texts) {
    const auto begin = std::chrono::steady_clock::now();
    read_and_check(text);
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begin;
    EXPECT_LT(took.count(), 20.0) << text.substr(0, 80);
  }
}

}  // namespace
}  // namespace krok::bvh
