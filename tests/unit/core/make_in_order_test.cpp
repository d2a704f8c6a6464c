// If these fail, blocks of a file are written in a wrong order, lost or twice, or memory for them
// grows with the file.
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <mutex>
#include <set>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "core/parallel.h"

namespace krok {
namespace {

TEST(MakeInOrder, HandsOverEachItemInOrder) {
  for (const std::size_t count : {0u, 1u, 2u, 5u, 300u}) {
    for (const int jobs : {1, 2, 5, 0}) {
      std::vector<std::size_t> made(slots_for(jobs));
      std::vector<std::size_t> taken;
      std::atomic<int> takers{0};
      const Status status = make_in_order(
          count, jobs,
          [&](std::size_t item, std::size_t slot) {
            if (item % 7 == 0) std::this_thread::sleep_for(std::chrono::microseconds(50));
            made[slot] = item;
            return Status();
          },
          [&](std::size_t item, std::size_t slot) {
            EXPECT_EQ(takers.fetch_add(1), 0);
            EXPECT_EQ(made[slot], item);
            taken.push_back(item);
            --takers;
            return Status();
          });
      EXPECT_TRUE(status);
      ASSERT_EQ(taken.size(), count);
      for (std::size_t i = 0; i < count; ++i) EXPECT_EQ(taken[i], i);
    }
  }
}

TEST(MakeInOrder, KeepsNoMoreItemsThanSlots) {
  std::mutex mutex;
  std::set<std::size_t> in_work;
  const std::size_t slots = slots_for(3);
  const Status status = make_in_order(
      200, 3,
      [&](std::size_t, std::size_t slot) {
        const std::lock_guard lock(mutex);
        EXPECT_LT(slot, slots);
        EXPECT_TRUE(in_work.insert(slot).second) << "the slot was in work";
        return Status();
      },
      [&](std::size_t, std::size_t slot) {
        const std::lock_guard lock(mutex);
        in_work.erase(slot);
        return Status();
      });
  EXPECT_TRUE(status);
}

TEST(MakeInOrder, StopsAtTheFirstErrorInOrder) {
  for (int round = 0; round < 20; ++round) {
    for (const int jobs : {1, 2, 4}) {
      std::size_t taken = 0;
      const Status status = make_in_order(
          100, jobs,
          [](std::size_t item, std::size_t) -> Status {
            if (item == 5) std::this_thread::sleep_for(std::chrono::milliseconds(1));
            if (item >= 5) return Error("test", std::to_string(item));
            return {};
          },
          [&](std::size_t, std::size_t) {
            ++taken;
            return Status();
          });
      ASSERT_FALSE(status);
      EXPECT_EQ(status.error().message, "5");
      EXPECT_EQ(taken, 5u);
    }
  }
}

TEST(MakeInOrder, PassesOnWhatTakingSaysOrThrows) {
  const auto nothing = [](std::size_t, std::size_t) { return Status(); };
  for (const int jobs : {1, 3}) {
    const Status status = make_in_order(50, jobs, nothing, [](std::size_t item, std::size_t) {
      return item == 9 ? Status(Error("full", "the disk is full")) : Status();
    });
    ASSERT_FALSE(status);
    EXPECT_EQ(status.error().code, "full");
    EXPECT_THROW((void)make_in_order(50, jobs, nothing,
                                     [](std::size_t item, std::size_t) -> Status {
                                       if (item == 9) throw std::runtime_error("stop");
                                       return {};
                                     }),
                 std::runtime_error);
  }
}

}  // namespace
}  // namespace krok
