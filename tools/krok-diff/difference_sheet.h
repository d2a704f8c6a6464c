#pragma once

#include <functional>
#include <optional>
#include <string>

#include "compare/clip_difference.h"
#include "compare/measure.h"
#include "compare/scene_difference.h"
#include "core/result.h"
#include "render/actor.h"
#include "render/sheet.h"
#include "scene/clip.h"
#include "tools/cli/tool.h"
#include "tools/shared/image.h"

// An image of two characters and their differences.

namespace krok::cli::diff {

inline constexpr int kDifferenceMoments = 6;

struct SheetOptions {
  std::string path;  // empty for none
  ImageOptions image;
};

// Both characters at one time. `coloured` is the second, with points coloured by their distance to
// the first; without a colour key, or if points do not correspond, in its own colours.
struct Compared {
  render::Actor first, second, coloured;
  std::optional<double> largest;  // metres, if distances were measured
};

struct DifferenceSheet {
  std::string first_name, second_name;
  ImageSpan span;
  std::optional<ImageMoment> worst;  // the time of the max difference; always shown
  double largest = 0;                // metres
  double tolerance = 0;              // metres
  double heading = 0;                // facing of the first, radians about +Y
  bool measured = true;              // whether distances could be measured
  std::function<Compared(const ImageMoment& moment, const render::ColourKey& key)> at;
};

// The sheet of two clips or scenes, which must outlive it. `found` is the measured
// difference of positions. `dressed`: both in the base colours of their materials.
DifferenceSheet sheet_of(const Clip& first, const Clip& second, const compare::Measure& found);
DifferenceSheet sheet_of(const Scene& first, const Scene& second, const compare::Measure& found,
                         compare::Matching matching, bool dressed);

// Colours of distances: grey up to the tolerance, then from blue over yellow to red at the max.
struct DistanceColours {
  render::ColourKey key;
  double in_a_metre = 1;  // of the key's unit

  render::Colour at(double metres) const { return key.at(metres * in_a_metre); }
};
DistanceColours distance_colours(double tolerance, double largest);

// Both characters and their difference at the time of the max difference, for a page. All three at
// one scale, seen from the front left.
struct Pictures {
  std::string before, after, difference;  // PNG as base64
  int width = 0, height = 0;              // pixels of each
  std::string moment;                     // "frame 24, 0.40 s"; empty without motion
  std::optional<render::ColourKey> key;   // of the difference; empty if nothing was measured
};

// Codes: those of render::make_sheet.
Result<Pictures> make_pictures(const DifferenceSheet& sheet, int jobs);

// Draws the sheet, writes the image and adds it to the report.
Status write_sheet(const DifferenceSheet& sheet, const SheetOptions& options, ToolContext& context);

// Mesh differences as vertex colours of the first mesh.

// Writes the first scene's meshes, in the pose of the max difference, with each vertex coloured by
// its max distance over all times (`found` must have kept them), and prints the legend. If no mesh
// was compared: a warning, and no file.
Status write_heatmap(const Scene& first, const compare::SceneDifference& found,
                     const std::string& path, ToolContext& context);

// The same for two scenes that were not compared as such.
Status write_heatmap(const Scene& first, const Scene& second, const compare::SceneOptions& options,
                     const std::string& path, ToolContext& context);

// Charts of the differences of two motions or scenes over time: max and RMS, the tolerance, and the
// time of the max.

struct PlottedClip {
  std::string name;
  const Clip* clip = nullptr;
};

struct Plot {
  std::string svg;
  std::size_t left_out = 0;  // animations that differ but are not drawn
};

// The differences of joint positions and orientations. Code diff-plot if the clips have no joint or
// time in common.
Result<Plot> plot_of(const PlottedClip& first, const PlottedClip& second,
                     const compare::ClipDifference& found);

struct PlottedScenes {
  std::string first_name, second_name;
  const Scene* first = nullptr;
  const compare::SceneDifference* found = nullptr;
};
// The differences of vertex positions, normals and tangents and of joint positions and
// orientations, at the times compared; for several animations, of those that differ, at most eight.
// Code diff-plot if the scenes are static.
Result<Plot> plot_of(const PlottedScenes& scenes);

// Writes the SVG. If there is nothing to draw (diff-plot): a warning, and no file.
Status write_plot(const Result<Plot>& plot, const std::string& path, ToolContext& context);

}  // namespace krok::cli::diff
