// If these fail, a library of steps backward makes walks that turn about and go forward, or whose
// feet are elsewhere than their prints.

#include <gtest/gtest.h>

#include "core/index.h"
#include "gait/plan_prints.h"
#include "motion/hips_root.h"
#include "parametric/thin_out.h"
#include "walkers.h"

namespace krok::gait {
namespace {

StepLibrary library_of_gait(parametric::StepGait gait, bool backward, double length) {
  std::vector<parametric::test::KeyedWalk> walks;
  for (const double turn : {-0.2, 0.0, 0.2}) {
    for (const double by : {-0.1, 0.0, 0.1}) {
      samples::WalkOptions options;
      options.steps = 6;
      options.step_length = length > 0 ? length + by : 0;
      options.turn = length > 0 ? turn : 0.5 + turn;
      options.backward = backward;
      walks.push_back(parametric::test::keyed_walk(options));
    }
  }
  parametric::CutOptions options;
  options.gait = gait;
  options.outlier = 0;
  auto library = parametric::test::library_of(walks, {"step.length", "step.turn"}, options).library;
  std::vector<parametric::Example> kept;
  for (const int i : parametric::thin_out(library, 0.1)) kept.push_back(library.examples[at(i)]);
  library.examples = std::move(kept);
  return test::walking_library(std::move(library), "steps");
}

TEST(BackwardWalk, FacesWhereItComesFrom) {
  std::vector<StepLibrary> libraries;
  libraries.push_back(library_of_gait(parametric::StepGait::backward, true, 0.45));
  const auto options = usual_steps(libraries);
  ASSERT_TRUE(options.ok()) << options.error().message;
  EXPECT_TRUE(options->backward);
  EXPECT_NEAR(options->step_length, 0.45, 0.04);  // of the examples kept
  EXPECT_GT(options->max_step, 0.5);
  // A way in a curve of 3 m radius.
  std::vector<PathPoint> way;
  for (int i = 0; i <= 20; ++i) {
    const double angle = 0.05 * i;
    way.push_back({3 - 3 * std::cos(angle), 3 * std::sin(angle), {}});
  }
  const auto path = Path::create(way);
  ASSERT_TRUE(path.ok()) << path.error().message;
  const test::Ground level([](double, double) { return 0.0; });
  const auto planned = plan_prints(*path, level, *options);
  ASSERT_TRUE(planned.ok()) << planned.error().message;
  const auto made = walk(libraries, planned->prints, level, WalkOptions());
  ASSERT_TRUE(made.ok()) << made.error().message;
  const Clip& clip = made->clip;
  const int hips = carrying_joint(find_roles(clip.skeleton));
  const int last = clip.frame_count() - 1;
  const GroundFrame begin = ground_frame(clip, hips, 0), end = ground_frame(clip, hips, last);
  EXPECT_NEAR(std::hypot(end.x - (3 - 3 * std::cos(1)), end.z - 3 * std::sin(1)), 0, 0.2);
  EXPECT_NEAR(std::abs(wrapped(begin.heading)), kPi, 0.1);
  EXPECT_NEAR(wrapped(end.heading - 1 - kPi), 0, 0.1);
  // Never across the way or along it: it goes backward all the time.
  for (int f = 10; f + 10 <= last; f += 10) {
    const GroundFrame from = ground_frame(clip, hips, f - 10),
                      to = ground_frame(clip, hips, f + 10);
    const double way_x = to.x - from.x, way_z = to.z - from.z;
    if (std::hypot(way_x, way_z) < 0.05) continue;
    const double angle = wrapped(std::atan2(way_x, way_z) - ground_frame(clip, hips, f).heading);
    EXPECT_GT(std::abs(angle), 2.2) << f;
  }
  for (std::size_t k = 0; k < planned->prints.size(); ++k) {
    const Print& print = planned->prints[k];
    const auto& foot = libraries[0].library().foot(print.side);
    const GroundedPrint& grounded = made->details.prints[k];
    const double flat =
        k + 2 < planned->prints.size() ? 0.5 * (grounded.strike + grounded.off) : last / clip.rate;
    const auto f = static_cast<int>(std::lround(flat * clip.rate));
    std::vector<Transform> pose(clip.skeleton.names.size());
    clip.get_pose(std::clamp(f, 0, last), pose);
    const Vec3 heel = pose[at(foot.joint)] * foot.heel;
    EXPECT_NEAR(heel.x(), print.x, 0.03) << k;
    EXPECT_NEAR(heel.z(), print.z, 0.03) << k;
  }
}

// Steps on the spot cannot follow a path: said, rather than planned with steps of no length.
TEST(BackwardWalk, TurnsOnTheSpotFollowNoPath) {
  std::vector<StepLibrary> libraries;
  libraries.push_back(library_of_gait(parametric::StepGait::turn, false, 0));
  const auto options = usual_steps(libraries);
  ASSERT_FALSE(options.ok());
  EXPECT_EQ(options.error().code, "walk-library");
}

}  // namespace
}  // namespace krok::gait
