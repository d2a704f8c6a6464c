#pragma once

#include <cstddef>
#include <functional>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/result.h"
#include "formats/bvh/bvh_reader.h"
#include "formats/bvh/hierarchy.h"

namespace krok::bvh {

// What stands between MOTION and the first row.
struct MotionHeader {
  long long frames = 0;           // as announced
  std::size_t frames_offset = 0;  // where the number stands
  std::string_view frame_time_text;
  double frame_time = 0;
  std::size_t frame_time_offset = 0;
  std::size_t end = 0;  // where the rows begin
};

// Parses "Frames:" and "Frame Time:" from byte `begin` on, in either order, any case and spacing.
Result<MotionHeader> parse_motion_header(std::string_view text, std::size_t begin,
                                         const std::string& file_name, const ReadOptions& options,
                                         Diagnostics& diagnostics);

// Where rows begin. A faulty row that --repair fills has no place.
struct RowIndex {
  static constexpr std::size_t kFaulty = std::numeric_limits<std::size_t>::max();
  std::vector<std::size_t> begins;   // [frames] byte offsets, or kFaulty
  std::vector<std::string> repairs;  // what was left out or is to be filled
};

// Parses `values.size()` numbers from byte `begin` on. Returns the offset after the last one, or
// kFaulty if they are not all there, whole and within what a float holds.
std::size_t parse_row(std::string_view text, std::size_t begin, std::span<double> values);
// The same for `count` numbers, each stored `stride` places behind the one before.
std::size_t parse_row(std::string_view text, std::size_t begin, double* values, std::size_t count,
                      std::size_t stride);

// Where rows begin if each line that is not empty is a row: a search for line ends alone, so rows
// may prove faulty when they are parsed; index_rows_with_care() then says what is wrong.
// On `jobs` threads, as in parallel_for. `release`, which may be empty, is told which text is done
// with, as in open().
std::vector<std::size_t> index_lines(std::string_view text, std::size_t begin, int jobs = 1,
                                     const std::function<void(std::size_t offset)>& release = {});

// Finds the rows of any file, and tells all faults: rows over several lines, rows too short or too
// long, numbers that are none, text after the data, a count that disagrees. Goes by strictness.
Result<RowIndex> index_rows_with_care(std::string_view text, const MotionHeader& header,
                                      const Hierarchy& hierarchy, const std::string& file_name,
                                      const ReadOptions& options, Diagnostics& diagnostics);

}  // namespace krok::bvh
