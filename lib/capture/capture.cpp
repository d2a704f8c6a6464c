#include "capture/capture.h"
#include "scene/frame_moment.h"

#include <fmt/format.h>

#include <cmath>

namespace krok {

Result<RoleMap> roles_of(const Skeleton& skeleton, const CaptureOptions& options) {
  return options.roles ? options.roles(skeleton) : find_roles(skeleton);
}

Status check_rate(const std::optional<double>& rate, const std::string& code) {
  return rate ? check_frame_rate(*rate, code) : Status();
}

}  // namespace krok
