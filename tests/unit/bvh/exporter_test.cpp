// If these fail, files of iPi Mocap Studio are not named as such, or others are.

#include "unit/bvh/bvh_text.h"

namespace krok::bvh {
namespace {

std::string chain(const std::vector<std::string>& names) {
  std::string text = "HIERARCHY\n";
  for (const std::string& name : names) {
    text += (&name == &names[0] ? "ROOT " : "JOINT ") + name +
            "\n{\nOFFSET 0 1 0\nCHANNELS 3 Xrotation Yrotation Zrotation\n";
  }
  text += "End Site\n{\nOFFSET 0 1 0\n}\n";
  for (std::size_t i = 0; i < names.size(); ++i) text += "}\n";
  return text + motion(0, "");
}

TEST(Exporter, IpiMocapStudioIsKnownByItsSpine) {
  const Capture capture = read_ok(chain({"Hip", "LowerSpine", "MiddleSpine", "Chest", "Neck"}));
  const Diagnostic* note = find(capture.diagnostics, "bvh-exporter");
  ASSERT_NE(note, nullptr);
  EXPECT_EQ(note->severity, Severity::note);
  EXPECT_EQ(note->message, "5 joints with the names that iPi Mocap Studio gives");
}

TEST(Exporter, OthersAreNot) {
  for (const auto& names : {std::vector<std::string>{"Hip", "LowerSpine", "MiddleSpine"},
                            {"Hips", "LowerSpine", "MiddleSpine", "Chest"},
                            {"Root", "Hip", "LowerSpine", "MiddleSpine", "Chest"}}) {
    EXPECT_EQ(find(read_ok(chain(names)).diagnostics, "bvh-exporter"), nullptr);
  }
}

}  // namespace
}  // namespace krok::bvh
