#include "capture/joint_name.h"

#include "core/text.h"

namespace krok {

std::string readable_joint_name(std::string_view bytes) {
  std::string name = to_utf8(bytes);
  for (char& c : name) {
    const auto code = static_cast<unsigned char>(c);
    if ((code < 32 && c != '\t') || code == 127) c = '_';
  }
  return name;
}

}  // namespace krok
