// What the reader makes of an ASF and an AMC that a person can compute. If these fail, a joint
// turns about the wrong axis, in the wrong order or in the wrong place, or an oddity of a file goes
// by without a word.

#include "formats/acclaim/acclaim_reader.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "math/euler.h"
#include "math/quaternion.h"
#include "unit/acclaim/small_files.h"

namespace {

using krok::Strictness;
using krok::Vec3;
using krok::acclaim::Capture;
using krok::acclaim::DegreeOfFreedom;
using krok::acclaim::ReadOptions;
using small_files::kAmc;
using small_files::kAsf;
using small_files::with;
using testing::HasSubstr;

ReadOptions plain() {
  ReadOptions options;
  options.unit = krok::Unit{1.0, "m"};
  options.up = krok::Direction::plus_y;
  options.forward = krok::Direction::plus_z;
  return options;
}

ReadOptions strictness(Strictness strictness) {
  ReadOptions options = plain();
  options.strictness = strictness;
  return options;
}

krok::Result<Capture> read(const std::string& asf, const std::string& amc,
                           const ReadOptions& options = plain()) {
  auto capture = krok::acclaim::read(asf, "s.asf", amc, "m.amc", options);
  if (capture.ok()) {
    const krok::Status whole = check(capture->clip);
    EXPECT_TRUE(whole.ok()) << whole.error().message;
  }
  return capture;
}

Vec3 position(const Capture& capture, int frame, const char* joint) {
  const int index = capture.clip.skeleton.find(joint);
  EXPECT_GE(index, 0) << joint;
  return capture.clip.frame_positions(frame)[static_cast<std::size_t>(index)].cast<double>();
}

void expect_near(const Vec3& actual, const Vec3& expected) {
  EXPECT_LT((actual - expected).norm(), 1e-6)
      << actual.transpose() << " instead of " << expected.transpose();
}

bool told(const Capture& capture, const std::string& code, const std::string& part) {
  for (const auto& d : capture.diagnostics) {
    if (d.code == code && d.message.find(part) != std::string::npos) return true;
  }
  return false;
}

std::string all(const Capture& capture) {
  std::string text;
  for (const auto& d : capture.diagnostics) text += d.code + ": " + d.message + "\n";
  return text;
}

TEST(AcclaimReader, joints_stand_at_the_beginnings_of_bones_and_leaves_have_ends) {
  const auto capture = read(kAsf, kAmc);
  ASSERT_TRUE(capture.ok()) << capture.error().message;
  const krok::Skeleton& skeleton = capture->clip.skeleton;
  EXPECT_THAT(skeleton.names,
              testing::ElementsAre("root", "thigh", "shin", "shin_end", "tail", "tip", "tip_end"));
  EXPECT_THAT(skeleton.parents, testing::ElementsAre(-1, 0, 1, 2, 0, 4, 5));
  EXPECT_THAT(skeleton.end_sites, testing::ElementsAre(0, 0, 0, 1, 0, 0, 1));
  expect_near(skeleton.reference[3].position, {0, -9, 0});
  expect_near(skeleton.reference[6].position, {0, 0, -3});
  for (const auto& joint : skeleton.reference) {
    EXPECT_TRUE(joint.orientation.coeffs() == krok::Quat::Identity().coeffs());
  }
  EXPECT_EQ(capture->name, "two bones");
  EXPECT_EQ(capture->documentation, "made by hand\nfor tests");
}

TEST(AcclaimReader, bones_turn_about_their_own_axes_in_the_order_of_dof) {
  const auto capture = read(kAsf, kAmc);
  ASSERT_TRUE(capture.ok());
  ASSERT_EQ(capture->clip.frame_count(), 3);
  expect_near(position(*capture, 0, "shin_end"), {0, 0, 0});
  // Frame 2: the root looks to +X. The thigh, turned by 90 degrees about x, points to the root's
  // -z, the world's -x. The shin's x is the root's -z (90 degrees about y), along which the thigh
  // points after its turn has taken (0,0,-1) to (0,1,0): it turns about the thigh's (0,0,-1).
  expect_near(position(*capture, 1, "shin"), {1 - 4, 9, 0});
  // In the thigh's frame the shin's (0,-1,0) turns about (0,0,-1) by 90 degrees to (-1,0,0); the
  // thigh's turn about x leaves that, the root's about y takes it to (0,0,1).
  expect_near(position(*capture, 1, "shin_end"), {1 - 4, 9, 5});
  // Frame 3: rz first, then rx. (0,-1,0) turns about z to (1,0,0), which rx leaves alone; in the
  // other order it would end at (0,0,-1).
  expect_near(position(*capture, 2, "shin"), {1 + 4, 9, 0});
}

TEST(AcclaimReader, translation_moves_along_the_bones_axes_and_l_is_its_length) {
  const auto capture = read(kAsf, kAmc);
  ASSERT_TRUE(capture.ok());
  // The tail's x is the root's y (90 degrees about z); its bone points to -z, in frame 2 to -x.
  expect_near(position(*capture, 1, "tail"), {1, 9.5, 0});
  expect_near(position(*capture, 1, "tip"), {1 - 3, 9.5, 0});
  expect_near(position(*capture, 1, "tip_end"), {1 - 4, 9.5, 0});
  // A bone that the motion does not mention keeps the length of the skeleton.
  const auto without = read(kAsf, with(kAmc, "tail 0 2\n", ""));
  ASSERT_TRUE(without.ok());
  expect_near(position(*without, 0, "tip"), {0, 9, -2});
  EXPECT_TRUE(told(*without, "acclaim-missing", "tail")) << all(*without);
}

TEST(AcclaimReader, axis_order_turns_about_the_first_letter_first) {
  // C = Rz(90) Rx(90) for XYZ takes x to y; C = Rx(90) Rz(90) for ZYX takes x to z.
  const std::string asf = with(kAsf, "axis 0 90 0 XYZ", "axis 90 0 90 {}");
  for (const auto& [order, end] :
       {std::pair("XYZ", Vec3(0, 0, 0)), std::pair("zyx", Vec3(5, 5, 0))}) {
    const std::string text = with(asf, "{}", order);
    const auto capture = read(text, ":FULLY-SPECIFIED\n1\nroot 0 9 0 0 0 0\nthigh 0 0\nshin 90\n");
    ASSERT_TRUE(capture.ok()) << capture.error().message;
    expect_near(position(*capture, 0, "shin_end"), end);
  }
}

TEST(AcclaimReader, root_order_says_where_values_stand_and_which_turn_is_first) {
  // ry after rx: (0,-1,0) turns about x to (0,0,-1), then about y to (-1,0,0).
  const std::string asf = with(kAsf, "order TX TY TZ RX RY RZ", "order rx tz ty tx ry rz");
  const auto capture = read(asf, ":FULLY-SPECIFIED\n1\nroot 90 3 2 1 90 0\nthigh 0 0\n");
  ASSERT_TRUE(capture.ok());
  expect_near(position(*capture, 0, "root"), {1, 2, 3});
  expect_near(position(*capture, 0, "shin"), {1 - 4, 2, 3});
  const auto reversed = read(with(kAsf, "order TX TY TZ RX RY RZ", "order tx ty tz ry rx rz"),
                             ":FULLY-SPECIFIED\n1\nroot 1 2 3 90 90 0\nthigh 0 0\n");
  ASSERT_TRUE(reversed.ok());
  expect_near(position(*reversed, 0, "shin"), {1, 2, 3 - 4});
}

TEST(AcclaimReader, the_roots_own_place_comes_before_the_motion) {
  std::string asf = with(kAsf, "position 0 0 0", "position 0 0 7");
  asf = with(asf, "orientation 0 0 0", "orientation 0 90 0");
  const auto capture = read(asf, kAmc);
  ASSERT_TRUE(capture.ok());
  expect_near(capture->clip.skeleton.reference[5].position, {-2, 0, 7});  // (0,0,-2) turned
  // Frame 2 has the root at x = 1, turned about y by another 90 degrees.
  expect_near(position(*capture, 1, "root"), {0, 9, 7 - 1});
  expect_near(position(*capture, 1, "shin"), {0, 9, 6 + 4});
  EXPECT_TRUE(told(*capture, "acclaim-root", "position or orientation")) << all(*capture);
}

TEST(AcclaimReader, radians_of_skeleton_and_motion_are_told_apart) {
  const std::string asf =
      with(with(kAsf, "angle deg", "angle rad"), "axis 0 90 0", "axis 0 1.5707963267948966 0");
  const std::string in_asf = with(asf, "axis 0 0 90", "axis 0 0 1.5707963267948966");
  const auto degrees = read(in_asf, kAmc);
  const auto reference = read(kAsf, kAmc);
  ASSERT_TRUE(degrees.ok() && reference.ok());
  expect_near(position(*degrees, 1, "shin_end"), position(*reference, 1, "shin_end"));
  // Without a word in the motion the skeleton's unit holds.
  const std::string radians =
      ":FULLY-SPECIFIED\n1\nroot 1 9 0 0 1.5707963267948966 0\nthigh 0 1.5707963267948966\n"
      "shin 1.5707963267948966\ntail 0.5 3\n";
  for (const std::string& amc : {radians, with(radians, "SPECIFIED\n", "SPECIFIED\n:RADIANS\n")}) {
    const auto capture = read(in_asf, amc);
    ASSERT_TRUE(capture.ok());
    expect_near(position(*capture, 0, "shin_end"), position(*reference, 1, "shin_end"));
  }
}

TEST(AcclaimReader, limits_are_read_with_their_axes) {
  ReadOptions options = plain();
  options.unit = krok::Unit{0.5, "half metres"};
  const auto capture = read(kAsf, kAmc, options);
  ASSERT_TRUE(capture.ok());
  ASSERT_EQ(capture->freedoms.size(), 7u);
  const auto& thigh = capture->freedoms[1].degrees;
  ASSERT_EQ(thigh.size(), 2u);
  EXPECT_EQ(thigh[0].axis, 2);
  EXPECT_EQ(thigh[0].lower, -std::numeric_limits<double>::infinity());
  EXPECT_EQ(thigh[1].axis, 0);
  EXPECT_NEAR(thigh[1].lower, -krok::kPi / 2, 1e-12);
  EXPECT_NEAR(thigh[1].upper, krok::kPi / 4, 1e-12);
  const auto& tail = capture->freedoms[4].degrees;
  ASSERT_EQ(tail.size(), 2u);
  EXPECT_EQ(tail[0].kind, DegreeOfFreedom::Kind::translation);
  EXPECT_DOUBLE_EQ(tail[0].lower, -0.5);
  EXPECT_EQ(tail[1].kind, DegreeOfFreedom::Kind::stretch);
  EXPECT_DOUBLE_EQ(tail[1].lower, 1.0);
  EXPECT_LT(krok::angle_between(capture->freedoms[2].axes,
                                krok::axis_rotation(krok::Axis::y, krok::kPi / 2)),
            1e-9);
  EXPECT_TRUE(capture->freedoms[3].degrees.empty());
}

TEST(AcclaimReader, given_axes_turn_reference_and_motion_alike) {
  ReadOptions options = plain();
  options.up = krok::Direction::plus_z;
  options.forward = krok::Direction::minus_y;
  const auto turned = read(kAsf, kAmc, options);
  const auto as_is = read(kAsf, kAmc);
  ASSERT_TRUE(turned.ok() && as_is.ok());
  for (int f = 0; f < 3; ++f) {
    for (const char* joint : {"root", "shin_end", "tip_end"}) {
      const Vec3 p = position(*as_is, f, joint);
      expect_near(position(*turned, f, joint), {p.x(), p.z(), -p.y()});
    }
  }
  EXPECT_TRUE(turned->clip.skeleton.reference[2].orientation.isApprox(krok::Quat::Identity()));
}

TEST(AcclaimReader, a_skeleton_alone_is_a_clip_without_frames) {
  const auto capture = krok::acclaim::read(kAsf, "s.asf", {}, {}, plain());
  ASSERT_TRUE(capture.ok());
  EXPECT_EQ(capture->clip.frame_count(), 0);
  EXPECT_EQ(capture->clip.joint_count(), 7);
  const auto empty = krok::acclaim::read(kAsf, "s.asf", {}, "m.amc", plain());
  ASSERT_FALSE(empty.ok());
  EXPECT_EQ(empty.error().code, "acclaim-kind");
  EXPECT_EQ(empty.error().where.file, "m.amc");
}

TEST(AcclaimReader, the_rate_is_given_or_read_or_120_with_a_warning) {
  auto capture = read(kAsf, kAmc);
  ASSERT_TRUE(capture.ok());
  EXPECT_EQ(capture->clip.rate, 120.0);
  EXPECT_TRUE(told(*capture, "acclaim-rate", "120 frames a second")) << all(*capture);
  capture = read(kAsf, with(kAmc, ":DEGREES", ":SAMPLES-PER-SECOND 60\n:DEGREES"));
  ASSERT_TRUE(capture.ok());
  EXPECT_EQ(capture->clip.rate, 60.0);
  ReadOptions options = plain();
  options.rate = 30.0;
  capture = read(kAsf, kAmc, options);
  ASSERT_TRUE(capture.ok());
  EXPECT_EQ(capture->clip.rate, 30.0);
  EXPECT_FALSE(told(*capture, "acclaim-rate", "")) << all(*capture);
  options.rate = 0.0;
  ASSERT_FALSE(read(kAsf, kAmc, options).ok());
}

TEST(AcclaimReader, numbers_of_frames_may_begin_anywhere_and_go_up_by_a_step) {
  std::string amc =
      with(with(with(kAmc, "\n1\n", "\n101\n"), "\n2\n", "\n105\n"), "\n3\n", "\n109\n");
  const auto capture = read(kAsf, amc);
  ASSERT_TRUE(capture.ok());
  EXPECT_EQ(capture->first_frame_number, 101);
  EXPECT_EQ(capture->clip.frame_count(), 3);
  EXPECT_EQ(capture->clip.rate, 30.0);
  EXPECT_TRUE(told(*capture, "acclaim-rate", "go up by 4")) << all(*capture);
}

TEST(AcclaimReader, gaps_close_or_are_filled_or_refused) {
  const std::string amc = with(kAmc, "\n3\n", "\n5\n");
  const auto closed = read(kAsf, amc);
  ASSERT_TRUE(closed.ok());
  EXPECT_EQ(closed->clip.frame_count(), 3);
  EXPECT_TRUE(told(*closed, "acclaim-frame", "2 is followed by 5")) << all(*closed);
  const auto filled = read(kAsf, amc, strictness(Strictness::repair));
  ASSERT_TRUE(filled.ok());
  ASSERT_EQ(filled->clip.frame_count(), 5);
  EXPECT_EQ(filled->repairs.size(), 1u);
  expect_near(position(*filled, 4, "shin"), position(*closed, 2, "shin"));
  // A third of the way the root has turned back from 90 to 60 degrees.
  const auto orientation = filled->clip.frame_orientations(2)[0].cast<double>();
  EXPECT_LT(krok::angle_between(orientation, krok::axis_rotation(krok::Axis::y, krok::kPi / 3)),
            1e-6);
  const auto refused = read(kAsf, amc, strictness(Strictness::strict));
  ASSERT_FALSE(refused.ok());
  EXPECT_EQ(refused.error().code, "acclaim-frame");
  const auto huge =
      read(kAsf, with(kAmc, "\n3\n", "\n9000000000000000000\n"), strictness(Strictness::repair));
  ASSERT_FALSE(huge.ok());
  EXPECT_EQ(huge.error().code, "acclaim-limit");
}

TEST(AcclaimReader, a_bone_that_a_frame_leaves_out_stays_as_it_was) {
  const std::string amc =
      with(kAmc, "3\nroot 1 9 0 0 0 0\nthigh 90 90\n", "3\nroot 1 9 0 0 90 0\n") +
      "4\nroot 1 9 0 0 0 0\nthigh 90 90\n" + "shin 0\ntail 0 2\n";
  const auto capture = read(kAsf, amc);
  ASSERT_TRUE(capture.ok()) << capture.error().message;
  EXPECT_EQ(capture->clip.frame_count(), 4);
  expect_near(position(*capture, 2, "shin"), position(*capture, 1, "shin"));
  EXPECT_TRUE(told(*capture, "acclaim-missing", "thigh")) << all(*capture);
  for (const auto& d : capture->diagnostics) {
    if (d.code != "acclaim-missing") continue;
    EXPECT_EQ(d.where.line, 14);  // the number of frame 3
  }
  const auto refused = read(kAsf, amc, strictness(Strictness::strict));
  ASSERT_FALSE(refused.ok());
  EXPECT_EQ(refused.error().code, "acclaim-missing");
  EXPECT_THAT(refused.error().message, HasSubstr("frame 3 has no values for thigh"));
}

TEST(AcclaimReader, a_last_frame_that_is_cut_short_is_left_out) {
  for (const char* end : {"shin 0\ntail 0 2\n", "tail 0 2\n", " 2\n", "2\n"}) {
    const std::string amc = kAmc.substr(0, kAmc.rfind(end));
    const auto capture = read(kAsf, amc);
    ASSERT_TRUE(capture.ok()) << capture.error().message;
    EXPECT_EQ(capture->clip.frame_count(), 2) << amc.substr(amc.size() - 20);
    EXPECT_TRUE(told(*capture, "acclaim-cut", "frame 3")) << all(*capture);
    EXPECT_FALSE(read(kAsf, amc, strictness(Strictness::strict)).ok());
  }
}

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
  EXPECT_TRUE(told(*capture, "acclaim-hierarchy", "2 bones do not hang")) << all(*capture);
  const auto ring = read(with(kAsf, "root thigh tail", "root thigh\n tip tail"), kAmc);
  ASSERT_TRUE(ring.ok()) << ring.error().message;
  EXPECT_EQ(ring->clip.joint_count(), 4);
}

