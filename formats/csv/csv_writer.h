#pragma once

#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/file.h"
#include "core/result.h"
#include "core/text.h"
#include "scene/frame_source.h"
#include "scene/morph_set.h"
#include "scene/motion_keys.h"

// Writes world positions of joints and morph target weights as CSV.

namespace krok::csv {

// The rows of one of several motions in one table: a first column "file" with this name. Empty: no
// such column.
struct FileColumn {
  std::string name;
  bool with_header = true;  // of the table, before the rows
};

// Appends the header "frame,time,joint,x,y,z" and a row for each frame and joint, in that order, to
// `file`; the caller commits. Frames are zero-based; time is frame / rate in seconds; x, y, z are
// metres in Krok's axes. Numbers have the fewest digits that round-trip (time as a double,
// positions as floats); names with a comma, a quote or a line break are quoted (RFC 4180), what
// printable() replaces is replaced (core/text.h), and names that a spreadsheet would run as a
// formula, with '=', '+', '-' or '@' in front, get an apostrophe, which Table removes. Lines end
// with LF. A motion without frames gives only the header. Errors are those of the source and of
// `file`, and clip-value.
Status write(const FrameSource& motion, OutputFile& file);

// Contacts: the header "joint,start,end,x,y,z" and a row for each, in seconds and metres; `names`
// are those of the joints.
Status write(std::span<const Contact> contacts, std::span<const std::string> names,
             const FileColumn& motion, OutputFile& file);

// Morph target weights: the header "frame,time," followed by the target names, then one row per
// frame. Numbers, names and lines as above.
Status write(const MorphWeights& weights, OutputFile& file);

// Writes values over time as CSV.

// Quantities of items, such as x, y, z of joints, at each frame.
struct SeriesTable {
  double rate = 30;
  int frames = 0;
  std::string item_name;                // header of the items' column: "joint"
  std::vector<std::string> items;       // "LeftFoot"
  std::vector<std::string> quantities;  // at least one: "x", "y", "z"
  // Gives the frames [first, first + count), [count x items x quantities]; NaN where there is no
  // value. Called in order, once for each frame.
  std::function<Result<std::vector<float>>(int first, int count)> values;

  std::size_t columns() const { return items.size() * quantities.size(); }
  // Passes the rows of all frames to `use`, in order. Errors are those of both.
  Status for_each_row(
      const std::function<Status(int frame, std::span<const float> row)>& use) const;
};

// Both append to `file`; the caller commits. Time is frame / rate in seconds. Numbers have the
// fewest digits that round-trip, missing values are empty fields; names with a comma, a quote or a
// line break are quoted (RFC 4180). Lines end with LF.

// "frame,time,joint,x,y,z" and a row for each frame and item.
Status write_long(const SeriesTable& table, const FileColumn& motion, OutputFile& file);

// "frame,time,LeftFoot.x,LeftFoot.y,..." and a row for each frame; of one quantity the names are
// those of the items.
Status write_wide(const SeriesTable& table, const FileColumn& motion, OutputFile& file);

// Whether a spreadsheet would run `text` as a formula (OWASP, CSV Injection), apostrophes at its
// begin aside. The writer puts an apostrophe before such names, and the table takes one away.
inline bool is_formula(std::string_view text) {
  const std::size_t at = text.find_first_not_of('\'');
  return at != std::string_view::npos &&
         std::string_view("=+-@\t\r").find(text[at]) != std::string_view::npos;
}

// A text field: printable, no formula to a spreadsheet, quoted if it has to be.
inline std::string field(std::string_view given) {
  std::string name;
  if (is_formula(given)) name += '\'';
  name += printable(given, true);
  if (name.find_first_of(",\"\r\n") == std::string::npos) return name;
  std::string text = "\"";
  for (const char c : name) {
    if (c == '"') text += '"';
    text += c;
  }
  return text + '"';
}

}  // namespace krok::csv
