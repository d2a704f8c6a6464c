#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "core/result.h"
#include "core/text.h"
#include "formats/bvh/hierarchy.h"
#include "formats/bvh/row_lines_internal.h"

namespace krok::bvh {

// Builds error messages for invalid rows, with their location. All arguments must outlive this.
class RowFaults {
 public:
  RowFaults(std::string_view text, const Hierarchy& hierarchy, const std::string& file_name)
      : text_(text),
        hierarchy_(hierarchy),
        channels_(hierarchy.channels.size()),
        locate_(text, file_name) {}

  Error error_at(std::size_t offset, std::string code, std::string message);

  // The first invalid number in the row at `begin`, which has the expected number of values.
  Error number_fault(std::size_t begin);
  // `word` at byte `at`, the value of `channel`.
  Error number_fault_at(std::string_view word, std::size_t at, std::size_t channel);

  // A line with too many or too few values.
  Error length_fault(const Line& line);

  // `begin` .. `end` has `values` values, too few; the reported location is that of the next one.
  Error short_fault(std::size_t begin, std::size_t end, std::size_t values);

  // The hint for a word that is not a number.
  static const char* hint_for(std::string_view word);

 private:
  std::string_view text_;
  const Hierarchy& hierarchy_;
  const std::size_t channels_;
  Locator locate_;
};

}  // namespace krok::bvh
