#include "methods.h"

namespace krok::bench {
Clip kovar_2002(const Clip& clip, const RoleMap&, const std::vector<FixedStay>&) {
  return clip;
}
}  // namespace krok::bench
