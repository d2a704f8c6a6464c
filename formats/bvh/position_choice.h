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
  bool depends_on_up = false;  // the root decides
  bool by_ground = false;      // the character is on it in one mode alone
  bool has_evidence = false;   // false: no joint decides, and both modes give the same result
};

// Whether position channels replace OFFSETs or are added to them. Each joint with position channels
// and a non-zero OFFSET votes: in the median row, are its values near the OFFSET (absolute) or near
// zero (additive)? Joints below the root decide, if there are any. A root travels, and so does a
// joint that carries the whole skeleton: the mode that puts the character on the ground is chosen;
// if that is inconclusive, only the root's height is compared, if its OFFSET has one. Without `up`,
// where it is unclear, the positions of a root replace its OFFSET, as in most files.
PositionChoice choose_positions(const Hierarchy& hierarchy, const SampleRows& rows,
                                std::optional<Direction> up);

}  // namespace krok::bvh
