#pragma once

#include <string>

#include "contacts/contacts.h"
#include "core/result.h"
#include "scene/clip.h"

namespace krok::keys_tool {

// Heights over the support and speeds of the points of each foot over time, contacts as bars,
// keytimes as lines across, as SVG.
Result<std::string> feet_plot(const std::string& title, const Clip& clip,
                              const FoundContacts& found, const MotionKeys& keys);

}  // namespace krok::keys_tool
