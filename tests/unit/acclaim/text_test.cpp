// If these fail, a file that is written in another manner is refused or misread, or an oddity in it
// goes by without a word.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "unit/acclaim/reading.h"
#include "unit/acclaim/small_files.h"

namespace krok::acclaim::test {
namespace {

using small_files::kAmc;
using small_files::kAsf;
using small_files::with;

TEST(AcclaimReader, takes_any_line_ends_case_of_names_and_comments) {
  const auto expected = read(kAsf, kAmc);
  for (const std::string& line_end : {std::string("\r\n"), std::string("\r")}) {
    std::string asf = kAsf, amc = kAmc;
    for (std::string* text : {&asf, &amc}) {
      for (std::size_t i = 0; (i = text->find('\n', i)) != std::string::npos;
           i += line_end.size()) {
        text->replace(i, 1, line_end);
      }
    }
    const auto capture = read("\xEF\xBB\xBF" + asf, amc);
    ASSERT_TRUE(capture.ok()) << capture.error().message;
    EXPECT_TRUE(capture->clip.positions == expected->clip.positions);
    const auto error = read(asf, with(amc, "shin 90", "shin 9x"));
    ASSERT_FALSE(error.ok());
    EXPECT_EQ(error.error().where.line, 12);
  }
  const auto upper = read(kAsf, with(kAmc, "thigh 0 90", "\tTHIGH  0 +9.0e1  # knee"));
  ASSERT_TRUE(upper.ok()) << upper.error().message;
  EXPECT_TRUE(upper->clip.positions == expected->clip.positions);
}

TEST(AcclaimReader, names_stay_unique_and_become_utf8) {
  std::string asf = with(kAsf, "name tip", "name shin_end");
  asf = with(asf, "tail tip", "tail shin_end");
  auto capture = read(asf, kAmc);
  ASSERT_TRUE(capture.ok());
  EXPECT_THAT(capture->clip.skeleton.names,
              testing::ElementsAre("root", "thigh", "shin", "shin_end_2", "tail", "shin_end",
                                   "shin_end_end"));
  asf = with(with(kAsf, "name tip", "name t\xEFp"), "tail tip", "tail t\xEFp");
  capture = read(asf, kAmc);
  ASSERT_TRUE(capture.ok());
  EXPECT_GE(capture->clip.skeleton.find("t\xC3\xAFp"), 0);
  EXPECT_TRUE(told(*capture, "acclaim-name", "UTF-8")) << all(*capture);
}

TEST(AcclaimReader, control_characters_in_names_are_replaced) {
  for (const char c : {'\0', '\x1B', '\x7F'}) {
    const std::string odd = std::string("sh") + c + "in";
    std::string asf = kAsf;
    std::string amc = kAmc;
    for (std::string* text : {&asf, &amc}) {
      for (std::size_t at = 0; (at = text->find("shin", at)) != std::string::npos;) {
        text->replace(at, 4, odd);
      }
    }
    const auto capture = read(asf, amc);
    ASSERT_TRUE(capture.ok()) << capture.error().message;
    EXPECT_GE(capture->clip.skeleton.find("sh_in"), 0);
    EXPECT_TRUE(told(*capture, "acclaim-name", "control")) << all(*capture);
    EXPECT_TRUE(krok::check(capture->clip).ok());
  }
}

TEST(AcclaimReader, sections_may_be_unknown_or_in_another_order) {
  const std::size_t hierarchy = kAsf.find(":hierarchy");
  const std::size_t bones = kAsf.find(":bonedata");
  const std::string asf = ":skin a.obj\n  b.obj\n:vicon-extra 1 2\n  begin\n" +
                          kAsf.substr(hierarchy) + kAsf.substr(bones, hierarchy - bones) +
                          kAsf.substr(0, bones);
  const auto capture = read(asf, kAmc);
  ASSERT_TRUE(capture.ok()) << capture.error().message;
  EXPECT_TRUE(capture->clip.positions == read(kAsf, kAmc)->clip.positions);
  EXPECT_TRUE(told(*capture, "acclaim-keyword", ":vicon-extra")) << all(*capture);
}

TEST(AcclaimReader, bones_that_do_not_hang_on_the_root_are_left_out) {
  const auto capture = read(with(kAsf, "root thigh tail", "root thigh"), kAmc);
  ASSERT_TRUE(capture.ok()) << capture.error().message;
  EXPECT_EQ(capture->clip.joint_count(), 4);
  EXPECT_TRUE(told(*capture, "acclaim-hierarchy", "2 bones are not connected")) << all(*capture);
  const auto ring = read(with(kAsf, "root thigh tail", "root thigh\n tip tail"), kAmc);
  ASSERT_TRUE(ring.ok()) << ring.error().message;
  EXPECT_EQ(ring->clip.joint_count(), 4);
}

}  // namespace
}  // namespace krok::acclaim::test
