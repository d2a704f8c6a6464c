#include "tools/krok-edit/steps.h"
#include "tools/shared/planting.h"

namespace krok::cli::edit {

Status plant(const Options& options, ToolContext& context, Edit& edit) {
  if (!options.plant) return {};
  auto planted = cli::plant(edit.clip, edit.roles, edit.contacts, context);
  if (!planted) return planted.error();
  Json metrics = planting_json(*planted, edit.contacts.has_value());
  std::string line = planting_line(*planted);
  edit.clip = std::move(planted->clip);
  edit.note("plant", std::move(metrics), std::move(line));
  return {};
}

}  // namespace krok::cli::edit
