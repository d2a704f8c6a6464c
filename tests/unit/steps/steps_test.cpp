// If these fail, a step library that went into a file makes other motions when it comes out, or a
// file that is none gets in.

#include "formats/steps/steps.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <functional>
#include <limits>

#include "golden/samples/samples.h"
#include "parametric/synthesise.h"
#include "rbf/weight_solver.h"
#include "unit/parametric/walks.h"

namespace krok::steps {
namespace {

using testing::HasSubstr;

// Nine steps cut out of generated walks, with their weights.
StepsFile walk_library(rbf::Kernel kernel, double smoothing = 0) {
  StepsFile file;
  file.library = parametric::test::library_of(parametric::test::grid_walks(false),
                                              {"step.length", "step.height"}, {.mirror = false})
                     .library;
  std::vector<double> parameters;
  for (const auto& example : file.library.examples) {
    parameters.insert(parameters.end(), example.parameters.begin(), example.parameters.end());
  }
  const auto solver = rbf::WeightSolver::create(2, parameters, {kernel, {}, {}, smoothing});
  EXPECT_TRUE(solver.ok());
  file.weights = solver->function();
  return file;
}

TEST(Steps, ALibraryFromAFileMakesTheSameMotions) {
  for (const rbf::Kernel kernel : {rbf::Kernel::cubic, rbf::Kernel::wendland}) {
    const StepsFile file = walk_library(kernel);
    const auto back = read(samples::bytes_of(file));
    ASSERT_TRUE(back.ok()) << back.error().message;
    EXPECT_EQ(back->weights, file.weights);
    const auto before = parametric::Synthesiser::create(file.library, *file.weights);
    const auto after = parametric::Synthesiser::create(back->library, *back->weights);
    ASSERT_TRUE(before.ok() && after.ok());
    const std::vector<double> asked = {0.55, 0.03};
    const auto first = before->weights(asked), second = after->weights(asked);
    ASSERT_TRUE(first.ok() && second.ok());
    EXPECT_EQ(first->weights, second->weights);
    for (std::size_t d = 0; d < asked.size(); ++d) {
      EXPECT_NEAR(first->parameters[d], second->parameters[d], 2e-6);
    }
    const auto one = before->motion(first->weights)->make(),
               other = after->motion(second->weights)->make();
    ASSERT_EQ(one->clip.positions.size(), other->clip.positions.size());
    for (std::size_t i = 0; i < one->clip.positions.size(); ++i) {
      EXPECT_LT((one->clip.positions[i] - other->clip.positions[i]).norm(), 5e-6f);
    }
  }
}

// Without it points would be inserted into another function.
TEST(Steps, SmoothingIsKept) {
  const StepsFile file = walk_library(rbf::Kernel::cubic, 0.1);
  const auto back = read(samples::bytes_of(file));
  ASSERT_TRUE(back.ok()) << back.error().message;
  EXPECT_EQ(back->weights->smoothing, 0.1);
  EXPECT_EQ(back->weights, file.weights);
  StepsFile odd = file;
  odd.weights->smoothing = -1;
  EXPECT_EQ(check(odd).error().code, "rbf-number");
}

// Without it steps would sink into the floor that their captures stand on.
TEST(Steps, TheGroundOfTheCapturesIsKept) {
  StepsFile file = walk_library(rbf::Kernel::cubic);
  file.library.ground = 0.0215;
  file.library.feet[0].toe_out = 0.1;
  const auto back = read(samples::bytes_of(file));
  ASSERT_TRUE(back.ok()) << back.error().message;
  EXPECT_NEAR(back->library.ground, 0.0215, 1e-8);
  EXPECT_NEAR(back->library.feet[0].toe_out, 0.1, 1e-7);
}

// Without them a library of a skeleton with meaningless names is carried by another joint.
TEST(Steps, GivenRolesAreKept) {
  StepsFile file = walk_library(rbf::Kernel::cubic);
  const int spine = file.library.skeleton.find("Spine");
  ASSERT_GT(spine, 0);
  file.library.given_roles = {{spine, Role::helper, {}}};
  const auto bytes = samples::bytes_of(file);
  const auto back = read(bytes);
  ASSERT_TRUE(back.ok()) << back.error().message;
  ASSERT_EQ(back->library.given_roles.size(), 1u);
  EXPECT_EQ(back->library.given_roles[0].joint, spine);
  EXPECT_EQ(back->library.given_roles[0].role, Role::helper);
  EXPECT_EQ(samples::bytes_of(*back), bytes);
}

// Without them a walk could not be in one style of a mixed library.
TEST(Steps, StylesAreKept) {
  StepsFile file = walk_library(rbf::Kernel::cubic);
  const std::size_t without = samples::bytes_of(file).size();
  file.library.examples[1].style = "müde";
  const auto bytes = samples::bytes_of(file);
  EXPECT_GT(bytes.size(), without);
  const auto back = read(bytes);
  ASSERT_TRUE(back.ok()) << back.error().message;
  EXPECT_EQ(back->library.examples[0].style, "");
  EXPECT_EQ(back->library.examples[1].style, "müde");
  EXPECT_EQ(samples::bytes_of(*back), bytes);
  file.library.examples[1].style = std::string("a\0b", 3);
  EXPECT_EQ(check(file).error().code, "steps-shape");
}

TEST(Steps, ReadAndWrittenAgainItIsTheSameFile) {
  const auto bytes = samples::bytes_of(walk_library(rbf::Kernel::cubic));
  EXPECT_EQ(samples::bytes_of(*read(bytes)), bytes);
  // Nine steps of half a second and 29 joints.
  EXPECT_LT(bytes.size(), std::size_t{9} * 60 * 29 * 28);
  const auto exact = samples::bytes_of(walk_library(rbf::Kernel::cubic), OrientationEncoding::xyzw);
  const auto back = read(exact);
  ASSERT_TRUE(back.ok());
  EXPECT_EQ(back->library.examples[3].motion.orientations[7].coeffs(),
            walk_library(rbf::Kernel::cubic).library.examples[3].motion.orientations[7].coeffs());
}

TEST(Steps, WriterRefusesWhatIsNoLibrary) {
  const auto code = [](const std::function<void(StepsFile&)>& change) {
    StepsFile file = samples::step_library();
    change(file);
    auto out = OutputFile::create("/dev/null");
    const Status status = write(file, {}, *out);
    return status ? std::string() : status.error().code;
  };
  const double nan = std::nan("");
  EXPECT_EQ(code([](StepsFile&) {}), "");
  EXPECT_EQ(code([](StepsFile& f) { f.library.examples.clear(); }), "steps-shape");
  EXPECT_EQ(code([](StepsFile& f) { f.library.examples.pop_back(); }), "steps-shape");
  EXPECT_EQ(code([](StepsFile& f) { f.library.keytimes.pop_back(); }), "parametric-keytimes");
  EXPECT_EQ(code([](StepsFile& f) { f.library.keytimes[0] = ""; }), "parametric-keytimes");
  EXPECT_EQ(code([](StepsFile& f) { f.library.keytimes[0] = "\xFF"; }), "steps-shape");
  EXPECT_EQ(code([](StepsFile& f) { f.library.examples[1].name = std::string("a\0b", 3); }),
            "steps-shape");
  EXPECT_EQ(code([](StepsFile& f) { f.library.examples[1].name = ""; }), "parametric-example");
  EXPECT_EQ(code([&](StepsFile& f) { f.library.examples[1].parameters[0] = nan; }),
            "parametric-example");
  EXPECT_EQ(code([&](StepsFile& f) { f.library.examples[1].keytimes[0] = nan; }),
            "parametric-keytimes");
  EXPECT_EQ(code([](StepsFile& f) { f.library.examples[1].keytimes[1] = 1; }),
            "parametric-keytimes");
  EXPECT_EQ(code([](StepsFile& f) { f.library.examples[1].keytimes[1] = 0.005; }),
            "parametric-keytimes");
  EXPECT_EQ(code([](StepsFile& f) { f.library.examples[0].motion.resize(0); }),
            "parametric-example");
  EXPECT_EQ(code([](StepsFile& f) { f.library.examples[0].motion.skeleton.names[1] = "else"; }),
            "parametric-skeleton");
  EXPECT_EQ(code([](StepsFile& f) { f.library.examples[1].contacts[0].joint = 9; }), "keys-joint");
  EXPECT_EQ(code([](StepsFile& f) { f.library.feet[0].joint = 3; }), "parametric-feet");
  EXPECT_EQ(code([](StepsFile& f) { f.library.feet[1].forward *= 2; }), "parametric-feet");
  EXPECT_EQ(code([](StepsFile& f) { f.library.rate = 0; }), "clip-rate");
  EXPECT_EQ(code([](StepsFile& f) { f.library.parameters[0].keytime = 2; }),
            "parametric-parameter");
  EXPECT_EQ(code([](StepsFile& f) { f.library.parameters.clear(); }), "parametric-parameter");
  // Each example would have them in memory.
  EXPECT_EQ(
      code([](StepsFile& f) { f.library.skeleton.names[0].assign(std::size_t{40} << 20, 'x'); }),
      "steps-shape");
  EXPECT_EQ(code([](StepsFile& f) { f.weights->affine[0] = 2; }), "rbf-sum");
  EXPECT_EQ(code([](StepsFile& f) { f.weights->radii.clear(); }), "rbf-shape");
  EXPECT_EQ(code([](StepsFile& f) { f.report = "[]"; }), "steps-report");
  EXPECT_EQ(code([](StepsFile& f) { f.report = "{"; }), "steps-report");
  EXPECT_EQ(code([](StepsFile& f) { f.report = "{\"a\":\"\xFF\"}"; }), "steps-report");
}

// The place of a section in a file, by its name.
std::uint64_t offset_of(const std::vector<std::byte>& file, const std::string& name) {
  for (std::size_t entry = 64; entry + 32 <= file.size(); entry += 32) {
    char found[9] = {};
    std::memcpy(found, &file[entry], 8);
    if (name != found) continue;
    std::uint64_t offset;
    std::memcpy(&offset, &file[entry + 8], sizeof offset);
    return offset;
  }
  ADD_FAILURE() << "no section " << name;
  return 0;
}

TEST(Steps, ReaderNamesThePlaceOfWhatIsWrong) {
  const auto changed = [](const std::string& section, std::size_t at, auto value) {
    auto file = samples::bytes_of(samples::step_library());
    std::memcpy(&file[offset_of(file, section) + at], &value, sizeof value);
    samples::repair_header(file);
    const auto found = read(file);
    if (found.ok()) return std::string("fine");
    const auto place = static_cast<std::uint64_t>(found.error().where.byte_offset);
    const bool within = place >= offset_of(file, section) && place < file.size();
    return found.error().code + (within ? "" : " elsewhere");
  };
  const auto u32 = [](std::uint32_t value) { return value; };
  EXPECT_EQ(changed("INFO", 28, u32(7)), "fine");  // reserved
  EXPECT_EQ(changed("INFO", 8, u32(0)), "steps-shape");
  EXPECT_EQ(changed("INFO", 12, u32(1)), "steps-shape");
  EXPECT_EQ(changed("INFO", 16, u32(0)), "steps-shape");
  EXPECT_EQ(changed("INFO", 20, u32(65536)), "steps-shape");
  EXPECT_EQ(changed("INFO", 24, u32(2)), "steps-shape");
  EXPECT_EQ(changed("FEET", 0, u32(3)), "parametric-feet");
  EXPECT_EQ(changed("FEET", 56, -1.0), "parametric-feet");
  EXPECT_EQ(changed("PARAMS", 0, u32(7)), "steps-shape");
  EXPECT_EQ(changed("PARAMS", 16, 0.0), "parametric-parameter");
  EXPECT_EQ(changed("EXAMPLES", 8, u32(0)), "steps-shape");
  EXPECT_EQ(changed("EXAMPLES", 16, u32(2)), "steps-shape");
  EXPECT_EQ(changed("KEYTIMES", 0, 9.0), "parametric-keytimes");
  EXPECT_EQ(changed("MEASURED", 0, std::numeric_limits<double>::infinity()), "parametric-example");
  EXPECT_EQ(changed("CONTACTS", 0, u32(9)), "keys-joint");
  EXPECT_EQ(changed("WEIGHTS", 0, u32(5)), "steps-shape");
  EXPECT_EQ(changed("WEIGHTS", 8, std::uint64_t{1}), "steps-shape");
  EXPECT_EQ(changed("WEIGHTS", 8, std::uint64_t{5000}), "steps-shape");
  EXPECT_EQ(changed("REPORT", 0, '['), "steps-report");
}

TEST(Steps, ReaderTakesNoMemoryForCountsWithoutBytes) {
  auto file = samples::bytes_of(samples::step_library());
  const std::uint32_t many = 0x7FFFFFFF;
  std::memcpy(&file[offset_of(file, "EXAMPLES") + 8], &many, sizeof many);
  samples::repair_header(file);
  const auto found = read(file);
  ASSERT_FALSE(found.ok());
  EXPECT_EQ(found.error().code, "container-section");
}

TEST(Steps, OtherFilesAreNamed) {
  const auto motion = read(samples::bytes_of(samples::clip()));
  ASSERT_FALSE(motion.ok());
  EXPECT_THAT(motion.error().message, HasSubstr("is a Krok motion (.anim), not a .steps file"));
}

}  // namespace
}  // namespace krok::steps
