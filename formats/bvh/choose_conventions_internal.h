#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "capture/convention_choice.h"
#include "core/result.h"
#include "formats/bvh/bvh_reader.h"
#include "formats/bvh/hierarchy.h"
#include "formats/bvh/kinematics.h"
#include "formats/bvh/motion_rows.h"
#include "scene/skeleton.h"

namespace krok::bvh {

// A file whose header is parsed and whose rows are found.
struct IndexedFile {
  std::string_view text;
  const std::string& file_name;
  const ReadOptions& options;
  const MotionHeader& header;
  const std::vector<std::size_t>& rows;  // [frames] as in RowIndex
};

struct ChosenConventions {
  Positions positions = Positions::absolute;
  Conversion conversion;
  double usual_distance = 0;  // metres, capture/far_values.h
};

// Chooses how to read the rows: frame rate, position channels, unit of angles, unit of length and
// axes, as given by the options, otherwise as detected from some of the rows. Sets the unit of the
// hierarchy's angles. Reports each choice, and the program that wrote the file, in `capture`.
Result<ChosenConventions> choose_conventions(const IndexedFile& file, Hierarchy& hierarchy,
                                             Capture& capture);

// The joints with their reference pose.
Skeleton skeleton_of(const Hierarchy& hierarchy, const Kinematics& kinematics);

}  // namespace krok::bvh
