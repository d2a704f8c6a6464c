// One walk, stored in four ways: the hips as root, below a root that stands at the origin, above
// one that slides along on the ground, with a reference pose that lies. Every operation gives the
// same motion of them. If these fail, blends of captures whose root does not move with the body
// slide, sway or turn over, and what an operation gives depends on where a motion stands, on
// joints' own axes or on the reference pose.

#include <gtest/gtest.h>

#include <functional>

#include "blend/warp_by_shape.h"
#include "math/quaternion.h"
#include "motion/hips_root.h"
#include "motion/join.h"
#include "motion/loop.h"
#include "motion/mirror.h"
#include "motion/sample.h"
#include "motion/travel.h"
#include "parametric/cut_steps.h"
#include "parametric/synthesise.h"
#include "plant/plant_feet.h"
#include "rbf/weight_solver.h"
#include "timeline/mix.h"
#include "unit/blend/rigged_walks.h"

namespace krok {
namespace {

using blend::KeyedWalk;
using Walks = std::vector<KeyedWalk>;

constexpr double kSame = 1e-4;  // metres

enum class Moves : std::uint8_t { along, not_at_all, mirrored };

// What an operation makes of walks.
struct Operation {
  std::string name;
  std::function<Clip(const Walks&)> apply;
  Moves moves = Moves::along;  // how the result is moved where the walks are
  // How far it depends on joints' own axes, metres: where a sole is, is a median along each of
  // them.
  double by_axes = kSame;
};

RoleMap roles_of(const Walks& walks) {
  return find_roles(walks.front().clip.skeleton);
}

Clip blended(const Walks& walks, blend::Align align, bool by_shape) {
  const std::vector<blend::BlendInput> inputs = {
      blend::input_of(walks[0], blend::WeightCurve::constant(0.4)),
      blend::input_of(walks[1], blend::WeightCurve::constant(0.6))};
  blend::BlendOptions options;
  options.align = align;
  if (!by_shape) return blend::blended(inputs, blend::keytimes_of(inputs), options).clip;
  const std::vector<const Clip*> clips = {&walks[0].clip, &walks[1].clip};
  const auto found = blend::warp_by_shape(clips, roles_of(walks));
  EXPECT_TRUE(found.ok());
  return blend::blended(inputs, *found, options).clip;
}

Clip mixed(const Walks& walks, timeline::ChangeKind kind, timeline::Align align, bool layers) {
  timeline::Timeline timeline;
  for (int source = 0; source < 2; ++source) {
    timeline::BaseItem item;
    item.name = "walk";
    item.play.source = source;
    item.change.kind = kind;
    item.change.duration = kind == timeline::ChangeKind::cut ? 0 : 0.4;
    item.change.align = align;
    timeline.base.push_back(item);
  }
  if (layers) {
    for (const auto mode : {timeline::LayerMode::override, timeline::LayerMode::additive}) {
      timeline::Layer layer;
      layer.mode = mode;
      layer.mask.resize(2);
      layer.mask[0].joints = "Hips";
      layer.mask[0].weight = 0.5;
      layer.mask[1].below = "Spine";
      layer.mask[1].weight = 0.7;
      timeline::LayerItem item;
      item.name = "layer";
      item.play.source = 1;
      item.at = {0.5, false};
      layer.items = {item};
      timeline.layers.push_back(layer);
    }
  }
  const std::vector<timeline::Source> sources = {{"a", &walks[0].clip, &walks[0].keys, {}},
                                                 {"b", &walks[1].clip, &walks[1].keys, {}}};
  auto result = timeline::mix(timeline, sources, roles_of(walks));
  EXPECT_TRUE(result.ok()) << (result.ok() ? "" : result.error().message);
  return result.ok() ? std::move(result->clip) : Clip();
}

Clip looped(const Walks& walks, int rounds) {
  auto result = loop(walks[0].clip, carrying_joint(roles_of(walks)), {.turn = LoopTurn::keep});
  EXPECT_TRUE(result.ok());
  auto again = repeated(result->clip, result->displacement, rounds);
  EXPECT_TRUE(again.ok());
  return std::move(*again);
}

Clip joined(const Walks& walks) {
  auto result = join(walks[0].clip, walks[1].clip, carrying_joint(roles_of(walks)), {.blend = 0.3});
  EXPECT_TRUE(result.ok()) << (result.ok() ? "" : result.error().message);
  return result.ok() ? std::move(result->clip) : Clip();
}

Clip mirrored(const Walks& walks) {
  const RoleMap roles = roles_of(walks);
  return mirror(walks[0].clip, find_mirror_pairs(walks[0].clip.skeleton, roles));
}

Clip planted(const Walks& walks) {
  auto result = plant_feet(walks[1].clip, roles_of(walks));
  EXPECT_TRUE(result.ok()) << (result.ok() ? "" : result.error().message);
  EXPECT_GT(result->stays.size(), 4U);
  return std::move(result->clip);
}

// The steps of both walks, those of the other foot mirrored.
parametric::Library library_of(const Walks& walks, const std::vector<std::string>& parameters) {
  std::vector<FoundContacts> found;
  for (const KeyedWalk& walk : walks) {
    found.push_back(*find_contacts(walk.clip, find_roles(walk.clip.skeleton)));
  }
  std::vector<parametric::Walk> given;
  for (std::size_t i = 0; i < walks.size(); ++i) {
    given.push_back({"walk", &walks[i].clip, &walks[i].keys, &found[i]});
  }
  const auto cut = parametric::cut_steps(given, roles_of(walks), parameters, {.outlier = 0});
  EXPECT_TRUE(cut.ok()) << (cut.ok() ? "" : cut.error().message);
  return cut.ok() ? cut->library : parametric::Library();
}

// Their mean.
Clip synthesised(const Walks& walks) {
  const parametric::Library library = library_of(walks, {"step.length"});
  const parametric::PackedExamples packed = parametric::pack_examples(library);
  const auto count = library.examples.size();
  EXPECT_GE(count, 6);
  const std::vector<double> weights(count, 1.0 / static_cast<double>(count));
  const auto motion = parametric::BlendedMotion::create(library, packed, weights);
  EXPECT_TRUE(motion.ok());
  auto made = motion->make();
  EXPECT_TRUE(made.ok());
  return std::move(made->clip);
}

std::vector<Operation> operations() {
  using timeline::ChangeKind;
  std::vector<Operation> list;
  const auto add = [&](const char* name, std::function<Clip(const Walks&)> apply,
                       Moves moves = Moves::along, double by_axes = kSame) {
    list.push_back({name, std::move(apply), moves, by_axes});
  };
  add("blend", [](const Walks& w) { return blended(w, blend::Align::root, false); });
  add("blend on the feet", [](const Walks& w) { return blended(w, blend::Align::stance, false); });
  add("blend in the world", [](const Walks& w) { return blended(w, blend::Align::none, false); });
  add("blend by shape", [](const Walks& w) { return blended(w, blend::Align::root, true); });
  for (const auto kind :
       {ChangeKind::cut, ChangeKind::crossfade, ChangeKind::smooth, ChangeKind::inertial}) {
    for (const auto align : {timeline::Align::root, timeline::Align::stance}) {
      add("mix", [=](const Walks& w) { return mixed(w, kind, align, false); });
    }
  }
  add("layers", [](const Walks& w) {
    return mixed(w, ChangeKind::crossfade, timeline::Align::stance, true);
  });
  add("loop", [](const Walks& w) { return looped(w, 1); });
  add("repeat", [](const Walks& w) { return looped(w, 3); });
  add("join", joined);
  add("retime", [](const Walks& w) { return *resample(w[0].clip, 44); });
  for (const Travel travel : {Travel::all, Travel::trend}) {
    add("in place",
        [=](const Walks& w) { return in_place(w[0].clip, carrying_joint(roles_of(w)), travel); });
  }
  add("plant", planted);
  add("synthesise", synthesised, Moves::not_at_all);
  add(
      "mirror", [](const Walks& w) { return mirrored(w); }, Moves::mirrored);
  return list;
}

// Two walks of one figure with noise, one round a bend to the left, one straight, metres away from
// the origin and from each other, facing `first` and `second` in the beginning.
Walks walks(double first = 2.0, double second = -1.1) {
  samples::WalkOptions left = blend::slow_walk(), quick = blend::quick_walk();
  left.turn = 0.15;
  left.noise_angle = quick.noise_angle = 0.3 * kRadiansPerDegree;
  left.noise_position = quick.noise_position = 1e-3;
  quick.seed = 2;
  return {blend::moved(blend::keyed_walk(left), {Vec3(4, 0, -6), axis_rotation(Axis::y, first)}),
          blend::moved(blend::keyed_walk(quick), {Vec3(-7, 0, 3), axis_rotation(Axis::y, second)})};
}

template <typename Change>
Walks changed(const Walks& from, const Change& change) {
  Walks result;
  for (const KeyedWalk& walk : from) result.push_back(change(walk));
  return result;
}

TEST(Rigs, OperationsGiveTheSameOnAllOfThem) {
  // Of a reference pose that lies a file does not tell where it faces; the first frame does.
  const Walks plain = walks(0.3, -0.4);
  for (const Operation& operation : operations()) {
    const Clip expected = operation.apply(plain);
    for (const auto rig : {blend::Rig::static_root, blend::Rig::ground_root, blend::Rig::lying}) {
      const Walks rigged =
          changed(plain, [&](const KeyedWalk& walk) { return blend::rigged(walk, rig); });
      const Clip result = operation.apply(rigged);
      ASSERT_TRUE(check(result).ok());
      EXPECT_LT(blend::farthest_by_name(expected, result), kSame)
          << operation.name << ", rig " << static_cast<int>(rig);
    }
  }
}

// Only loops that travel take a standing root along.
TEST(Rigs, ARootKeepsDoingWhatItDoes) {
  const Walks plain = walks();
  for (const Operation& operation : operations()) {
    const auto of = [&](blend::Rig rig) {
      return operation.apply(
          changed(plain, [&](const KeyedWalk& walk) { return blend::rigged(walk, rig); }));
    };
    const Clip still = of(blend::Rig::static_root);
    ASSERT_GT(still.frame_count(), 10);
    const bool loops = operation.name == "loop" || operation.name == "repeat";
    for (int f = 0; f < still.frame_count() && !loops; ++f) {
      ASSERT_LT(still.frame_positions(f)[0].norm(), 1e-6f) << operation.name << ", frame " << f;
    }
    // Planting takes the hips' jitter out and leaves what is above them alone.
    if (operation.name == "plant") continue;
    const Clip sliding = of(blend::Rig::ground_root);
    const int hips = sliding.skeleton.find("Hips");
    for (int f = 0; f < sliding.frame_count(); ++f) {
      const Vec3f root = sliding.frame_positions(f)[0];
      const Vec3f below = sliding.frame_positions(f)[static_cast<std::size_t>(hips)];
      // A step is as high as its sole.
      ASSERT_LT((root - below).cwiseProduct(Vec3f(1, 0, 1)).norm(), 1e-5f)
          << operation.name << ", frame " << f;
    }
  }
}

TEST(Rigs, WhereTheWalksAreAndFaceDoesNotMatter) {
  const Transform move{Vec3(11, 0, -8), axis_rotation(Axis::y, 2.6)};
  const Transform image{Vec3(-11, 0, -8), axis_rotation(Axis::y, -2.6)};
  for (const auto rig : {blend::Rig::hips, blend::Rig::static_root}) {
    const Walks plain =
        changed(walks(), [&](const KeyedWalk& walk) { return blend::rigged(walk, rig); });
    const Walks elsewhere =
        changed(plain, [&](const KeyedWalk& walk) { return blend::moved(walk, move); });
    for (const Operation& operation : operations()) {
      Clip expected = operation.apply(plain);
      if (operation.moves == Moves::along) move_clip(move, expected);
      if (operation.moves == Moves::mirrored) move_clip(image, expected);
      EXPECT_LT(blend::farthest_by_name(expected, operation.apply(elsewhere)), kSame)
          << operation.name;
    }
  }
}

TEST(Rigs, JointsOwnAxesDoNotMatter) {
  for (const auto rig : {blend::Rig::hips, blend::Rig::static_root, blend::Rig::ground_root}) {
    const Walks plain =
        changed(walks(), [&](const KeyedWalk& walk) { return blend::rigged(walk, rig); });
    const Walks turned = changed(plain, blend::with_other_axes);
    for (const Operation& operation : operations()) {
      EXPECT_LT(blend::farthest_by_name(operation.apply(plain), operation.apply(turned)),
                operation.by_axes)
          << operation.name;
    }
  }
}

TEST(Rigs, TheReferencePoseDoesNotMatter) {
  const Walks plain = walks();
  const Walks posed = changed(plain, [&](const KeyedWalk& walk) {
    return blend::with_reference_pose(walk, plain[0].clip, 40);
  });
  for (const Operation& operation : operations()) {
    EXPECT_LT(blend::farthest_by_name(operation.apply(plain), operation.apply(posed)), kSame)
        << operation.name;
  }
}

TEST(Rigs, AMirroredJointIsWhereItsPartnersImageIs) {
  for (const auto rig : {blend::Rig::hips, blend::Rig::static_root, blend::Rig::ground_root}) {
    const KeyedWalk walk = blend::rigged(walks()[0], rig);
    const Clip posed = blend::with_reference_pose(walk, walk.clip, 40).clip;
    for (const Clip* clip : {&walk.clip, &posed}) {
      const MirrorPairs pairs = find_mirror_pairs(clip->skeleton, find_roles(clip->skeleton));
      const Clip result = mirror(*clip, pairs);
      for (int f = 0; f < clip->frame_count(); ++f) {
        for (std::size_t j = 0; j < pairs.partners.size(); ++j) {
          Vec3f image = clip->frame_positions(f)[static_cast<std::size_t>(pairs.partners[j])];
          image.x() = -image.x();
          ASSERT_LT((result.frame_positions(f)[j] - image).norm(), 1e-5f)
              << clip->skeleton.names[j] << ", frame " << f;
        }
      }
    }
  }
}

// A library of left steps makes right steps with the same parameters.
TEST(Rigs, AMirroredLibraryMeasuresTheSame) {
  const std::vector<std::string> names = {"step.length", "step.width", "step.height", "step.turn"};
  const Walks plain = walks(0.3, -0.4);
  for (const auto rig :
       {blend::Rig::hips, blend::Rig::static_root, blend::Rig::ground_root, blend::Rig::lying}) {
    Walks rigged = changed(plain, [&](const KeyedWalk& walk) { return blend::rigged(walk, rig); });
    for (const bool posed : {false, true}) {
      if (posed) {
        const Clip pose = rigged[0].clip;
        rigged = changed(rigged, [&](const KeyedWalk& walk) {
          return blend::with_reference_pose(blend::with_other_axes(walk), pose, 40);
        });
      }
      const parametric::Library library = library_of(rigged, names);
      const auto mirrored = parametric::mirrored(library);
      ASSERT_TRUE(mirrored.ok());
      ASSERT_NE(mirrored->swing, library.swing);
      const parametric::Measure measure(*mirrored, parametric::pack_examples(*mirrored));
      auto scratch = measure.make_scratch();
      std::vector<double> values(names.size());
      for (std::size_t i = 0; i < library.examples.size(); ++i) {
        std::vector<double> weights(library.examples.size(), 0);
        weights[i] = 1;
        ASSERT_TRUE(measure(weights, values, {}, scratch).ok());
        for (std::size_t d = 0; d < names.size(); ++d) {
          EXPECT_NEAR(values[d], library.examples[i].parameters[d], 1e-5)
              << names[d] << ", rig " << static_cast<int>(rig) << ", posed " << posed;
        }
      }
    }
  }
}

// Files of one figure often differ in where they put the hips below a root, which the motion says
// anyway.
TEST(Rigs, TheOffsetOfTheHipsAloneMakesNoOtherSkeleton) {
  const Walks plain = changed(
      walks(), [](const KeyedWalk& walk) { return blend::rigged(walk, blend::Rig::static_root); });
  Walks elsewhere = plain;
  for (std::size_t j = 1; j < elsewhere[1].clip.skeleton.reference.size(); ++j) {
    elsewhere[1].clip.skeleton.reference[j].position += Vec3(0.4, -0.9, 4);
  }
  for (const Operation& operation : operations()) {
    EXPECT_LT(blend::farthest_by_name(operation.apply(plain), operation.apply(elsewhere)), kSame)
        << operation.name;
  }
  // A thigh of another length is another figure's.
  Walks other = plain;
  Skeleton& skeleton = other[1].clip.skeleton;
  const auto knee = static_cast<std::size_t>(skeleton.find("LeftLeg"));
  ASSERT_LT(knee, skeleton.names.size());
  skeleton.reference[knee].position.y() -= 0.1;
  EXPECT_EQ(join(other[0].clip, other[1].clip, 1, {}).error().code, "motion-skeleton");
  EXPECT_EQ(parametric::same_skeleton(other[0].clip.skeleton, skeleton).error().code,
            "parametric-skeleton");
}

}  // namespace
}  // namespace krok
