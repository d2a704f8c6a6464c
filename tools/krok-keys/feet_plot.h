#pragma once

#include <string>

#include "contacts/contacts.h"
#include "core/result.h"
#include "scene/clip.h"

namespace krok::cli::keys {

// SVG plot of height above the support and speed of each foot's points over time, with contacts as
// bars and keytimes as vertical lines.
Result<std::string> feet_plot(const std::string& title, const Clip& clip,
                              const FoundContacts& found, const MotionKeys& keys);

}  // namespace krok::cli::keys
