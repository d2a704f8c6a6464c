#include <fmt/format.h>

#include "core/numbers.h"
#include "core/text.h"
#include "formats/correctives/correctives_format.h"
#include "tools/krok-info/describe.h"

namespace krok::cli::info {

Result<Description> describe_correctives(const InputFile& file, ToolContext&) {
  const auto read = correctives_file::read(file.text());
  if (!read) return read.error();
  Description out;
  out.what = "shapes by pose (.correctives)";
  out.json["kind"] = "correctives";
  std::vector<std::string> lines;
  Json joints = Json::array();
  for (const JointCorrective& joint : read->joints) {
    lines.push_back(fmt::format("{}: {} of {}", shown(joint.joint),
                                counted(joint.target_count(), "target"),
                                counted(std::ssize(joint.vertices), "vertex", "vertices")));
    joints.push_back({{"joint", joint.joint},
                      {"targets", joint.target_count()},
                      {"vertices", joint.vertices.size()}});
  }
  out.add("vertices", fmt::format("{}, of the model", grouped(read->vertex_count)));
  out.add("joints", std::move(lines));
  out.json["vertices"] = read->vertex_count;
  out.json["joints"] = std::move(joints);
  return out;
}

}  // namespace krok::cli::info
