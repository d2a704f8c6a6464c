#pragma once

#include <string>

#include "core/result.h"

namespace krok::cli::film {

// Names of numbered files by a pattern with one %d or %0Nd, as ffmpeg takes them: "frame_%04d.png".
class FrameNames {
 public:
  // Code usage for a pattern without a number or with several.
  static Result<FrameNames> parse(const std::string& pattern);
  std::string of(int frame) const;

 private:
  std::string before_, after_;
  int digits_ = 1;
};

}  // namespace krok::cli::film
