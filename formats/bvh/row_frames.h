#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "capture/far_values.h"
#include "formats/bvh/kinematics.h"
#include "formats/bvh/motion_rows.h"

namespace krok::bvh {

// Converts rows of a file to frames, a block of rows at a time. The text must outlive it.
class RowFrames {
 public:
  // `rows`: offsets, RowIndex::kFaulty for rows to skip. `careful`: the rows are known to be
  // complete; otherwise each must end where the next begins.
  RowFrames(std::string_view text, std::vector<std::size_t> rows, std::size_t channels,
            Kinematics kinematics, bool careful)
      : text_(text),
        rows_(std::move(rows)),
        channels_(channels),
        kinematics_(std::move(kinematics)),
        careful_(careful) {}

  const std::vector<std::size_t>& rows() const { return rows_; }
  const Kinematics& kinematics() const { return kinematics_; }

  struct Outcome {
    bool row_is_faulty = false;           // a row is incomplete; the other results are undefined
    std::optional<std::size_t> overflow;  // the first row with positions out of float range
    FarValues far;                        // rows with implausibly large values
  };

  // Computes the frames of rows [first, first + count), shape [count x joints]; frames of faulty
  // rows are undefined. Thread-safe.
  Outcome read(std::size_t first, std::size_t count, std::span<Vec3f> positions,
               std::span<Quatf> orientations) const;

 private:
  // Checks frames for which poses() returned false; `values` as passed to it.
  void look_at_frames(std::size_t first, std::size_t frames, const double* values,
                      std::span<const Vec3f> positions, Outcome& outcome) const;
  bool parse_plain_row(std::size_t row, double* values, std::vector<std::uint32_t>& edges) const;
  bool parse_whole_row(std::size_t row, double* values) const;

  std::string_view text_;
  std::vector<std::size_t> rows_;
  std::size_t channels_;
  Kinematics kinematics_;
  bool careful_;
};

}  // namespace krok::bvh
