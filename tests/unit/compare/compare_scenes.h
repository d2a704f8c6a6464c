#pragma once

#include <gtest/gtest.h>

#include "compare/scene_difference.h"

namespace krok::compare {

inline SceneDifference compare_scenes(const Scene& a, const Scene& b,
                                      Matching matching = Matching::automatic, int jobs = 1) {
  Progress progress;
  SceneOptions options;
  options.matching = matching;
  const auto found = difference(a, b, options, jobs, progress);
  EXPECT_TRUE(found.ok()) << found.error().message;
  return found.ok() ? *found : SceneDifference();
}

}  // namespace krok::compare
