// If these fail, skeletons come in with joints lost, misnamed or misplaced, or a broken hierarchy
// is taken for a good one.

#include "unit/bvh/bvh_text.h"

namespace krok::bvh {
namespace {

const std::string kRow = "0 0 0 0 0 0 0 0 0\n";

TEST(Hierarchy, JointsEndSitesAndReferencePose) {
  const Capture capture = read_ok(kArm + motion(1, kRow));
  const Skeleton& skeleton = capture.clip.skeleton;
  EXPECT_EQ(skeleton.names, (std::vector<std::string>{"Root", "Elbow", "Elbow_end"}));
  EXPECT_EQ(skeleton.parents, (std::vector<int>{-1, 0, 1}));
  EXPECT_EQ(skeleton.end_sites, (std::vector<std::uint8_t>{0, 0, 1}));
  EXPECT_EQ(skeleton.reference[2].position, Vec3(3, 0, 0));
  EXPECT_EQ(skeleton.reference[2].orientation.coeffs(), Quat::Identity().coeffs());
}

// Would fail if a hand that ends 1.6 m from its wrist went in without a word, as in public
// captures.
TEST(Hierarchy, EndSitesFarAwayAreTold) {
  const auto chain = [](int joints, const std::string& end) {
    std::string text = "HIERARCHY\nROOT j0\n{\nOFFSET 0 0 0\nCHANNELS 1 Xrotation\n", close = "}\n";
    for (int j = 1; j < joints; ++j) {
      text += "JOINT j" + std::to_string(j) + "\n{\nOFFSET 0 10 0\nCHANNELS 0\n";
      close += "}\n";
    }
    return text + "End Site\n{\nOFFSET 0 " + end + " 0\n}\n" + close + motion(1, "1\n");
  };
  const Capture far = read_ok(chain(16, "160"));
  const Diagnostic* warning = find(far.diagnostics, "bvh-end-site");
  ASSERT_NE(warning, nullptr);
  EXPECT_EQ(warning->message,
            "the End Site of j15 is 160 away, more than half of the character's size of 150");
  EXPECT_EQ(find(read_ok(chain(16, "70")).diagnostics, "bvh-end-site"), nullptr);
  // Of a few joints nothing is known.
  EXPECT_EQ(find(read_ok(chain(3, "160")).diagnostics, "bvh-end-site"), nullptr);
}

TEST(Hierarchy, NamesAreTakenAsTheyAre) {
  for (const std::string name : {"Left Arm", "mixamorig:Hips", "a.b#1", "\"quoted\"",
                                 "\xC3\xA9paule", "LeftEnd", "Joint{1", "MOTION", "End", "-"}) {
    const std::string text = "HIERARCHY\nROOT " + name +
                             " \r\n{\r\nOFFSET 0 0 0\r\nCHANNELS 1 Xrotation\r\n}\r\n" +
                             motion(1, "1\n");
    EXPECT_EQ(read_ok(text).clip.skeleton.names[0], name);
  }
}

TEST(Hierarchy, BracesMayStandOnTheLineOfTheName) {
  const Capture capture = read_ok(
      "HIERARCHY ROOT Left Arm { OFFSET 0 0 0 CHANNELS 1 Xrotation End Site{OFFSET 0 1 0}}" +
      std::string("\n") + motion(1, "1\n"));
  EXPECT_EQ(capture.clip.skeleton.names, (std::vector<std::string>{"Left Arm", "Left Arm_end"}));
}

TEST(Hierarchy, DuplicateNamesBecomeUniqueWithAWarning) {
  const Capture capture = read_ok(
      "HIERARCHY\nROOT a\n{\nOFFSET 0 0 0\nCHANNELS 1 Xrotation\n"
      "JOINT a\n{\nOFFSET 1 0 0\nCHANNELS 0\n}\n"
      "JOINT a_2\n{\nOFFSET 1 0 0\nCHANNELS 0\nEnd Site\n{\nOFFSET 1 0 0\n}\n"
      "End Site\n{\nOFFSET 2 0 0\n}\n}\n}\n" +
      motion(1, "1\n"));
  // a_2 is the file's own name, so the second a cannot have it.
  EXPECT_EQ(capture.clip.skeleton.names,
            (std::vector<std::string>{"a", "a_3", "a_2", "a_2_end", "a_2_end_2"}));
  const Diagnostic* warning = find(capture.diagnostics, "bvh-name-duplicate");
  ASSERT_NE(warning, nullptr);
  EXPECT_EQ(warning->where.line, 6);
  EXPECT_EQ(warning->where.column, 7);
  EXPECT_TRUE(check(capture.clip).ok());
}

// What is renamed or joined is an error of the file.
TEST(Hierarchy, StrictRefusesDuplicateNamesAndSeveralRoots) {
  const std::string joint = "\n{\nOFFSET 0 0 0\nCHANNELS 1 Xrotation\n}\n";
  const Error twice =
      read_error("HIERARCHY\nROOT a\n{\nOFFSET 0 0 0\nCHANNELS 1 Xrotation\nJOINT a" + joint +
                     "}\n" + motion(1, "1 1\n"),
                 with(Strictness::strict));
  EXPECT_EQ(twice.code, "bvh-name-duplicate");
  EXPECT_EQ(twice.where.line, 6);
  EXPECT_EQ(read_error("HIERARCHY\nROOT A" + joint + "ROOT B" + joint + motion(1, "1 1\n"),
                       with(Strictness::strict))
                .code,
            "bvh-roots");
}

TEST(Hierarchy, ANameLikeAMadeUpOneIsKept) {
  const Capture capture = read_ok(
      "HIERARCHY\nROOT a\n{\nOFFSET 0 0 0\nCHANNELS 1 Xrotation\nEnd Site\n{\nOFFSET 1 0 0\n}\n"
      "JOINT a_end\n{\nOFFSET 1 0 0\n}\n}\n" +
      motion(1, "1\n"));
  EXPECT_EQ(capture.clip.skeleton.names, (std::vector<std::string>{"a", "a_end_2", "a_end"}));
}

TEST(Hierarchy, NamesThatAreNotUtf8AreReadAsLatin1) {
  const Capture capture = read_ok(
      "HIERARCHY\nROOT \xE9paule\n{\nOFFSET 0 0 0\nCHANNELS 1 Xrotation\n}\n" + motion(1, "1\n"));
  EXPECT_EQ(capture.clip.skeleton.names[0], "\xC3\xA9paule");
  EXPECT_NE(find(capture.diagnostics, "bvh-name"), nullptr);
}

TEST(Hierarchy, SeveralRootsGetACommonParent) {
  const std::string root = "\n{\nOFFSET 0 0 0\nCHANNELS 3 Xposition Yposition Zposition\n}\n";
  const Capture capture =
      read_ok("HIERARCHY\nROOT A" + root + "ROOT B" + root + motion(1, "1 2 3 4 5 6\n"));
  EXPECT_EQ(capture.clip.skeleton.names, (std::vector<std::string>{"Roots", "A", "B"}));
  EXPECT_EQ(capture.clip.skeleton.parents, (std::vector<int>{-1, 0, 0}));
  EXPECT_EQ(capture.clip.positions[2], Vec3f(4, 5, 6));
  EXPECT_NE(find(capture.diagnostics, "bvh-roots"), nullptr);
}

TEST(Hierarchy, LineEndsTabsByteOrderMarkAndCaseDoNotMatter) {
  const std::string text = kArm + motion(2, "1 2 3 4 5 6 7 8 9\n2 3 4 5 6 7 8 9 1\n");
  const Clip expected = read_ok(text).clip;
  const auto with = [&](const std::string& line_end) {
    std::string result;
    for (const char c : text) result += c == '\n' ? line_end : std::string(1, c == ' ' ? '\t' : c);
    return result;
  };
  std::string lower = "\xEF\xBB\xBF";
  for (const char c : text) lower += static_cast<char>(std::tolower(c));
  for (const std::string& variant : {with("\r\n"), with("\r"), with("\n\n"), lower}) {
    const Clip clip = read_ok(variant).clip;
    EXPECT_EQ(clip.positions, expected.positions);
    EXPECT_EQ(clip.frame_count(), 2);
  }
}

TEST(Hierarchy, DeepNestingIsNoTrouble) {
  std::string open;
  std::string close;
  constexpr int kDepth = 20000;
  for (int i = 0; i < kDepth; ++i) {
    open += (i == 0 ? "ROOT j" : "JOINT j") + std::to_string(i) + "\n{\nOFFSET 0 1 0\n";
    close += "}\n";
  }
  open += "CHANNELS 1 Xrotation\n";
  const Capture capture = read_ok("HIERARCHY\n" + open + close + motion(1, "90\n"));
  EXPECT_EQ(capture.clip.joint_count(), kDepth);
  EXPECT_NEAR(capture.clip.positions.back().y(), kDepth, 1e-3);
}

TEST(Hierarchy, TheNumberOfJointsIsLimited) {
  ReadOptions options = plain_options();
  options.max_joints = 2;
  EXPECT_EQ(read_error(kArm + motion(1, kRow), options).code, "bvh-limit");
}

struct Broken {
  std::string text;
  std::string code;
  int line;
  int column;
};

TEST(Hierarchy, FaultsAreToldWithTheirPlace) {
  const std::string rest = motion(1, "1\n");
  const std::vector<Broken> cases = {
      {"", "bvh-kind", 0, 0},
      {"  \n", "bvh-kind", 0, 0},
      {"hello", "bvh-kind", 0, 0},
      {"HIERARCHY\nROOT a\n{\nOFFSET 0 0\n}\n" + rest, "bvh-number", 5, 1},
      {"HIERARCHY\nROOT a\n{\nOFFSET 0 0 1e999\n}\n" + rest, "bvh-number", 4, 12},
      {"HIERARCHY\nROOT a\n{\nOFFSET 0 0 nan\n}\n" + rest, "bvh-number", 4, 12},
      {"HIERARCHY\nROOT a\n{\nOFFSET 0 0 12.3abc\n}\n" + rest, "bvh-number", 4, 12},
      {"HIERARCHY\nROOT a\n{\nOFFSET 0 0 0\nOFFSET 0 0 0\n}\n" + rest, "bvh-syntax", 5, 1},
      {"HIERARCHY\nROOT a\n{\nCHANNELS 2 Xrotation\n}\n" + rest, "bvh-channels", 4, 10},
      {"HIERARCHY\nROOT a\n{\nCHANNELS -1\n}\n" + rest, "bvh-channels", 4, 10},
      {"HIERARCHY\nROOT a\n{\nCHANNELS x\n}\n" + rest, "bvh-channels", 4, 10},
      {"HIERARCHY\nROOT a\n{\nCHANNELS 1 Xrotation Yrotation\n}\n" + rest, "bvh-syntax", 4, 22},
      {"HIERARCHY\nROOT a\n{\nCHANNELS 2 Xposition Xposition\n}\n" + rest, "bvh-channels", 4, 22},
      {"HIERARCHY\nJOINT a\n{\n}\n" + rest, "bvh-syntax", 2, 1},
      {"HIERARCHY\nROOT a\n{\nROOT b\n{\n}\n}\n" + rest, "bvh-syntax", 4, 1},
      {"HIERARCHY\nROOT a\nOFFSET 0 0 0\n" + rest, "bvh-syntax", 3, 1},
      {"HIERARCHY\nROOT a\n{\nOFFSET 0 0 0\n" + rest, "bvh-syntax", 5, 1},
      {"HIERARCHY\nROOT a\n{\nOFFSET 0 0 0\n}\n}\n" + rest, "bvh-syntax", 6, 1},
      {"HIERARCHY\nROOT a\n{\nEnd Site\n{\nJOINT b\n{\n}\n}\n}\n" + rest, "bvh-syntax", 6, 1},
      {"HIERARCHY\n" + rest, "bvh-syntax", 2, 1},
      {"HIERARCHY\nROOT a\n{\nOFFSET 0 0", "bvh-syntax", 4, 11},
      {"HIERARCHY\nROOT a\n{\nCHANNELS", "bvh-syntax", 4, 9},
      {"HIERARCHY\nROOT a\n{\nCHANNELS 2 Xrotation", "bvh-syntax", 4, 21},
      {kArm + "MOTION\n", "bvh-syntax", 17, 1},
      {kArm + "MOTION\nFrames: x\n", "bvh-frame-count", 17, 9},
      {kArm + "MOTION\nFrames: -1\nFrame Time: 1\n", "bvh-frame-count", 17, 9},
      {kArm + "MOTION\nFrames: 1\n1 2 3\n", "bvh-frame-time", 18, 1},
      {"HIERARCHY\nROOT a\n{\nOFFSET 0 0 1e39\n}\n" + rest, "bvh-number", 4, 12},
      {kArm + "MOTION\nFrames: 0\nFrame Time: 0\n", "bvh-frame-time", 18, 13},
      {kArm + "MOTION\nFrames: 0\nFrame Time: -0.1\n", "bvh-frame-time", 18, 13},
  };
  for (const Broken& broken : cases) {
    const Error error = read_error(broken.text);
    EXPECT_EQ(error.code, broken.code) << broken.text << "\n" << error.message;
    EXPECT_EQ(error.where.line, broken.line) << broken.text << "\n" << error.message;
    EXPECT_EQ(error.where.column, broken.column) << broken.text << "\n" << error.message;
    EXPECT_EQ(error.where.file, "test.bvh");
  }
}

TEST(Hierarchy, WithoutMotionIsASkeleton) {
  const Capture capture = read_ok(kArm);
  EXPECT_EQ(capture.clip.frame_count(), 0);
  EXPECT_EQ(capture.clip.skeleton.names, read_ok(kArm + motion(0, "")).clip.skeleton.names);
  const Diagnostic* warning = find(capture.diagnostics, "bvh-no-motion");
  ASSERT_NE(warning, nullptr);
  EXPECT_EQ(warning->severity, Severity::warning);
  ReadOptions strict = plain_options();
  strict.strictness = Strictness::strict;
  EXPECT_EQ(read_error(kArm, strict).code, "bvh-no-motion");
}

TEST(Hierarchy, FaultsThatAHandCanMendComeWithAHint) {
  const std::string rest = motion(1, "1\n");
  ReadOptions two_joints = plain_options();
  two_joints.max_joints = 2;
  const auto hint = [](const std::string& text) { return read_error(text).hint; };
  EXPECT_NE(hint(kArm + "MOTION\n0 0 0\n").find("Frames: 120"), std::string::npos);
  EXPECT_NE(hint(kArm + "MOTION\nFrames: 3.5\n").find("Frames: 120"), std::string::npos);
  EXPECT_NE(hint(kArm + "MOTION\nFrames: -3\n").find("Frames: 120"), std::string::npos);
  EXPECT_NE(hint(kArm + "MOTION\nFrames: 1\n" + kRow).find("--fps"), std::string::npos);
  EXPECT_NE(hint(kArm + motion(1, kRow, "0")).find("--fps"), std::string::npos);
  EXPECT_NE(hint(kArm + motion(1, kRow, "-0.1")).find("--fps"), std::string::npos);
  for (const std::string channels : {"x", "2 Xrotation", "1 Xrotation Yrotation"}) {
    EXPECT_NE(hint("HIERARCHY\nROOT a\n{\nOFFSET 0 0 0\nCHANNELS " + channels + "\n}\n" + rest)
                  .find("the number of channels"),
              std::string::npos)
        << channels;
  }
  EXPECT_NE(hint("HIERARCHY\nROOT a\n{\nOFFSET 0 0 0\n" + rest).find("'}'"), std::string::npos);
  EXPECT_NE(read_error(kArm + motion(1, kRow), two_joints).hint, "");
}

TEST(Hierarchy, ControlCharactersInANameAreReplacedWithTheirPlace) {
  for (const char c : {'\0', '\x01', '\x1B', '\x7F'}) {
    const std::string text = "HIERARCHY\nROOT a" + std::string(1, c) +
                             "b\n{\nOFFSET 0 0 0\nCHANNELS 1 Xrotation\n}\n" + motion(1, "1\n");
    const Capture capture = read_ok(text);
    EXPECT_EQ(capture.clip.skeleton.names[0], "a_b");
    const Diagnostic* warning = find(capture.diagnostics, "bvh-name");
    ASSERT_NE(warning, nullptr);
    EXPECT_EQ(warning->where.line, 2);
  }
}

TEST(Hierarchy, AJointWithoutANameIsToldItsNewOne) {
  const Capture capture = read_ok(
      "HIERARCHY\nROOT joint\n{\nOFFSET 0 0 0\nCHANNELS 1 Xrotation\nJOINT\n{\nOFFSET 0 0 "
      "0\n}\n}\n" +
      motion(1, "1\n"));
  EXPECT_EQ(capture.clip.skeleton.names[1], "joint_2");
  const Diagnostic* warning = find(capture.diagnostics, "bvh-name");
  ASSERT_NE(warning, nullptr);
  EXPECT_NE(warning->message.find("joint_2"), std::string::npos);
  EXPECT_EQ(warning->where.line, 6);
}

TEST(Hierarchy, OddButHarmlessFilesAreTakenWithAWarningAndRefusedByStrict) {
  ReadOptions strict = plain_options();
  strict.strictness = Strictness::strict;
  const std::string rest = motion(1, "1\n");
  const std::vector<std::pair<std::string, std::string>> cases = {
      {"HIERARCHY\nROOT\n{\nOFFSET 0 0 0\nCHANNELS 1 Xrotation\n}\n" + rest, "bvh-name"},
      {"HIERARCHY\nROOT a\n{\nCHANNELS 1 Xrotation\n}\n" + rest, "bvh-offset"},
      {"HIERARCHY\nROOT a\n{\nOFFSET 0 0 0\nCHANNELS 2 Xrotation Xscale\n}\n" + motion(1, "1 1\n"),
       "bvh-channels"},
      {"HIERARCHY\nROOT a\n{\nOFFSET 0 0 0\nCHANNELS 1 Xrotation,\n}\n" + rest, "bvh-channels"},
      {"HIERARCHY\nROOT a\n{\nOFFSET 0 0 0\nCHANNELS 3 Xrotation Yrotation Xrotation\n}\n" +
           motion(1, "1 2 3\n"),
       "bvh-channels"},
      {"HIERARCHY\nROOT a\n{\nOFFSET 0 0 0\nCHANNELS 1 Xrotation\nEnd Site\n{\nOFFSET 0 1 0\n"
       "CHANNELS 1 Xrotation\n}\n}\n" +
           motion(1, "1 1\n"),
       "bvh-channels"},
      {"HIERARCHY\n# made by hand\nROOT a\n{\nOFFSET 0 0 0\n// bend\nCHANNELS 1 Xrotation\n}\n" +
           rest,
       "bvh-syntax"},
      {"Exported.\nHIERARCHY\nROOT a\n{\nOFFSET 0 0 0\nCHANNELS 1 Xrotation\n}\n" + rest,
       "bvh-text-before"},
      {"ROOT a\n{\nOFFSET 0 0 0\nCHANNELS 1 Xrotation\n}\n" + rest, "bvh-syntax"}};
  for (const auto& [text, code] : cases) {
    const Capture capture = read_ok(text);
    ASSERT_NE(find(capture.diagnostics, code), nullptr) << text;
    EXPECT_EQ(find(capture.diagnostics, code)->severity, Severity::warning);
    EXPECT_TRUE(check(capture.clip).ok());
    EXPECT_EQ(read_error(text, strict).code, code);
  }
}

TEST(Hierarchy, AActorWithoutAnyChannelThatIsUnderstoodIsRefused) {
  const auto with = [](const std::string& channels) {
    return "HIERARCHY\nROOT a\n{\nOFFSET 0 0 0\nCHANNELS " + channels + "\n}\n" +
           motion(1, "1 0 0 0\n");
  };
  EXPECT_EQ(read_error(with("4 Xrot Yrot Zrot Xpos")).code, "bvh-channels");
  const Error quaternion = read_error(with("4 Wrotation Xrotation Yrotation Zrotation"));
  EXPECT_EQ(quaternion.code, "bvh-channels");
  EXPECT_NE(quaternion.message.find("quaternion"), std::string::npos);
}

TEST(Hierarchy, AnEndSiteMayBeWrittenAsOneWord) {
  const Capture capture = read_ok(
      "HIERARCHY\nROOT a\n{\nOFFSET 0 0 0\nCHANNELS 1 Xrotation\nEndSite\n{\nOFFSET 0 1 0\n}\n}\n" +
      motion(1, "1\n"));
  ASSERT_EQ(capture.clip.joint_count(), 2);
  EXPECT_EQ(capture.clip.skeleton.names[1], "a_end");
  EXPECT_NE(capture.clip.skeleton.end_sites[1], 0);
}

TEST(Hierarchy, OtherKindsOfFilesAreCalledByTheirName) {
  EXPECT_NE(read_error("\x89PNG\r\n\x1a\n").message.find("PNG"), std::string::npos);
  EXPECT_NE(read_error(std::string("KROKANIM\0\0", 10)).message.find(".anim"), std::string::npos);
  EXPECT_NE(read_error("\xFF\xFEH\0I\0").message.find("UTF-16"), std::string::npos);
  const std::string wide("H\0I\0E\0R\0A\0R\0", 12);
  EXPECT_NE(read_error(wide).message.find("UTF-16"), std::string::npos);
  EXPECT_NE(read_error(std::string(1, '\0') + wide).message.find("UTF-16"), std::string::npos);
}

}  // namespace
}  // namespace krok::bvh
