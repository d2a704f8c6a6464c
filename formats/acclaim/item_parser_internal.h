#pragma once

#include <string>
#include <vector>

#include "core/result.h"
#include "formats/acclaim/skeleton_file_internal.h"
#include "formats/acclaim/source_text_internal.h"
#include "math/euler.h"

namespace krok::acclaim {

// Whether a word is a section's keyword, which ends the section before it.
inline bool is_section(const Token& token) {
  return token.starts_line && token.text.starts_with(':');
}

// An orientation as `axis` and `orientation` have it: angles about x, y and z, whatever the order
// in which they are turned about.
struct PrintedAxes {
  Vec3 angles = Vec3::Zero();
  EulerOrder order = {Axis::x, Axis::y, Axis::z};

  Quat rotation(double radians) const;
};

// Reads what the sections of an ASF are made of from where `cursor` stands. `what` and `whose` are
// for messages. Both arguments must outlive this.
class ItemParser {
 public:
  ItemParser(SourceText& source, TokenCursor& cursor) : source_(source), cursor_(cursor) {}

  Result<double> number(const std::string& what);
  Status vector(const std::string& what, Vec3& vector);

  // The words of `dof` or `order`, to the end of the line.
  Status channels(std::vector<Channel>& channels, const std::string& whose);

  // The word after the three angles of an axis, which some exporters leave out.
  Status axis_order(const std::string& whose, EulerOrder& order);

  // Lines that a section does not know may be a vendor's own.
  Status skip_unknown(const Token& token);

 private:
  SourceText& source_;
  TokenCursor& cursor_;
};

}  // namespace krok::acclaim
