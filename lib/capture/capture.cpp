#include "capture/capture.h"

#include <fmt/format.h>

#include <cmath>

namespace krok {

Result<RoleMap> roles_of(const Skeleton& skeleton, const CaptureOptions& options) {
  return options.roles ? options.roles(skeleton) : find_roles(skeleton);
}

Status check_rate(const std::optional<double>& rate, const std::string& code) {
  if (!rate || (*rate > 0 && std::isfinite(*rate))) return {};
  return Error(code, fmt::format("a frame rate of {} fps is not positive and finite", *rate));
}

}  // namespace krok
