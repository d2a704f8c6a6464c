// If these fail, one file of a batch destroys the result of another, or which of them wins depends
// on the threads.
#include "cli/batch/batch_fixture.h"
#include "support/glb_builder.h"

namespace krok::test {
namespace {

class BatchClips : public BatchTest {
 protected:
  // A character with animations of these names.
  void put_character(const std::string& name, const Names& clips) const {
    std::filesystem::create_directories((folder_ / name).parent_path());
    GlbBuilder builder = rig();
    const Json bend = builder.json["animations"][0];
    builder.json["animations"] = Json::array();
    for (const std::string& clip : clips) {
      builder.json["animations"].push_back(bend);
      builder.json["animations"].back()["name"] = clip;
    }
    if (clips.empty()) builder.json.erase("animations");
    const auto bytes = builder.glb();
    put(name, std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
  }
  void put_parts() const {
    put("parts.json",
        R"({"schema": "krok.sequences/1", "sequences": [{"name": "run", "first": 0, "last": 3}]})");
  }
};

TEST_F(BatchClips, TwoFilesDoNotShareAResult) {
  put_character("in/a.glb", {"b_c", "x"});
  put_character("in/a_b.glb", {"c", "y"});
  for (const char* jobs : {"1", "4"}) {
    std::filesystem::remove_all(path("out"));
    const ToolRun run =
        import({"in", "--clip", "all", "--out-dir", "out", "--keep-going", "-j", jobs});
    EXPECT_EQ(run.exit_code, 3) << run.err;
    EXPECT_NE(run.err.find("in/a.glb and in/a_b.glb would both be written to out/a_b_c.anim"),
              std::string::npos)
        << run.err;
    EXPECT_EQ(files_below("out"), (Names{"a_b_c.anim", "a_x.anim"}));
  }
  // What stands already belongs to its file too, and the other one gets none of its results.
  const ToolRun again =
      import({"in", "--clip", "all", "--out-dir", "out", "--keep-going", "--json"});
  EXPECT_EQ(again.exit_code, 3);
  EXPECT_EQ(counts(again.out), (Counts{{"unchanged", 1}, {"failed", 1}}));
  EXPECT_EQ(Json::parse(again.out)["files"][1]["outputs"], Json::array());
}

TEST_F(BatchClips, AClipDoesNotTakeTheNameThatAnotherLineHas) {
  put_character("a.glb", {"walk"});
  put_character("b.glb", {"turn"});
  put("list.tsv", "a.glb\ta_{clip}.anim\t--clip all\nb.glb\ta_walk.anim\n");
  const ToolRun run = import({"--manifest", "list.tsv", "--keep-going"});
  EXPECT_EQ(run.exit_code, 3) << run.err;
  EXPECT_NE(run.err.find("a_walk.anim would also be written by b.glb"), std::string::npos)
      << run.err;
}

TEST_F(BatchClips, ClipsOfTheirOwnAreDoneAndKnownLater) {
  put_character("in/a.glb", {"x", "y"});
  put_character("in/b.glb", {"x"});
  ASSERT_EQ(import({"in", "--clip", "all", "--out-dir", "out"}).exit_code, 0);
  EXPECT_EQ(files_below("out"), (Names{"a_x.anim", "a_y.anim", "b_x.anim"}));
  const ToolRun again = import({"in", "--clip", "all", "--out-dir", "out", "--json"});
  EXPECT_EQ(counts(again.out), (Counts{{"unchanged", 2}}));
  // As a run of its own does it.
  ASSERT_EQ(import({"in/a.glb", "--clip", "all", "-o", "own_{clip}.anim"}).exit_code, 0);
  EXPECT_TRUE(get(path("own_y.anim")) == get(path("out/a_y.anim")));
}

// "w" and "w_run" stand in one folder, and the part "run" of the first would be the second.
TEST_F(BatchClips, ASequenceDoesNotReplaceAnotherInput) {
  put_capture("w.bvh", 8);
  put_capture("x.bvh", 9);
  ASSERT_EQ(import({"w.bvh", "x.bvh", "--out-dir", "in"}).exit_code, 0);
  std::filesystem::rename(path("in/x.anim"), path("in/w_run.anim"));
  put_parts();
  const std::string before = get(path("in/w_run.anim"));
  const ToolRun run = tool("krok-edit", {"in/w.anim", "in/w_run.anim", "--sequences", "parts.json",
                                         "--out-dir", "in", "--json"});
  EXPECT_EQ(run.exit_code, 2) << run.err;
  EXPECT_NE(run.err.find("in/w_run.anim: error: is an input and would be overwritten"),
            std::string::npos)
      << run.err;
  EXPECT_TRUE(get(path("in/w_run.anim")) == before);
  EXPECT_EQ(Json::parse(run.out)["files"][0]["outputs"], Json::array());
}

TEST_F(BatchClips, ACharacterWithoutAnAnimationGivesItsModel) {
  put_character("in/moves.glb", {"walk"});
  put_character("in/still.glb", {});
  const ToolRun run = import({"in", "--out-dir", "out", "--save-model", "{name}.model"});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_NE(run.err.find("in/still.glb: warning: the file has no animations"), std::string::npos)
      << run.err;
  EXPECT_EQ(files_below("out"), (Names{"moves.anim", "moves.model", "still.model"}));
  // As a run of its own does it.
  ASSERT_EQ(import({"in/still.glb", "--save-model", "own.model"}).exit_code, 0);
  EXPECT_TRUE(get(path("own.model")) == get(path("out/still.model")));
  const ToolRun again =
      import({"in", "--out-dir", "out", "--save-model", "{name}.model", "--json"});
  EXPECT_EQ(counts(again.out), (Counts{{"unchanged", 2}}));
  // Without anything to write of it, it is an error as ever.
  EXPECT_EQ(import({"in", "--out-dir", "other"}).exit_code, 2);
}

}  // namespace
}  // namespace krok::test