struct Faulty {
  const char* what;
  std::string asf, amc;
  const char* code;
  int line, column;
  const char* message;
};

void PrintTo(const Faulty& faulty, std::ostream* out) {
  *out << faulty.what;
}

class AcclaimErrors : public testing::TestWithParam<Faulty> {};

TEST_P(AcclaimErrors, tell_file_line_and_column) {
  const Faulty& faulty = GetParam();
  const auto capture = read(faulty.asf, faulty.amc);
  ASSERT_FALSE(capture.ok()) << all(*capture);
  const krok::Error& error = capture.error();
  EXPECT_EQ(error.code, faulty.code);
  EXPECT_THAT(error.message, HasSubstr(faulty.message));
  EXPECT_EQ(error.where.line, faulty.line) << error.message;
  EXPECT_EQ(error.where.column, faulty.column) << error.message;
  EXPECT_EQ(error.where.file, faulty.asf == kAsf ? "m.amc" : "s.asf");
}

INSTANTIATE_TEST_SUITE_P(
    all, AcclaimErrors,
    testing::Values(
        Faulty{"swapped", kAmc, kAsf, "acclaim-kind", 0, 0, "motion (AMC)"},
        Faulty{"number", with(kAsf, "length 4", "length 4m"), kAmc, "acclaim-number", 21, 12,
               "'4m' in the length of the bone thigh"},
        Faulty{"nan", with(kAsf, "axis 0 90", "axis 0 nan"), kAmc, "acclaim-number", 33, 12, "nan"},
        Faulty{"dof", with(kAsf, "dof rz rx", "dof rz rw"), kAmc, "acclaim-dof", 23, 12, "'rw'"},
        Faulty{"dof_twice", with(kAsf, "dof rz rx", "dof rz rz"), kAmc, "acclaim-dof", 23, 12,
               "twice"},
        Faulty{"no_length", with(kAsf, "    length 4\n", ""), kAmc, "acclaim-bone", 19, 10,
               "thigh has no length"},
        Faulty{"no_name", with(kAsf, "name thigh", "name"), kAmc, "acclaim-bone", 17, 3,
               "has no name"},
        Faulty{"same_name", with(kAsf, "name tip", "name tail"), kAmc, "acclaim-bone", 48, 10,
               "second bone is named tail"},
        Faulty{"no_end", with(kAsf, "  end\n  begin\n    id 2", "  begin\n    id 2"), kAmc,
               "acclaim-syntax", 27, 3, "the end of the bone thigh is missing"},
        Faulty{"order", with(kAsf, "axis 0 90 0 XYZ", "axis 0 90 0 XXZ"), kAmc, "acclaim-syntax",
               33, 17, "'XXZ'"},
        Faulty{"unknown_child", with(kAsf, "thigh shin", "thigh shim"), kAmc, "acclaim-hierarchy",
               56, 11, "shim"},
        Faulty{"two_parents", with(kAsf, "tail tip", "tail tip shin"), kAmc, "acclaim-hierarchy",
               57, 14, "second parent"},
        Faulty{"unit", with(kAsf, "length 1.0", "length 0"), kAmc, "acclaim-number", 6, 10,
               "not positive"},
        Faulty{"angle", with(kAsf, "angle deg", "angle grad"), kAmc, "acclaim-syntax", 7, 9,
               "grad"},
        Faulty{"value", kAsf, with(kAmc, "root 1 9 0 0 90 0", "root 1 9 0 0 9o 0"),
               "acclaim-number", 10, 14, "'9o' in the values of root"},
        Faulty{"infinity", kAsf, with(kAmc, "shin 90", "shin inf"), "acclaim-number", 12, 6, "inf"},
        Faulty{"few", kAsf, with(kAmc, "thigh 0 90", "thigh 0"), "acclaim-values", 11, 1,
               "1 value for thigh, expected 2 (rz rx)"},
        Faulty{"many", kAsf, with(kAmc, "shin 90", "shin 90 1"), "acclaim-values", 12, 1,
               "2 values for shin, expected 1 (rx)"},
        Faulty{"other_bone", kAsf, with(kAmc, "shin 90", "shim 90"), "acclaim-unknown-bone", 12, 1,
               "no bone shim"},
        Faulty{"twice", kAsf, with(kAmc, "\n3\n", "\n"), "acclaim-frame", 14, 1,
               "frame 2 has root twice"},
        Faulty{"no_frame", kAsf, with(kAmc, "\n1\n", "\n"), "acclaim-syntax", 4, 1,
               "number of the first frame"}),
    [](const auto& test) { return test.param.what; });

