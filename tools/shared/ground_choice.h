#pragma once

#include <memory>
#include <string>

#include "formats/io/open_terrain.h"

namespace krok::cli {

// A ground that the user names, for io::open_terrain().
struct GroundChoice {
  std::string text;  // empty for none
  height_field::Placement placement;

  bool empty() const { return text.empty(); }
  Result<std::unique_ptr<Terrain>> open(io::Inputs& inputs) const {
    return io::open_terrain(text, placement, inputs);
  }
};

}  // namespace krok::cli
