#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "core/result.h"
#include "scene/frame_source.h"

namespace krok::cli::import {

// Poses that a file has several times in turn all along, as one that was exported at a multiple of
// its capture's rate. Looks at frames as they are read by others.
class Repeats {
 public:
  // The same frames, which are noted as they are read. Must not outlive this.
  FrameSource watched(const FrameSource& frames);

  // Once all of them were read: import-repeats if nine tenths of the poses are there at least
  // twice.
  std::optional<Diagnostic> warning() const;

  // Of frames that are held already.
  static std::optional<Diagnostic> in(const Clip& clip);

 private:
  double rate_ = 0;
  std::vector<std::uint64_t> poses_;  // [frames], hashes
};

}  // namespace krok::cli::import
