#include "ragdoll/body_mode.h"

namespace krok::ragdoll {

std::string_view body_mode_name(BodyMode mode) {
  switch (mode) {
    case BodyMode::simulated:
      return "simulated";
    case BodyMode::animated:
      return "animated";
    case BodyMode::powered:
      return "powered";
  }
  return "";
}

}  // namespace krok::ragdoll
