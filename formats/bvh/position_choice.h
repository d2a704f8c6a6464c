#pragma once

#include <optional>
#include <span>

#include "formats/bvh/bvh_reader.h"
#include "formats/bvh/hierarchy.h"

namespace krok::bvh {

// Some rows of a file, shape [rows x channels].
struct SampleRows {
  std::vector<double> values;
  std::size_t channels = 0;
  std::size_t count() const { return channels == 0 ? 0 : values.size() / channels; }
  std::span<const double> row(std::size_t i) const {
    return std::span(values).subspan(i * channels, channels);
  }
};

struct PositionChoice {
  Positions positions = Positions::absolute;
  Choice choice;
  bool has_evidence = false;  // a joint could be asked; otherwise both readings are the same
};

// Whether position channels replace OFFSETs or are added to them. Each joint with a non-zero OFFSET
// beside position channels is asked where its values lie along the OFFSET: near it (absolute) or
// near zero (additive), in the median row. Joints below the root decide, if there are any. A root
// travels, and so does a joint that carries the whole figure under it: where `up` is known, the
// reading that has the figure on the ground is taken, and where that does not tell, only the root's
// height is asked if the OFFSET has one.
PositionChoice choose_positions(const Hierarchy& hierarchy, const SampleRows& rows,
                                std::optional<Direction> up);

}  // namespace krok::bvh
