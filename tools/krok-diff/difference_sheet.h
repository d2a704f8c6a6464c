#pragma once

#include <functional>
#include <optional>
#include <string>

#include "compare/measure.h"
#include "compare/scene_difference.h"
#include "core/result.h"
#include "render/actor.h"
#include "render/sheet.h"
#include "scene/clip.h"
#include "scene/model.h"
#include "tools/common/actors/image.h"
#include "tools/common/tool.h"

// A picture of two figures and of where they differ.

namespace krok::diff {

inline constexpr int kDifferenceMoments = 6;

struct SheetOptions {
  std::string path;  // empty for none
  ImageOptions image;
};

// Both figures at one moment. In `coloured`, the second figure, each point has the colour of its
// distance to the first one's; without a key, or where points do not correspond, its own.
struct Compared {
  render::Actor first, second, coloured;
  std::optional<double> largest;  // metres, where distances were measured
};

struct DifferenceSheet {
  std::string first_name, second_name;
  ImageSpan span;
  std::optional<ImageMoment> worst;  // where the difference is largest: shown in any case
  double largest = 0;                // metres
  double tolerance = 0;              // metres
  double heading = 0;                // where the first faces, radians about +Y
  bool measured = true;              // whether distances can be told
  std::function<Compared(const ImageMoment& moment, const render::ColourKey& key)> at;
};

// What to draw of two clips, models or scenes, which must outlive it. `found` is the measured
// difference of positions.
DifferenceSheet sheet_of(const Clip& first, const Clip& second, const compare::Measure& found);
DifferenceSheet sheet_of(const Model& first, const Model& second, const compare::Measure& found);
DifferenceSheet sheet_of(const compare::Scene& first, const compare::Scene& second,
                         const compare::Measure& found, compare::Matching matching);

// Colours of distances: grey up to the tolerance, then from blue over yellow to red at the largest.
struct DistanceColours {
  render::ColourKey key;
  double in_a_metre = 1;  // of the key's unit

  render::Colour at(double metres) const { return key.at(metres * in_a_metre); }
};
DistanceColours distance_colours(double tolerance, double largest);

// Draws it, writes the picture and notes it in the report.
Status write_sheet(const DifferenceSheet& sheet, const SheetOptions& options, ToolContext& context);

}  // namespace krok::diff
