#include "timeline/timeline.h"

namespace krok::timeline {

std::string_view change_name(ChangeKind kind) {
  switch (kind) {
    case ChangeKind::cut:
      return "cut";
    case ChangeKind::crossfade:
      return "crossfade";
    case ChangeKind::smooth:
      return "smooth";
    case ChangeKind::inertial:
      return "inertial";
  }
  return "change";
}

}  // namespace krok::timeline
