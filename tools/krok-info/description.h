#pragma once

#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "capture/convention_choice.h"
#include "core/numbers.h"
#include "math/transform.h"
#include "scene/mesh_volume.h"
#include "scene/provenance.h"
#include "tools/cli/report.h"

// The description of a file as text and as JSON, and parts common to several kinds of files.

namespace krok::cli::info {

// Rows with a label and one or more lines.
struct Description {
  Description() = default;
  Description(std::string it_is, std::string_view kind) : what(std::move(it_is)) {
    json["kind"] = kind;
  }

  std::string what;  // "a motion (.anim)"
  struct Row {
    std::string label;
    std::vector<std::string> lines;
  };
  std::vector<Row> rows;
  Json json = Json::object();

  void add(std::string label, std::string line);
  void add(std::string label, std::vector<std::string> lines);  // nothing for no lines
};

// Labels in one column, values in the next; control characters are replaced.
std::string to_text(const std::string& path, const Description& description);

// A detected convention that the file does not state, with confidence and reason.
void add_choice(const std::string& key, const Choice& choice, Description& out);

// Unit, up and forward.
void add_conventions(const Conventions& conventions, Description& out);

// Frames, rate and duration.
void add_timing(int frames, double rate, Description& out);

// Extent along each axis; height is that along Y. `measured` says what: "joints in the reference
// pose". Adds nothing without points.
template <typename Point>
void add_size(std::span<const Point> points, const std::string& measured, Description& out);
void add_size(const Eigen::AlignedBox3d& box, const std::string& measured, Description& out);

void add_provenance(const Provenance& provenance, Description& out);

template <typename Point>
void add_size(std::span<const Point> points, const std::string& measured, Description& out) {
  Eigen::AlignedBox3d box;
  for (const Point& point : points) box.extend(point.template cast<double>());
  add_size(box, measured, out);
}

struct NamedVolume {
  std::string mesh;  // empty if there is only one
  MeshVolume measured;
};

// Text: volumes of the closed meshes in litres. JSON: volume (cubic metres; null for open meshes)
// and area (square metres) of all meshes.
void add_volumes(const std::vector<NamedVolume>& volumes, Description& out);

// Many files at a glance: a row for each (kind, frames, rate, duration, joints, body), then how
// many of what kind, how long they are together, at which rates and of how many skeletons. `files`
// as in the report; those that could not be read have no kind.
std::string folder_summary(const Json& files);

}  // namespace krok::cli::info
