// If these fail, a file that a stranger sends can write escape sequences to the terminal of whoever
// looks at it, or hide what an error says.

#include <gmock/gmock.h>

#include "cli/motion_fixture.h"

namespace krok::test {
namespace {

class NastyNames : public MotionTest {
 protected:
  static constexpr const char* kNasty =
      "=a\x1b[31m\xc2\x9b"
      "31mb\n\xe2\x80\xae</script><script>alert(1)</script>";

  void SetUp() override {
    Clip clip = write_walk(2);
    clip.skeleton.names[4] = kNasty;
    write("nasty.anim", clip);
    put("limits.json",
        R"({"schema": "krok.limits/1", "joints": {"\u001b[31m\u009b": {"kind": "\u009b"}}})");
    put("goals.json", R"({"schema": "krok.goals/1", "\u009b31m": "\u001b[31m"})");
    put("broken.json", "{\"a\x1b[31m\xc2\x9b\": \xc2\x9b}");
    put("steps.csv",
        "time,\x1b[31mx\xc2\x9b\n0,\xc2\x9b"
        "1\n");
    put("nasty.bvh",
        "HIERARCHY\nROOT a\xc2\x9b\n{\nOFFSET 0 0 0\nCHANNELS 3 \xc2\x9bposition Yposition "
        "Zposition\n"
        "End Site\n{\nOFFSET 0 1 0\n}\n}\nMOTION\nFrames: 1\nFrame Time: 0.03\n0 0 0\n");
  }
};

// Reports, tables, warnings and the quotes in syntax errors, of every kind of page.
TEST_F(NastyNames, ReachNoTerminal) {
  const std::vector<std::vector<std::string>> runs = {
      {"krok-info", "nasty.anim", "-v"},
      {"krok-info", "nasty.anim", "--json"},
      {"krok-import", "nasty.bvh", "-o", "out.anim", "-v"},
      {"krok-import", "nasty.bvh", "-o", "out.anim", "--map", "limits.json"},
      {"krok-diff", "walk.anim", "nasty.anim"},
      {"krok-diff", "walk.anim", "nasty.anim", "--json"},
      {"krok-ik", "nasty.anim", "--reach", "zz=0,0,0@0s", "-o", "out.anim"},
      {"krok-ik", "walk.anim", "--limits", "limits.json", "--goals", "goals.json", "-o",
       "out.anim"},
      {"krok-ik", "walk.anim", "--goals", "goals.json", "-o", "out.anim"},
      {"krok-ik", "walk.anim", "--goals", "broken.json", "-o", "out.anim"},
      {"krok-ragdoll", "walk.anim", "--bodies", "broken.json", "-o", "out.anim"},
      {"krok-ragdoll", "walk.anim", "--limits", "limits.json", "-o", "out.anim"},
      {"krok-mix", "broken.json", "-o", "out.anim"},
      {"krok-fit", "broken.json", "-o", "out.steps"},
      {"krok-walk", "broken.json", "-o", "out.anim"},
      {"krok-plot", "steps.csv", "-o", "out.svg"},
      {"krok-retarget", "nasty.anim", "--onto", "walk.anim", "-o", "out.anim", "-v"},
      {"krok-keys", "nasty.anim", "-o", "out.json", "-v"},
      {"krok-edit", "nasty.anim", "-o", "out.anim", "--scale", "2", "-v"}};
  for (const auto& words : runs) {
    const ToolRun run = run_here(words[0], {words.begin() + 1, words.end()});
    for (const char* what : {"\x1b", "\xc2\x9b", "\xe2\x80\xae"}) {
      EXPECT_EQ((run.out + run.err).find(what), std::string::npos)
          << words[0] << " " << words[1] << ": " << run.out << run.err;
    }
    EXPECT_FALSE((run.out + run.err).empty() && run.exit_code != 0) << words[0];
  }
}

// What is written to be looked at, or to be read by another program, has the name without what a
// terminal, a browser or a spreadsheet would run.
TEST_F(NastyNames, ReachNoFile) {
  const std::vector<std::vector<std::string>> runs = {
      {"krok-export", "nasty.anim", "-o", "out.csv"},
      {"krok-export", "nasty.anim", "-o", "out.bvh"},
      {"krok-export", "nasty.anim", "-o", "out.gltf"},
      {"krok-plot", "nasty.anim", "--joint", "*", "-o", "out.svg"},
      {"krok-plot", "out.csv", "--y", "y", "-o", "table.svg"},
      {"krok-view", "nasty.anim", "--body", "none", "-o", "out.html"},
      {"krok-keys", "nasty.anim", "-o", "out.keys.json", "--plot", "keys.svg"},
      {"krok-ik", "nasty.anim", "--learn-limits", "walk.anim", "--save-limits", "out.limits.json"},
      {"krok-import", "out.gltf", "-o", "back.anim", "--json=report.json"}};
  for (const auto& words : runs) {
    const ToolRun run = run_here(words[0], {words.begin() + 1, words.end()});
    EXPECT_LE(run.exit_code, 2);
  }
  int files = 0;
  for (const std::string& name : listing()) {
    if (name.starts_with("nasty") || name.ends_with(".anim") || name == "goals.json" ||
        name == "limits.json" || name == "broken.json" || name == "steps.csv") {
      continue;
    }
    ++files;
    const std::string text = get(path(name));
    std::vector<std::string> wrong = {"\x1b", "\xc2\x9b", "\xe2\x80\xae"};
    if (name.ends_with(".csv")) wrong.insert(wrong.end(), {"\n=a", ",=a", "\"=a"});
    if (name.ends_with(".svg") || name.ends_with(".html")) wrong.emplace_back("<script>alert");
    for (const std::string& what : wrong) {
      EXPECT_EQ(text.find(what), std::string::npos) << name << " has " << what;
    }
  }
  EXPECT_GE(files, 7);
  // The name is still the same where a format can say it.
  EXPECT_EQ(read("back.anim").skeleton.names[4], read("nasty.anim").skeleton.names[4]);
}

}  // namespace
}  // namespace krok::test
