#pragma once

#include "core/file.h"
#include "core/result.h"
#include "scene/clip.h"
#include "scene/morph_set.h"

// World positions of joints and weights of morph targets as text for spreadsheets and scripts.

namespace krok::csv {

// Appends the header "frame,time,joint,x,y,z" and a row for each frame and joint, in that order, to
// `file`; the caller commits. Frames count from 0; time is frame / rate in seconds; x, y, z are
// metres in Krok's frame. Numbers are the shortest that read back the same (time as a double, the
// positions as floats); names with a comma, a quote or a line break are quoted as RFC 4180 has it.
// Lines end with LF. A clip without frames gives the header alone. An Error for what check()
// refuses.
Status write(const Clip& clip, OutputFile& file);

// Weights of morph targets: the header "frame,time," and the targets' names, then a row a frame.
// Numbers, names and lines as above.
Status write(const MorphWeights& weights, OutputFile& file);

}  // namespace krok::csv