TEST(AcclaimReader, repair_leaves_out_lines_that_cannot_be_read_and_lists_them) {
  const std::string amc = with(with(kAmc, "thigh 0 90", "thigh 0 9o"), "shin 90", "shim 90");
  const auto capture = read(kAsf, amc, strictness(Strictness::repair));
  ASSERT_TRUE(capture.ok()) << capture.error().message;
  EXPECT_EQ(capture->clip.frame_count(), 3);
  ASSERT_EQ(capture->repairs.size(), 2u);
  EXPECT_THAT(capture->repairs[0], HasSubstr("line 11 left out: '9o'"));
  expect_near(position(*capture, 1, "shin"), {1, 5, 0});
}

TEST(AcclaimReader, a_unit_that_makes_a_person_is_believed_and_another_is_not) {
  // Two legs make no figure that could be recognised, so only :units speaks.
  ReadOptions options;
  const auto cmu = read(with(kAsf, "length 1.0", "length 0.45"), kAmc, options);
  ASSERT_TRUE(cmu.ok());
  EXPECT_EQ(cmu->conventions.unit.name, "cmu");
  EXPECT_NEAR(cmu->clip.skeleton.reference[3].position.y(), -9 * 0.0254 / 0.45, 1e-9);
  const auto other = read(with(kAsf, "length 1.0", "length 0.15"), kAmc, options);
  ASSERT_TRUE(other.ok());
  EXPECT_NEAR(other->conventions.unit.metres, 0.0254 / 0.15, 1e-12);
  const auto none = read(with(kAsf, "length 1.0", "length 1e-9"), kAmc, options);
  ASSERT_TRUE(none.ok());
  EXPECT_LT(none->conventions.unit.metres, 2.0);
}

