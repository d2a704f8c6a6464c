// If these fail, a description asks for one measure and another is taken.

#include "parametric/parameter.h"

#include <gmock/gmock.h>

#include <cmath>

#include "math/transform.h"

namespace krok::parametric {
namespace {

using testing::HasSubstr;

const std::vector<std::string> kKeytimes = {"stance_strike", "swing_off", "swing_strike"};

Skeleton skeleton() {
  Skeleton result;
  result.add("Hips", Skeleton::kNoParent, {});
  result.add("mixamorig:Left.Hand", 0, {});
  return result;
}

TEST(Parameter, NamesAreReadAndWrittenAlike) {
  for (const char* name :
       {"step.length", "step.width", "step.height", "step.turn", "step.path_turn", "duration",
        "step.length@swing_off", "Hips.up@swing_off", "mixamorig:Left.Hand.across@stance_strike",
        "mixamorig:Left.Hand.along@swing_strike"}) {
    const auto parameter = parse_parameter(name, skeleton(), kKeytimes);
    ASSERT_TRUE(parameter.ok()) << name << ": " << parameter.error().message;
    EXPECT_EQ(name_of(*parameter, skeleton(), kKeytimes), name);
  }
}

TEST(Parameter, HasTheUnitAndToleranceOfItsQuantity) {
  const auto parsed = [](const char* name) {
    return *parse_parameter(name, skeleton(), kKeytimes);
  };
  EXPECT_EQ(unit_of(parsed("step.length")), "m");
  EXPECT_EQ(unit_of(parsed("Hips.up@swing_off")), "m");
  EXPECT_EQ(unit_of(parsed("step.turn")), "rad");
  EXPECT_EQ(unit_of(parsed("duration")), "s");
  EXPECT_EQ(parsed("step.width").tolerance, 1e-3);
  EXPECT_EQ(parsed("step.turn").tolerance, 0.1 * kRadiansPerDegree);
  EXPECT_EQ(parsed("duration").tolerance, 1e-3);
  EXPECT_EQ(parsed("step.length").keytime, 2);
  EXPECT_EQ(parsed("Hips.up@swing_off").keytime, 1);
  EXPECT_EQ(parsed("Hips.up@swing_off").joint, 0);
  EXPECT_EQ(parsed("Hips.across@swing_off").direction, Direction::across);
}

TEST(Parameter, SaysWhatIsNotThere) {
  const auto message = [](const char* name) {
    const auto parameter = parse_parameter(name, skeleton(), kKeytimes);
    if (parameter.ok()) return std::string("fine");
    EXPECT_EQ(parameter.error().code, "parametric-parameter");
    return parameter.error().message;
  };
  EXPECT_THAT(message("step.depth"), HasSubstr("unknown parameter step.depth"));
  EXPECT_THAT(message(""), HasSubstr("unknown parameter"));
  EXPECT_THAT(message("@"), HasSubstr("unknown parameter"));
  EXPECT_THAT(message("Head.up@swing_off"), HasSubstr("no joint Head"));
  EXPECT_THAT(message(".up@swing_off"), HasSubstr("no joint"));
  EXPECT_THAT(message("Hips.up"), HasSubstr("has no valid keytime"));
  EXPECT_THAT(message("Hips.up@strike"), HasSubstr("has no valid keytime"));
  EXPECT_THAT(message("step.length@strike"), HasSubstr("has no valid keytime"));
  EXPECT_THAT(message("duration@swing_off"), HasSubstr("has no valid keytime"));
}

TEST(Parameter, CheckFindsWhatMeasuresNothing) {
  const Parameter length = *parse_parameter("step.length", skeleton(), kKeytimes);
  const auto holds = [&](const auto& change) {
    std::vector<Parameter> all = {length,
                                  *parse_parameter("Hips.up@swing_off", skeleton(), kKeytimes)};
    change(all);
    const Status status = check(all, skeleton(), kKeytimes);
    if (!status) {
      EXPECT_EQ(status.error().code, "parametric-parameter");
    }
    return status.ok();
  };
  using All = std::vector<Parameter>;
  EXPECT_TRUE(holds([](All&) {}));
  EXPECT_FALSE(holds([](All& all) { all.clear(); }));
  EXPECT_FALSE(holds([](All& all) { all[1].joint = -1; }));
  EXPECT_FALSE(holds([](All& all) { all[1].joint = 2; }));
  EXPECT_FALSE(holds([](All& all) { all[0].keytime = 3; }));
  EXPECT_FALSE(holds([](All& all) { all[0].keytime = -1; }));
  EXPECT_FALSE(holds([](All& all) { all[0].tolerance = 0; }));
  EXPECT_FALSE(holds([](All& all) { all[0].tolerance = std::nan(""); }));
  EXPECT_FALSE(holds([](All& all) { all[0].quantity = static_cast<Quantity>(9); }));
  EXPECT_FALSE(holds([](All& all) { all[1].direction = static_cast<Direction>(3); }));
  EXPECT_FALSE(holds([](All& all) { all[1] = all[0]; }));
  // The same measure with another tolerance is the same measure.
  EXPECT_FALSE(holds([](All& all) {
    all[1] = all[0];
    all[1].tolerance = 1;
  }));
}

}  // namespace
}  // namespace krok::parametric
