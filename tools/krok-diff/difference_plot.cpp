#include "difference_plot.h"

#include <fmt/format.h>

#include "core/file.h"
#include "core/text.h"
#include "draw/difference_chart.h"
#include "roles/roles.h"
#include "tools/common/output_set.h"

namespace krok::diff {

Status check_plot_name(const std::string& path) {
  const std::string ending = extension(path);
  if (ending.empty() || ending == ".svg") return {};
  return Error(
      "usage",
      fmt::format("--plot {}: what is written there is an SVG, not {}", path, shown(ending)),
      "call it .svg");
}

Status write_plot(const PlottedClip& first, const PlottedClip& second, const std::string& path,
                  ToolContext& context) {
  const RoleMap first_roles = find_roles(first.clip->skeleton);
  const RoleMap second_roles = find_roles(second.clip->skeleton);
  draw::ChartedMotion a{first.name, first.clip, &first_roles, {}, {}};
  draw::ChartedMotion b{second.name, second.clip, &second_roles, {}, {}};
  a.frames = {0, first.clip->frame_count() - 1};
  b.frames = {0, second.clip->frame_count() - 1};
  const auto difference = draw::difference_over_time(a, b, {});
  if (!difference) {
    context.warn("diff-plot", fmt::format("{} is not drawn: {}", path, difference.error().message));
    return {};
  }
  draw::Figure figure;
  figure.title = fmt::format("{} and {}", first.name, second.name);
  figure.panels = draw::difference_panels(*difference, draw::Scale::linear);
  const auto svg = draw::to_svg(figure);
  if (!svg) return svg.error();
  return write_output(context, path, [&](OutputFile& file) { return file.write(*svg); });
}

}  // namespace krok::diff
