#pragma once

#include <string>
#include <vector>

#include "cli/fixture.h"

namespace krok::test {

// in.model is a body and in.anim its motion; frame 15 of it is the one target "bent" of the mesh in
// bent.exr, and bent.glb what that looks like.
class BentBody : public CliTest {
 protected:
  void SetUp() override {
    put("in.bvh", capture(20));
    tool("krok-import", {"in.bvh", "-o", "in.anim"});
    tool("krok-body", {"in.anim", "--detail", "low", "-o", "in.model"});
    tool("krok-skin", {"in.model", "in.anim", "--as", "pose", "--time", "15f", "-o", "bent.obj"});
    tool("krok-skin", {"in.model", "in.anim", "--as", "pose", "--time", "15f", "-o", "bent.glb"});
    tool("krok-morph", {"pack", "in.model", "bent.obj", "-o", "bent.exr"});
  }

  ToolRun tool(const std::string& name, const std::vector<std::string>& arguments,
               int expected = 0) {
    ToolOptions here;
    here.folder = folder_.string();
    const ToolRun run = run_tool(name, arguments, here);
    EXPECT_EQ(run.exit_code, expected) << name << " " << run.out << run.err;
    return run;
  }

  void expect_same(const std::string& a, const std::string& b) {
    tool("krok-diff", {a, b, "--tolerance", "0.01mm", "--angle", "0.05deg"});
  }
};

}  // namespace krok::test
