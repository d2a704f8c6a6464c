#pragma once

#include <string>
#include <vector>

#include "core/result.h"
#include "formats/acclaim/skeleton_file_internal.h"
#include "formats/acclaim/source_text_internal.h"
#include "math/euler.h"

namespace krok::acclaim {

// Whether a token is a section keyword, which ends the previous section.
inline bool is_section(const Token& token) {
  return token.starts_line && token.text.starts_with(':');
}

// The orientation of `axis` and `orientation`: angles about x, y and z, always stored in that
// order, and the order in which they are applied.
struct PrintedAxes {
  Vec3 angles = Vec3::Zero();
  EulerOrder order = {Axis::x, Axis::y, Axis::z};

  Quat rotation(double radians) const;
};

// Parses the elements of ASF sections at `cursor`. `what` and `whose` are for messages. Both
// constructor arguments must outlive this.
class ItemParser {
 public:
  ItemParser(SourceText& source, TokenCursor& cursor) : source_(source), cursor_(cursor) {}

  Result<double> number(const std::string& what);
  Status vector(const std::string& what, Vec3& vector);

  // The channels of `dof` or `order`, to the end of the line.
  Status channels(std::vector<Channel>& channels, const std::string& whose);

  // The word after the three angles of an axis, which some exporters omit.
  Status axis_order(const std::string& whose, EulerOrder& order);

  // Skips an unknown line with a warning; it may be a vendor extension.
  Status skip_unknown(const Token& token);

 private:
  SourceText& source_;
  TokenCursor& cursor_;
};

}  // namespace krok::acclaim
