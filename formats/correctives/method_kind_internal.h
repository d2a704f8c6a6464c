#pragma once

#include "formats/json/fields.h"
#include "skin/skin.h"

namespace krok {

// The skinning method that correctives correct.
inline json::Kind<SkinMethod> skin_method_kind() {
  return json::choice<SkinMethod>({{"linear", SkinMethod::linear},
                                   {"dual-quaternion", SkinMethod::dual_quaternion},
                                   {"spherical", SkinMethod::spherical},
                                   {"rigid", SkinMethod::rigid}});
}

}  // namespace krok
