#pragma once

#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include "contacts/gait_keytimes.h"
#include "core/file.h"
#include "formats/bvh/bvh_reader.h"
#include "parametric/cut_steps.h"
#include "parametric/thin_out.h"
#include "support/this_build.h"
#include "unit/parametric/walks.h"

// Step libraries to measure with.

namespace krok::bench {

// Of one, two, three or four parameters.
inline parametric::Library grid_library(int dimensions) {
  const std::vector<double> lengths =
      dimensions == 1 ? std::vector{0.45, 0.55, 0.65, 0.75, 0.85} : std::vector{0.45, 0.6, 0.75};
  const auto values = [&](int from, std::vector<double> many, double one) {
    return dimensions >= from ? std::move(many) : std::vector{one};
  };
  std::vector<parametric::test::KeyedWalk> walks;
  for (const double length : lengths) {
    for (const double rise : values(2, {-0.12, 0, 0.12}, 0)) {
      for (const double turn : values(3, {-0.3, 0, 0.3}, 0)) {
        for (const double width : values(4, {0.08, 0.2}, 0.1)) {
          samples::WalkOptions options;
          options.steps = 2;
          options.step_length = length;
          options.rise = rise;
          options.turn = turn;
          options.step_width = width;
          walks.push_back(parametric::test::keyed_walk(options));
        }
      }
    }
  }
  const std::vector<std::string> all = {"step.length", "step.height", "step.turn", "step.width"};
  const std::vector<std::string> names(all.begin(), all.begin() + dimensions);
  return parametric::test::library_of(walks, names, {.mirror = false, .outlier = 0}).library;
}

// Of the steps of one man from slow to fast, as captured, by length and duration; no examples where
// there is no corpus.
inline parametric::Library walkset_library() {
  const std::filesystem::path folder = test::corpus_folder() + "/bvh/walkset_cmu07";
  if (!std::filesystem::exists(folder)) return {};
  std::set<std::filesystem::path> paths;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) paths.insert(entry.path());
  std::vector<parametric::test::KeyedWalk> walks;
  for (const auto& path : paths) {
    const auto file = InputFile::open(path.string());
    if (!file) continue;
    auto capture = bvh::read(file->text(), path.string(), {});
    if (!capture) continue;
    auto& [walk, keys, found] = walks.emplace_back();
    walk.clip = std::move(capture->clip);
    const RoleMap roles = find_roles(walk.clip.skeleton);
    if (auto contacts = find_contacts(walk.clip, roles)) found = *std::move(contacts);
    keys = {found.contacts, find_gait(walk.clip, roles, found).keytimes};
  }
  const std::vector<std::string> names = {"step.length", "duration"};
  parametric::Library library = parametric::test::library_of(walks, names, {}).library;
  std::vector<parametric::Example> apart;
  for (const int i : parametric::thin_out(library, 0.15)) {
    apart.push_back(std::move(library.examples[static_cast<std::size_t>(i)]));
  }
  library.examples = std::move(apart);
  return library;
}

}  // namespace krok::bench
