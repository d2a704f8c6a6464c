// If these fail, a file that a stranger sends can write escape sequences to the terminal of whoever
// looks at it, or hide what an error says.

#include <gmock/gmock.h>

#include "cli/motion_fixture.h"

namespace krok::test {
namespace {

class NastyNames : public MotionTest {
 protected:
  static constexpr const char* kNasty =
      "a\xc2\x9b"
      "31mb\xe2\x80\xae";

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

}  // namespace
}  // namespace krok::test
