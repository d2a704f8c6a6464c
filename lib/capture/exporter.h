#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "capture/conventions.h"
#include "scene/skeleton.h"

// Detects the program that wrote a capture from its joint names and number formatting. Informative
// only: reading does not depend on it.

namespace krok {

struct Exporter {
  std::string name;    // "iPi Mocap Studio, own names"
  std::string reason;  // a sentence without a full stop
  Confidence confidence = Confidence::guess;
  // Axes of all its files, where they are known and their skeletons do not show them.
  std::optional<Direction> up = {}, forward = {};
};

// Axes of a recognised exporter's files, in place of what one take seems to show: those detected
// with certainty, and from the reference pose, stay.
void apply_exporter(const Exporter& exporter, Conventions& conventions);

// Properties of a text file other than its skeleton.
struct ExporterTraits {
  std::string_view frame_time;  // as printed, without blanks; empty if there is none
  bool rows_begin_with_tab = false;
  bool starts_unturned = false;  // all rotations of the first frame are zero
};

// The exporter whose characteristic joint names are all present: `certain` if the names are nearly
// unique to it, `likely` if other programs use them too; empty if none matches. Comparison ignores
// case and namespaces.
std::optional<Exporter> recognise_exporter(const Skeleton& skeleton, const ExporterTraits& traits);

}  // namespace krok
