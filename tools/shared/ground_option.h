#pragma once

#include <filesystem>
#include <string>

#include "core/result.h"
#include "terrain/spec.h"

namespace krok::cli {

// Whether a text given as --ground can be one: that of a made ground must be right. Whether a file
// is there and holds a ground shows when it is opened. Codes: those of terrain::from_spec().
inline Status check_ground_text(const std::string& ground) {
  std::error_code ignored;
  if (!terrain::is_spec(ground) || std::filesystem::exists(ground, ignored)) return {};
  const auto made = terrain::from_spec(ground);
  return made ? Status() : made.error();
}

}  // namespace krok::cli
