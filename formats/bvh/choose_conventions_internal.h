#pragma once

#include <cstddef>
#include <optional>
#include <span>
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

// The frame rate inferred from a printed frame time.
struct PrintedRate {
  double rate = 0;          // frames per second
  bool snapped = false;     // not 1 / frame time as printed
  bool few_digits = false;  // the digits also fit rates half a percent or more away
  bool also_ntsc = false;   // the digits also fit the NTSC rate beside it
  bool unusual = false;     // below 4 or above 1000 fps; see the reason
  std::string reason;
};

// The nearest common rate whose frame time agrees with the number in all printed digits (trailing
// zeros do not count): a whole rate (24, 25, 30, 48, 50, 60, 90, 100, 120, 240), else an NTSC rate
// (24, 30, 48, 60, 120 and 240 / 1.001); else the only rate up to 1000 with no decimals, or with
// two or three, that agrees; else 1 / frame time. A whole rate that the number gives exactly wins
// over a common one more than half a percent away. `text` is the number as printed, `frame_time`
// its value, > 0.
PrintedRate rate_of_frame_time(std::string_view text, double frame_time);

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
// if that is inconclusive, only the root's height is compared. The positions of a root whose OFFSET
// is horizontal replace it, as in most files, and so they do without `up`, where it is unclear.
PositionChoice choose_positions(const Hierarchy& hierarchy, const SampleRows& rows,
                                std::optional<Direction> up);

}  // namespace krok::bvh
