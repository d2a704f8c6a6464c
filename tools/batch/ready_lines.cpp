#include "tools/batch/ready_lines.h"

#include <algorithm>

namespace krok::cli::batch {

std::unique_ptr<ReadyLine> ReadyLines::take(std::size_t set) {
  {
    const std::lock_guard lock(mutex_);
    const auto found = std::find_if(kept_.rbegin(), kept_.rend(),
                                    [&](const Kept& kept) { return kept.set == set; });
    if (found != kept_.rend()) {
      std::unique_ptr<ReadyLine> ready = std::move(found->ready);
      kept_.erase(std::next(found).base());
      return ready;
    }
  }
  return std::make_unique<ReadyLine>(make_spec_);
}

void ReadyLines::put_back(std::size_t set, std::unique_ptr<ReadyLine> ready) {
  Kept oldest;  // destroyed after the mutex is released
  const std::lock_guard lock(mutex_);
  if (kept_.size() >= most_) {
    oldest = std::move(kept_.front());
    kept_.erase(kept_.begin());
  }
  kept_.push_back({set, std::move(ready)});
}

}  // namespace krok::cli::batch
