// If these fail, files of iPi Mocap Studio are not named as such, or others are.

#include "unit/bvh/bvh_text.h"

namespace krok::bvh {
namespace {

// A chain of joints with two frames, the first of them unturned, written with `tab` before each
// row.
std::string chain(const std::vector<std::string>& names, const std::string& tab,
                  const std::string& frame_time) {
  std::string text = "HIERARCHY\n";
  std::string still;
  std::string turned;
  for (const std::string& name : names) {
    text += (&name == &names[0] ? "ROOT " : "JOINT ") + name +
            "\n{\nOFFSET 0 1 0\nCHANNELS 3 Xrotation Yrotation Zrotation\n";
    still += tab + "0.000000" + tab + "0.000000" + tab + "0.000000";
    turned += tab + "1.000000" + tab + "0.000000" + tab + "2.000000";
  }
  text += "End Site\n{\nOFFSET 0 1 0\n}\n";
  for (std::size_t i = 0; i < names.size(); ++i) text += "}\n";
  return text + motion(2, still + "\n" + turned + "\n", frame_time);
}

const std::vector<std::string> kOwnNames = {"Hip",   "LowerSpine", "MiddleSpine", "Chest",
                                            "Neck",  "LClavicle",  "LShoulder",   "LForearm",
                                            "LHand", "LThigh",     "LShin"};
const std::vector<std::string> kMotionBuilder = {"Hips",       "Spine",   "LeftUpLeg",   "LeftLeg",
                                                 "LeftFoot",   "LeftArm", "LeftForeArm", "LeftHand",
                                                 "RightUpLeg", "RightArm"};

TEST(Exporter, IpiMocapStudioIsKnownByItsOwnNames) {
  const Capture capture = read_ok(chain(kOwnNames, "\t", "0.0333333000"));
  EXPECT_EQ(capture.exporter.choice, "iPi Mocap Studio, own names");
  EXPECT_EQ(capture.exporter.confidence, Confidence::certain);
  const Diagnostic* note = find(capture.diagnostics, "bvh-exporter");
  ASSERT_NE(note, nullptr);
  EXPECT_EQ(note->severity, Severity::note);
  EXPECT_NE(note->message.find("iPi Mocap Studio"), std::string::npos);
}

TEST(Exporter, IpisSecondPresetIsKnownByHowItIsWritten) {
  const Capture ipi = read_ok(chain(kMotionBuilder, "\t", "0.0333333000"));
  EXPECT_EQ(ipi.exporter.choice,
            "iPi Mocap Studio, MotionBuilder's names with a rest pose as frame 0");
  EXPECT_EQ(ipi.exporter.confidence, Confidence::likely);
  const Capture other = read_ok(chain(kMotionBuilder, " ", "0.033333"));
  EXPECT_EQ(other.exporter.choice, "MotionBuilder's names with a rest pose as frame 0");
  EXPECT_EQ(other.exporter.confidence, Confidence::guess);
}

TEST(Exporter, OthersAreNot) {
  for (const auto& names : {std::vector<std::string>{"Hip", "LowerSpine", "MiddleSpine"},
                            {"Hips", "LowerSpine", "MiddleSpine", "Chest"},
                            {"a", "b", "c"}}) {
    const Capture capture = read_ok(chain(names, " ", "0.04"));
    EXPECT_EQ(capture.exporter.choice, "");
    EXPECT_EQ(find(capture.diagnostics, "bvh-exporter"), nullptr);
  }
}

}  // namespace
}  // namespace krok::bvh
