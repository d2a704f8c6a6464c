#pragma once

#include <cstddef>
#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "capture/conventions.h"
#include "core/result.h"
#include "formats/bvh/bvh_reader.h"
#include "formats/bvh/hierarchy.h"

namespace krok::bvh {

// The lines between MOTION and the first row.
struct MotionHeader {
  long long frames = 0;           // as announced
  std::size_t frames_offset = 0;  // of the number
  std::string_view frame_time_text;
  double frame_time = 0;
  std::size_t frame_time_offset = 0;
  std::size_t end = 0;  // offset of the rows
};

// Parses "Frames:" and "Frame Time:" from byte `begin` on, in either order, any case and spacing.
Result<MotionHeader> parse_motion_header(std::string_view text, std::size_t begin,
                                         const std::string& file_name, const ReadOptions& options,
                                         Diagnostics& diagnostics);

// Offsets of the rows. A faulty row that --repair fills has none.
struct RowIndex {
  static constexpr std::size_t kFaulty = std::numeric_limits<std::size_t>::max();
  std::vector<std::size_t> begins;   // [frames] byte offsets, or kFaulty
  std::vector<std::string> repairs;  // frames dropped or to be filled, as text
};

// Parses `values.size()` numbers from byte `begin` on. Returns the offset after the last one, or
// kFaulty if one is missing, incomplete or out of float range.
std::size_t parse_row(std::string_view text, std::size_t begin, std::span<double> values);
// The same for `count` numbers, stored `stride` elements apart.
std::size_t parse_row(std::string_view text, std::size_t begin, double* values, std::size_t count,
                      std::size_t stride);

// Offsets of the rows if each non-empty line is a row. Only searches for line ends, so a row may
// still be invalid when parsed; index_rows_with_care() then finds the fault. Uses `jobs` threads,
// as in parallel_for. `release` may be empty; it is called as in open().
std::vector<std::size_t> index_lines(std::string_view text, std::size_t begin, int jobs = 1,
                                     const std::function<void(std::size_t offset)>& release = {});

// Finds the rows of any file and reports all faults according to the strictness: rows over several
// lines, rows with too few or too many values, invalid numbers, text after the data, a wrong frame
// count.
Result<RowIndex> index_rows_with_care(std::string_view text, const MotionHeader& header,
                                      const Hierarchy& hierarchy, const std::string& file_name,
                                      const ReadOptions& options, Diagnostics& diagnostics);

// BVH has no place for the unit of length. What this project writes, always in Krok's axes, has it
// in blanks after the Frame Time, which readers skip: a tab, a space, the unit in three blanks (a
// tab is a one) and a tab.

// Empty for units without a mark: all but m, dm, cm, mm, in, ft and cmu.
std::string unit_mark(double metres);

// `rest` is what follows the Frame Time on its line; nullopt if it is no mark.
std::optional<Unit> marked_unit(std::string_view rest);

}  // namespace krok::bvh
