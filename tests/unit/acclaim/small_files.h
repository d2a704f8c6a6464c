#pragma once

#include <string>

// An ASF and an AMC that a person can compute: a leg of two bones, a tail that stretches and
// shifts.

namespace small_files {

inline const std::string kAsf =
    "# a leg and a tail\n"
    ":version 1.10\n"
    ":name two bones # and more\n"
    ":units\n"
    "  mass 1.0\n"
    "  length 1.0\n"
    "  angle deg\n"
    ":documentation\n"
    "  made by hand, # this too\n"
    "  for tests\n"
    ":root\n"
    "  order TX TY TZ RX RY RZ\n"
    "  axis XYZ\n"
    "  position 0 0 0\n"
    "  orientation 0 0 0\n"
    ":bonedata\n"
    "  begin\n"
    "    id 1\n"
    "    name thigh\n"
    "    direction 0 -1 0\n"
    "    length 4\n"
    "    axis 0 0 0 XYZ\n"
    "    dof rz rx\n"
    "    limits (-inf inf)\n"
    "           (-90.0 45)\n"
    "    bodymass 10\n"
    "  end\n"
    "  begin\n"
    "    id 2\n"
    "    name shin\n"
    "    direction 0 -1 0\n"
    "    length 5\n"
    "    axis 0 90 0 XYZ\n"
    "    dof rx\n"
    "    limits (0 170)\n"
    "  end\n"
    "  begin\n"
    "    id 3\n"
    "    name tail\n"
    "    direction 0 0 -1\n"
    "    length 2\n"
    "    axis 0 0 90 XYZ\n"
    "    dof tx l\n"
    "    limits (-1 1) (2 inf)\n"
    "  end\n"
    "  begin\n"
    "    id 4\n"
    "    name tip\n"
    "    direction 0 0 -1\n"
    "    length 1\n"
    "    axis 0 0 0 XYZ\n"
    "  end\n"
    ":hierarchy\n"
    "  begin\n"
    "    root thigh tail\n"
    "    thigh shin\n"
    "    tail tip\n"
    "  end\n";

inline const std::string kAmc =
    "# frames\n"
    ":FULLY-SPECIFIED\n"
    ":DEGREES\n"
    "1\n"
    "root 0 9 0 0 0 0\n"
    "thigh 0 0\n"
    "shin 0\n"
    "tail 0 2\n"
    "2\n"
    "root 1 9 0 0 90 0\n"
    "thigh 0 90\n"
    "shin 90\n"
    "tail 0.5 3\n"
    "3\n"
    "root 1 9 0 0 0 0\n"
    "thigh 90 90\n"
    "shin 0\n"
    "tail 0 2\n";

// `text` with `from`, which must be there, replaced once.
inline std::string with(std::string text, const std::string& from, const std::string& to) {
  return text.replace(text.find(from), from.size(), to);
}

}  // namespace small_files
