#include "tools/krok-info/volumes.h"

#include <fmt/format.h>

#include <cmath>

namespace krok::cli::info {

void add_volumes(const std::vector<NamedVolume>& volumes, Description& out) {
  constexpr double kLitres = 1000;  // per cubic metre
  std::vector<std::string> lines;
  out.json["volumes"] = Json::array();
  for (const auto& [mesh, measured] : volumes) {
    const bool known = measured.closed && std::isfinite(measured.volume);
    out.json["volumes"].push_back({{"mesh", mesh},
                                   {"volume", known ? Json(measured.volume) : Json()},
                                   {"area", measured.area}});
    if (!known) continue;
    lines.push_back(fmt::format("{}{} litres", mesh.empty() ? "" : mesh + ": ",
                                readable(measured.volume * kLitres, 4)));
  }
  out.add("volume", std::move(lines));
}

}  // namespace krok::cli::info
