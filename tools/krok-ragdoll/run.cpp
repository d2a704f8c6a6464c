#include "tools/krok-ragdoll/run.h"

#include <fmt/format.h>

#include <optional>

#include "core/hash.h"
#include "core/index.h"
#include "core/nearest_name.h"
#include "core/text.h"
#include "formats/anim/anim.h"
#include "formats/goals/goals.h"
#include "formats/io/open_motion.h"
#include "formats/limits/limits_format.h"
#include "formats/model/model_format.h"
#include "formats/ragdoll/ragdoll_format.h"
#include "ik/anatomical_limits.h"
#include "ragdoll/simulate.h"
#include "tools/cli/output_kind.h"
#include "tools/cli/output_set.h"
#include "tools/krok-ragdoll/ground.h"
#include "tools/shared/role_input.h"

namespace krok::cli::ragdoll {

namespace {

class Run {
 public:
  Run(const Options& options, ToolContext& context) : options_(options), context_(context) {}

  Result<int> run();

 private:
  const Arguments& given() const { return options_.given; }
  Status read_motion();
  Status read_limits();
  Status read_bodies();
  Status read_given_bodies();
  Status write(const Clip& fall) const;
  Status add_pushes();
  Status read_ground();
  Json report(const krok::ragdoll::Fall& fall) const;

