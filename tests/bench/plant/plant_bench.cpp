// Foot skate clean-up of the captured walks of the corpus, and of 100 generated walks to which
// slides of 20 mm and jitter of 5 mm were added, beside plain two-bone locking and the method of
// Kovar, Schreiner and Gleicher (2002), all given the same stays. For each: how far heel and ball
// drift in a stay, knee acceleration as a multiple of the input's (99th percentile and maximum over
// all frames), the height of heel and ball over where they should stand, how much bones stretch.
// Then the time for a million frames of 60 joints, and a hash of the results.

#include <cstdio>
#include <cstring>
#include <ctime>
#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "contacts/contacts.h"
#include "core/file.h"
#include "core/hash.h"
#include "formats/bvh/bvh_reader.h"
#include "methods.h"
#include "plant/plant_feet.h"
#include "support/foot_skate.h"
#include "support/planted_measures.h"
#include "support/this_build.h"

namespace {

using namespace krok;

struct Sample {
  std::string name;
  Clip input;
  std::optional<Clip> clean;  // what the input was before slides and jitter
};

using test::Measures;

using Method = std::function<Clip(const Clip&, const RoleMap&, const PlantedFeet&)>;
struct Total {
  Measures worst;
  double knee_99 = 0, knee_max = 0;  // means
  int clips = 0, over = 0;           // over: knee_99 over 1.2
};

void add(const Measures& m, Total& total) {
  Measures& worst = total.worst;
  worst.drift = std::max(worst.drift, m.drift);
  worst.knee_99 = std::max(worst.knee_99, m.knee_99);
  worst.knee_max = std::max(worst.knee_max, m.knee_max);
  worst.height = std::max(worst.height, m.height);
  worst.stretch = std::max(worst.stretch, m.stretch);
  worst.stays += m.stays;
  worst.high += m.high;
  total.knee_99 += m.knee_99;
  total.knee_max += m.knee_max;
  total.over += m.knee_99 > 1.2 ? 1 : 0;
  ++total.clips;
}

void compare(const char* title, const std::vector<Sample>& samples, bool details) {
  const std::vector<std::pair<std::string, Method>> methods = {
      {"input", [](const Clip& clip, const RoleMap&, const PlantedFeet&) { return clip; }},
      {"plain locking",
       [](const Clip& clip, const RoleMap& roles, const PlantedFeet& planted) {
         return bench::plain_locking(clip, roles, planted.stays);
       }},
      {"Kovar et al. 2002",
       [](const Clip& clip, const RoleMap& roles, const PlantedFeet& planted) {
         return bench::kovar_2002(clip, roles, planted.stays);
       }},
      {"plant_feet",
       [](const Clip&, const RoleMap&, const PlantedFeet& planted) { return planted.clip; }}};
  std::vector<Total> totals(methods.size());
  std::uint64_t hash = 0;
  int out_of_reach = 0;
  for (const Sample& sample : samples) {
    const RoleMap roles = find_roles(sample.input.skeleton);
    const auto planted = plant_feet(sample.input, roles);
    if (!planted) {
      std::printf("  %s: %s\n", sample.name.c_str(), planted.error().message.c_str());
      continue;
    }
    out_of_reach += planted->out_of_reach;
    hash = hash * 31 + xxh3(std::as_bytes(std::span(planted->clip.positions)));
    for (std::size_t m = 0; m < methods.size(); ++m) {
      const Measures measures =
          test::measure(sample.input, sample.clean.value_or(sample.input), roles, planted->stays,
                        methods[m].second(sample.input, roles, *planted));
      add(measures, totals[m]);
      if (details && m + 1 == methods.size()) {
        std::printf(
            "  %-44s drift %6.2f -> %5.3f mm, knee %5.2f (max %5.2f), height %6.2f mm, "
            "lowered %4.1f mm, steadied %4.2f mm, out of reach %d\n",
            sample.name.c_str(), planted->drift_before * 1000, measures.drift * 1000,
            measures.knee_99, measures.knee_max, measures.height * 1000,
            planted->pelvis_lowered * 1000, planted->body_steadied * 1000, planted->out_of_reach);
      }
    }
  }
  std::printf("%s: %d clips, hash %s, out of reach in %d frames\n", title, totals[0].clips,
              hex(hash).c_str(), out_of_reach);
  std::printf("  %-20s %10s %22s %22s %10s %10s\n", "", "drift mm", "knee p99 mean/worst",
              "knee max mean/worst", "height mm", "stretch mm");
  for (std::size_t m = 0; m < methods.size(); ++m) {
    const Total& t = totals[m];
    std::printf(
        "  %-20s %10.3f %11.2f / %8.2f %11.2f / %8.2f %10.2f %10.3f  %d of %d clips over 1.2, %d "
        "of %d heights over 1 mm\n",
        methods[m].first.c_str(), t.worst.drift * 1000, t.knee_99 / t.clips, t.worst.knee_99,
        t.knee_max / t.clips, t.worst.knee_max, t.worst.height * 1000, t.worst.stretch * 1000,
        t.over, t.clips, t.worst.high, t.worst.stays);
  }
}

std::vector<Sample> corpus() {
  std::vector<Sample> samples;
  const std::filesystem::path folder = test::corpus_folder() + "/bvh";
  if (!std::filesystem::exists(folder)) return samples;
  std::vector<std::string> names = {"pybvh/cmu_12_01_walk.bvh",
                                    "optitrack_arena_bvh-matlab/walk.bvh",
                                    "makehuman/12_03.bvh",
                                    "makehuman/02_02.bvh",
                                    "pymo/AV_8Walk_Meredith_HVHA_Rep1.bvh",
                                    "iclone_cmu/002_01.bvh",
                                    "iclone_cmu/002_03.bvh",
                                    "deep-motion-editing/xia_test_neutral_01_000.bvh",
                                    "deep-motion-editing/xia_test_old_13_000.bvh",
                                    "makehuman/zombieWalk1.bvh",
                                    "secondlife_opencollar/~walk_Female.bvh",
                                    "animated_drawings/fair1_zombie.bvh"};
  for (const char* number : {"02", "03", "04", "05", "06", "08", "09", "10", "11", "12"}) {
    names.push_back(std::string("walkset_cmu07/007_") + number + ".bvh");
  }
  for (const std::string& name : names) {
    const auto file = InputFile::open((folder / name).string());
    if (!file) continue;
    auto capture = bvh::read(file->text(), name, {});
    if (capture) samples.push_back({name, std::move(capture->clip), {}});
  }
  return samples;
}

// The same, sliding and jittering more than they do.
std::vector<Sample> skating(std::vector<Sample> samples, const test::Skate& skate) {
  unsigned seed = 0;
  for (Sample& sample : samples) {
    test::Skate own = skate;
    own.seed = ++seed;
    const RoleMap roles = find_roles(sample.input.skeleton);
    sample.input = with_skate(sample.input, test::stances_of(sample.input, roles), own);
  }
  return samples;
}

std::vector<Sample> generated(const test::Skate& skate) {
  std::vector<Sample> samples;
  for (unsigned seed = 0; seed < 100; ++seed) {
    const auto walk = samples::make_walk(test::varied_walk(seed));
    if (!walk) continue;
    test::Skate own = skate;
    own.seed = seed;
    samples.push_back({"walk " + std::to_string(seed) + " at " +
                           std::to_string(static_cast<int>(walk->clip.rate)) + " fps",
                       with_skate(*walk, own), walk->clip});
  }
  return samples;
}

// With joints added below the head until there are 60.
Clip with_60_joints(const Clip& clip) {
  Clip wide;
  wide.skeleton = clip.skeleton;
  wide.rate = clip.rate;
  const int head = clip.skeleton.find("Head");
  while (wide.joint_count() < 60) {
    wide.skeleton.add("more" + std::to_string(wide.joint_count()), head,
                      wide.skeleton.reference[static_cast<std::size_t>(head)]);
  }
  wide.resize(clip.frame_count());
  for (int f = 0; f < clip.frame_count(); ++f) {
    for (int j = 0; j < wide.joint_count(); ++j) {
      const auto from = static_cast<std::size_t>(j < clip.joint_count() ? j : head);
      wide.frame_positions(f)[static_cast<std::size_t>(j)] = clip.frame_positions(f)[from];
      wide.frame_orientations(f)[static_cast<std::size_t>(j)] = clip.frame_orientations(f)[from];
    }
  }
  return wide;
}

void speed(int steps) {
  samples::WalkOptions options;
  options.steps = steps;
  options.noise_position = 0.0005;
  const auto walk = samples::make_walk(options);
  if (!walk) return;
  const Clip clip = with_60_joints(walk->clip);
  const RoleMap roles = find_roles(clip.skeleton);
  // Of the processor, for other programs may run beside.
  const auto seconds = [](const std::function<void()>& run) {
    const std::clock_t begin = std::clock();
    run();
    return static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
  };
  const double whole = seconds([&] { (void)plant_feet(clip, roles).ok(); });
  const double finding = seconds([&] { (void)find_contacts(clip, roles).ok(); });
  std::printf(
      "%d frames of %d joints, one thread: %.2f us a frame (finding contacts %.2f); a million "
      "frames in %.1f s\n",
      clip.frame_count(), clip.joint_count(), whole / clip.frame_count() * 1e6,
      finding / clip.frame_count() * 1e6, whole / clip.frame_count() * 1e6);
}

}  // namespace

int main(int count, char** arguments) {
  if (count > 1 && std::strcmp(arguments[1], "--speed") == 0) {
    speed(1000);
    return 0;
  }
  const bool details = count > 1 && std::strcmp(arguments[1], "--details") == 0;
  compare("Captured walks", corpus(), details);
  compare("Captured walks, with 20 mm slides and jitter of the whole body by 5 mm more",
          skating(corpus(), {}), details);
  compare("Captured walks, with 20 mm slides and jitter of the feet by 5 mm more",
          skating(corpus(), {.body_jitter = 0, .foot_jitter = 0.005}), details);
  compare("Generated, 20 mm slides, whole body jitters by 5 mm", generated({}), details);
  compare("Generated, 20 mm slides, feet jitter by 5 mm",
          generated({.body_jitter = 0, .foot_jitter = 0.005}), details);
  compare("Generated, 20 mm slides", generated({.body_jitter = 0}), details);
  compare("Generated, as they are", generated({.slide = 0, .body_jitter = 0}), details);
  if (details) return 0;
  speed(50);
  speed(1000);
  return 0;
}
