#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "core/result.h"
#include "core/text.h"
#include "formats/bvh/hierarchy.h"
#include "formats/bvh/row_lines_internal.h"

namespace krok::bvh {

// The words for what is wrong with a row, with its place. All arguments must outlive this.
class RowFaults {
 public:
  RowFaults(std::string_view text, const Hierarchy& hierarchy, const std::string& file_name)
      : text_(text),
        hierarchy_(hierarchy),
        channels_(hierarchy.channels.size()),
        locate_(text, file_name) {}

  Error error_at(std::size_t offset, std::string code, std::string message);

  // The first value that is no number of the row at `begin`, which has as many as there should be.
  Error number_fault(std::size_t begin);
  // `word` at byte `at`, which stands for a channel.
  Error number_fault_at(std::string_view word, std::size_t at, std::size_t channel);

  // A line with too many or too few values.
  Error length_fault(const Line& line);

  // `begin` .. `end` holds `values` values, too few; the place told is where the next should stand.
  Error short_fault(std::size_t begin, std::size_t end, std::size_t values);

  // What to do about a word that is no number.
  static const char* hint_for(std::string_view word);

 private:
  std::string_view text_;
  const Hierarchy& hierarchy_;
  const std::size_t channels_;
  Locator locate_;
};

}  // namespace krok::bvh