  const Options& options_;
  ToolContext& context_;
  Clip clip_;
  RoleMap roles_;
  krok::ik::Limits limits_;
  std::vector<krok::ragdoll::Body> bodies_;
  krok::ragdoll::FallOptions fall_;
};

Status Run::read_motion() {
  auto clip = io::open_motion(given().input, context_);
  if (!clip) return clip.error();
  clip_ = std::move(*clip);
  const auto find = io::open_role_map(given().map, context_);
  if (!find) return find.error();
  auto roles = (*find)(clip_.skeleton);
  if (!roles) return roles.error();
  roles_ = std::move(*roles);
  fall_.at = options_.at.seconds(clip_.rate);
  fall_.duration = options_.duration;
  if (clip_.frame_count() == 0 || fall_.at > clip_.duration() + 1e-9) {
    return Error("ragdoll-time", fmt::format("--at {} is after the motion's end, {} s",
                                             shown(given().at), clip_.duration()))
        .in_file(given().input);
  }
  return {};
}

Status Run::read_limits() {
  if (given().limits == "none") return {};
  if (given().limits == "auto") {
    limits_ = krok::ik::anatomical_limits(clip_.skeleton, roles_);
    return {};
  }
  const auto file = context_.open_input(given().limits);
  if (!file) return file.error();
  auto limits = limits::read(file->text(), clip_.skeleton);
  if (!limits) return std::move(limits).error().in_file(given().limits);
  limits_ = std::move(*limits);
  return {};
}

Status Run::read_given_bodies() {
  const auto file = context_.open_input(given().bodies);
  if (!file) return file.error();
  auto read = ragdoll_file::read(file->text(), &clip_.skeleton);
  if (!read) return std::move(read).error().in_file(given().bodies);
  bodies_ = std::move(read->bodies);
  fall_.rules = std::move(read->joints);
  return {};
}

Status Run::read_bodies() {
  if (!given().bodies.empty()) return read_given_bodies();
  krok::ragdoll::BodyOptions how;
  how.mass = options_.mass;
  std::optional<Model> model;
  if (!given().model.empty()) {
    const auto file = context_.open_input(given().model);
    if (!file) return file.error();
    auto read = model::read(file->bytes());
    if (!read) return std::move(read).error().in_file(given().model);
    model = std::move(*read);
    how.model = &*model;
  }
  auto bodies = krok::ragdoll::make_bodies(clip_.skeleton, roles_, how);
  if (!bodies) {
    const bool of_model = bodies.error().code == "ragdoll-model";
    return std::move(bodies).error().in_file(of_model ? given().model : given().input);
  }
  bodies_ = std::move(*bodies);
  // Through rules even if no file is written, so that a saved file gives the same fall.
  fall_.joints.soft = given().soft;
  const std::vector<Transform> pose = krok::ragdoll::pose_at(clip_, fall_.at);
  fall_.rules = krok::ragdoll::rules_of(
      krok::ragdoll::make_joints(clip_.skeleton, roles_, bodies_, limits_, pose, fall_.joints),
      clip_.skeleton, bodies_, limits_, pose);
  return {};
}

Status Run::add_pushes() {
  const std::vector<int> carrier = krok::ragdoll::body_of_joint(clip_.skeleton, bodies_);
  for (const PushAt& push : options_.pushes) {
    const int joint = goals::find_joint(push.joint, clip_.skeleton, roles_);
    if (joint < 0) {
      return Error("ragdoll-joint",
                   fmt::format("--push {}: the motion has no joint of that name or role",
                               shown(push.joint)),
                   nearest_hint(push.joint, clip_.skeleton.names))
          .in_file(given().input);
    }
    const double time = push.timed ? push.time.seconds(clip_.rate) : fall_.at;
    if (time < fall_.at - 1e-9 || time > fall_.at + fall_.duration) {
      return Error("ragdoll-time",
                   fmt::format("--push {}: its time is not within the fall", shown(push.joint)),
                   "the fall is from --at on, for --duration");
    }
    fall_.pushes.push_back({std::max(0, carrier[at(joint)]), push.impulse, time});
  }
  return {};
}

Status Run::read_ground() {
  const int frame = static_cast<int>(std::min(fall_.at * clip_.rate, clip_.frame_count() - 1.0));
  const Vec3 centre = clip_.frame_positions(frame)[at(bodies_.front().joint)].cast<double>();
  auto surroundings = open_surroundings(given().ground, centre, context_);
  if (!surroundings) return surroundings.error();
  fall_.surroundings = std::move(*surroundings);
  fall_.world.friction = given().friction;
  fall_.world.restitution = given().restitution;
  return {};
}

Json Run::report(const krok::ragdoll::Fall& fall) const {
  Xxh3Stream hash;
  hash.update(std::as_bytes(std::span(fall.clip.positions)));
  hash.update(std::as_bytes(std::span(fall.clip.orientations)));
  Json json;
  json["frames"] = fall.clip.frame_count();
  json["first_simulated_frame"] = fall.first_frame;
  json["bodies"] = bodies_.size();
  json["hash"] = hex(hash.digest());
  json["rest"] = fall.rest < 0 ? Json() : Json(fall.rest);
  const auto measures = [](const krok::ragdoll::WorldMeasures& of) {
    return Json{{"joint_gap", of.joint_gap},
                {"limit_excess", of.limit_excess},
                {"penetration", of.penetration}};
  };
  json["largest"] = measures(fall.largest);
  json["settling"] = measures(fall.settling);
  return json;
}

Status Run::write(const Clip& fall) const {
  OutputSet outputs(context_);
  anim::WriteOptions writing;
  writing.orientation = given().orientation;
  writing.jobs = context_.jobs;
  Status status = outputs.add(
      context_.output, [&](OutputFile& file) { return anim::write(fall, writing, file); });
  if (!status) return status;
  status = outputs.add(given().save_bodies, [&](OutputFile& file) {
    return file.write(ragdoll_file::write({bodies_, fall_.rules}, clip_.skeleton));
  });
  if (!status) return status;
  return outputs.finish();
}

Result<int> Run::run() {
  if (Status status = check_output_kind(context_.output, "-o", registry::Kind::anim); !status) {
    return status.error();
  }
  for (const auto step : {&Run::read_motion, &Run::read_limits, &Run::read_bodies, &Run::add_pushes,
                          &Run::read_ground}) {
    if (Status status = (this->*step)(); !status) return status.error();
  }
  auto fall = krok::ragdoll::simulate_fall(clip_, roles_, bodies_, limits_, fall_);
  if (!fall) return std::move(fall).error().in_file(given().input);
  if (fall->rest < 0) {
    context_.warn("ragdoll-moving", "the body still moves where the motion ends",
                  "a longer --duration lets it come to rest");
  }
  const std::string summary = fmt::format(
      "a fall from {:.2f} s, {}", fall_.at,
      fall->rest < 0 ? "not at rest" : fmt::format("at rest after {:.2f} s", fall->rest));
  fall->clip.provenance = context_.provenance();
  fall->clip.provenance.conversions = clip_.provenance.conversions;
  fall->clip.provenance.conversions.push_back("ragdoll: " + summary);
  if (Status status = write(fall->clip); !status) return status.error();
  context_.report.result = report(*fall);
  context_.log(fmt::format("{}: {}", context_.output, summary));
  return kExitDone;
}

}  // namespace

Result<int> run(const Options& options, ToolContext& context) {
  return Run(options, context).run();
}

}  // namespace krok::cli::ragdoll
