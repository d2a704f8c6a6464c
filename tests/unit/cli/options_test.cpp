// If these fail, options are read into other values than they say, or a mistake in one is answered
// without its name, its value or its range.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tools/cli/command_line.h"
#include "tools/cli/option_kinds.h"

namespace krok::cli {
namespace {

using testing::ElementsAre;

struct Options {
  double stretch = 0, turn = 0;
  std::optional<double> width;
  ClipTime at;
  std::vector<Vec3> places;
  std::optional<double> smooth;
  int every = 0;
  std::string chart;
  bool labels = true;
};

class OptionKinds : public testing::Test {
 protected:
  // The message of the mistake, or empty.
  std::string parse(const std::vector<std::string>& arguments) {
    ToolSpec spec;
    spec.name = "krok-test";
    spec.needs_output = false;
    spec.declare = [this](CommandOptions& command) {
      options = {};
      command.add("--stretch", options.stretch, length({0, 0.1}), "", "2cm");
      command.add("--turn", options.turn, angle({-90, 90}), "", "15deg");
      command.add("--width", options.width, length_with_unit(kPositive), "").not_with("--stretch");
      command.add("--at", options.at, clip_time(), "", "10f");
      command.add("--place", options.places, lengths<Vec3>(), "").only_with({"--at", "--every 3"});
      command.add("--smooth", options.smooth, or_word("auto", number({0, 1})), "", "auto");
      command.add("--every", options.every, whole(1, 9), "", "1");
      command.add("--chart OUT.svg", options.chart, output({".svg"}), "");
      command.add_no_flag("--no-labels", options.labels, "");
    };
    const auto wish = CommandLine(spec, CommandLine::Form::single).parse(arguments);
    return wish ? std::string() : wish.error().message;
  }

  Options options;
};

TEST_F(OptionKinds, DefaultsAreReadAsWritten) {
  EXPECT_EQ(parse({}), "");
  EXPECT_DOUBLE_EQ(options.stretch, 0.02);
  EXPECT_DOUBLE_EQ(options.turn, 15 * kRadiansPerDegree);
  EXPECT_FALSE(options.width);
  EXPECT_TRUE(options.at.in_frames);
  EXPECT_FALSE(options.smooth);
  EXPECT_EQ(options.every, 1);
  EXPECT_TRUE(options.labels);
}

TEST_F(OptionKinds, ValuesAreReadIntoMetresAndRadians) {
  EXPECT_EQ(parse({"--stretch", "5cm", "--turn=-90", "--at", "250ms", "--place", "1m,0,-20cm",
                   "--place", "0,0,0", "--smooth", "0.5", "--no-labels", "--chart", "a.SVG"}),
            "");
  EXPECT_DOUBLE_EQ(options.stretch, 0.05);
  EXPECT_DOUBLE_EQ(options.turn, -90 * kRadiansPerDegree);
  EXPECT_DOUBLE_EQ(options.at.value, 0.25);
  EXPECT_THAT(options.places, ElementsAre(Vec3(1, 0, -0.2), Vec3(0, 0, 0)));
  EXPECT_EQ(options.smooth, 0.5);
  EXPECT_FALSE(options.labels);
  EXPECT_EQ(parse({"--smooth", "auto"}), "");
  EXPECT_FALSE(options.smooth);
}

TEST(SpeedOption, IsInMetresPerSecondOrKilometresPerHour) {
  const ValueKind<double> speed = number({0.1, 12}, "m/s");
  EXPECT_DOUBLE_EQ(speed.read("3m/s").value(), 3);
  EXPECT_DOUBLE_EQ(speed.read("5.4km/h").value(), 1.5);
  EXPECT_DOUBLE_EQ(speed.read("5.4 km/h").value(), 1.5);
  EXPECT_DOUBLE_EQ(speed.read("1.4").value(), 1.4);
  EXPECT_FALSE(speed.read("50km/h"));
  EXPECT_FALSE(speed.read("2 ")) << "a blank is for a unit alone";
  EXPECT_FALSE(number({0, 9}, "mm").read("5km/h"));
}

// Would fail if a quarter turn in radians turned by 1.57 degrees without a word.
TEST_F(OptionKinds, AnglesThatLookLikeRadiansNeedAUnit) {
  for (const char* turn : {"1.57", "-1.5707", "3.14", "3.1416", "0.785", "0.52", "6.28"}) {
    EXPECT_EQ(parse({"--turn", turn}), std::string("--turn: '") + turn + "' has no unit");
  }
  for (const char* turn : {"1.57rad", "1.57deg", "2.25", "1.5", "45", "0", "0.01", "31.42"}) {
    EXPECT_EQ(parse({"--turn", turn}), "") << turn;
  }
}

TEST(RateOption, IsANumberOrAFraction) {
  EXPECT_DOUBLE_EQ(rate().read("30000/1001").value(), 30000.0 / 1001);
  EXPECT_DOUBLE_EQ(rate().read("24 fps").value(), 24);
  for (const char* text : {"30/0", "/30", "30/", "30/1/1"}) EXPECT_FALSE(rate().read(text)) << text;
}

TEST_F(OptionKinds, MistakesNameOptionValueAndRange) {
  EXPECT_EQ(parse({"--stretch", "1"}), "--stretch: '1' is not a length from 0 to 0.1 m");
  EXPECT_EQ(parse({"--turn", "91deg"}), "--turn: '91deg' is not an angle from -90 to 90 degrees");
  EXPECT_EQ(parse({"--width", "0mm"}), "--width: '0mm' is not a length greater than 0");
  EXPECT_EQ(parse({"--width", "3"}), "--width: '3' has no unit");
  EXPECT_EQ(parse({"--at", "-1s"}), "--at: '-1s' is not a time of 0 or more");
  EXPECT_EQ(parse({"--at", "0", "--place", "1,2"}),
            "--place: '1,2' has too few values, 2, separated by ','");
  EXPECT_EQ(parse({"--every", "010x"}), "--every: '010x' is not an integer from 1 to 9");
  EXPECT_EQ(parse({"--chart", "a.png"}), "--chart: the output is a .svg file, not a.png");
}

TEST_F(OptionKinds, OptionsNeedAndExcludeOthers) {
  EXPECT_EQ(parse({"--place", "1,2,3"}), "--place is for --at or --every 3");
  EXPECT_EQ(parse({"--place", "1,2,3", "--every", "3"}), "");
  EXPECT_EQ(parse({"--width", "1m", "--stretch", "1cm"}),
            "--stretch and --width exclude each other");
}

}  // namespace
}  // namespace krok::cli
