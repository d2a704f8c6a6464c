// If these fail, the gait table calls a kick or a jump on the spot a run.

#include <gtest/gtest.h>

#include "tools/krok-keys/gait_table.h"

namespace krok::cli::keys {
namespace {

TEST(GaitFacts, ARunNeedsProgress) {
  GaitFacts facts;
  facts.gait.cycles = 4;
  facts.gait.stance = {0.4, 0.4};
  facts.steps.stride_length = 0.3;
  facts.steps.steadiness = 0.6;
  facts.steps.speed = 0.5;
  EXPECT_STREQ(facts.name(), "");
  facts.steps.stride_length = 1.8;
  facts.steps.speed = 2.5;
  EXPECT_STREQ(facts.name(), "run");
  facts.gait.stance = {0.62, 0.62};
  facts.gait.double_support = 0.24;
  facts.steps.speed = 0.5;
  EXPECT_STREQ(facts.name(), "walk");
}

}  // namespace
}  // namespace krok::cli::keys
