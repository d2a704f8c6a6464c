#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "capture/conventions.h"
#include "scene/skeleton.h"

// Which program a capture comes from, by the names of its joints and the way it is written.
// Information for the user alone: nothing that is read depends on it.

namespace krok {

struct Exporter {
  std::string name;    // "iPi Mocap Studio, own names"
  std::string reason;  // a sentence without a full stop
  Confidence confidence = Confidence::guess;
};

// What a reader of a text format knows beside the skeleton.
struct ExporterTraits {
  std::string_view frame_time;  // as printed, without blanks; empty where there is none
  bool rows_begin_with_tab = false;
  bool starts_unturned = false;  // the first frame has no rotation anywhere
};

// The exporter whose joints are all there: certain where the names are hardly any other's, likely
// where others are known to use them too; nothing where no table fits. Names are compared without
// their case and name spaces.
std::optional<Exporter> recognise_exporter(const Skeleton& skeleton, const ExporterTraits& traits);

}  // namespace krok
