#include "tools/shared/walk_page.h"

#include <fmt/format.h>

#include "core/numbers.h"
#include "tools/shared/body_choice.h"
#include "tools/shared/shown_ground.h"

namespace krok::cli {

std::string facts_of(const Clip& clip) {
  if (clip.frame_count() == 0) return fmt::format("{} joints, no motion", clip.joint_count());
  return fmt::format("{} s, {} fps, {} frames, {} joints", readable(clip.duration(), 3),
                     readable(clip.rate), clip.frame_count(), clip.joint_count());
}

Result<std::string> walk_page(const std::string& name, const Clip& clip, const MotionKeys& keys,
                              const Terrain& ground, std::span<const gait::Print> prints,
                              ToolContext& context) {
  const auto body = make_body(clip, body_options(BodyChoice::medium, context));
  if (!body) return body.error();
  draw::ViewerPage page;
  page.title = name;
  draw::ViewedMotion& motion = page.motions.emplace_back();
  motion.name = name;
  motion.facts = facts_of(clip);
  motion.clip = &clip;
  motion.body = &body->model;
  motion.keys = keys;
  if (Status status = add_ground(&ground, prints, page, context); !status) return status.error();
  return draw::write_viewer_page(page);
}

}  // namespace krok::cli