TEST(AcclaimReader, deep_hierarchies_and_many_frames_are_bounded) {
  std::string asf = ":units\n length 1\n:root\n order tx ty tz\n:bonedata\n";
  std::string hierarchy = ":hierarchy\nbegin\nroot b0\n";
  constexpr int kBones = 30000;
  for (int i = 0; i < kBones; ++i) {
    asf += fmt::format("begin\nname b{}\ndirection 0 1 0\nlength 0.01\naxis 0 0 0 xyz\nend\n", i);
    if (i > 0) hierarchy += fmt::format("b{} b{}\n", i - 1, i);
  }
  asf += hierarchy + "end\n";
  std::string amc = ":FULLY-SPECIFIED\n1\nroot 0 0 0\n";
  auto capture = read(asf, amc, ReadOptions());
  ASSERT_TRUE(capture.ok()) << capture.error().message;
  EXPECT_EQ(capture->clip.joint_count(), kBones + 2);
  EXPECT_NEAR(capture->clip.skeleton.reference.back().position.y(),
              300 * capture->conventions.unit.metres, 1e-6);
  for (int i = 2; i < 100000; ++i) amc += fmt::format("{}\n", i);
  capture = read(asf, amc);
  ASSERT_FALSE(capture.ok());
  EXPECT_EQ(capture.error().code, "acclaim-limit");
  ReadOptions few = plain();
  few.max_joints = 4;
  capture = read(kAsf, kAmc, few);
  ASSERT_FALSE(capture.ok());
  EXPECT_EQ(capture.error().code, "acclaim-limit");
}

TEST(AcclaimReader, numbers_that_overflow_are_an_error) {
  auto capture = read(with(kAsf, "length 4", "length 1e300"), kAmc);
  ASSERT_FALSE(capture.ok());
  EXPECT_EQ(capture.error().code, "acclaim-number");
  capture = read(kAsf, with(kAmc, "root 1 9 0", "root 1e300 9 0"));
  ASSERT_FALSE(capture.ok());
  EXPECT_EQ(capture.error().code, "acclaim-number");
}

}  // namespace
