#include "tools/krok-ragdoll/fall.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <span>

#include "core/hash.h"
#include "core/index.h"
#include "core/numbers.h"
#include "ragdoll/toes.h"
#include "tools/cli/report.h"

namespace krok::cli::ragdoll {

namespace {

constexpr double kLying = 0.5;  // seconds from rest to where all is still

// Tolerances: radians, metres, and a share of the motion's acceleration.
constexpr double kMaxExcess = 1 * kRadiansPerDegree, kMaxPenetration = 0.005;
constexpr double kMaxDepthAtStart = 0.05;  // soles and thick bodies come out of it by themselves
constexpr double kMaxAcceleration = 1.5, kMaxDepth = 0.01;
constexpr double kMaxOff = 5 * kRadiansPerDegree;

Json json_of(const krok::ragdoll::WorldMeasures& of) {
  return Json{{"joint_gap", of.joint_gap},
              {"limit_excess", to_degrees(of.limit_excess)},
              {"penetration", of.penetration}};
}

krok::ragdoll::GroundHeight heights_of(const Terrain& terrain, double below = HUGE_VAL) {
  return [&terrain, below](double x, double z) {
    const auto point = terrain.at(x, z, below);
    return point ? std::optional<double>(point->height) : std::nullopt;
  };
}

// What is more than the body's height above its head is a roof.
double depth_at(double time, const Subject& subject) {
  const auto pose = krok::ragdoll::pose_at(subject.clip, time);
  double top = -HUGE_VAL;
  for (const Transform& joint : pose) top = std::max(top, joint.position.y());
  const double below = top + krok::ragdoll::extent(subject.clip.skeleton);
  return krok::ragdoll::depth_in_ground(subject.bodies, pose, heights_of(*subject.terrain, below));
}

// Bodies that begin in the ground, or leave what is simulated of it, may fall through it.
Status check_above_ground(const Subject& subject, const Clip& fallen) {
  const int last = fallen.frame_count() - 1;
  const Vec3 root = fallen.frame_positions(last)[at(subject.bodies.front().joint)].cast<double>();
  const Terrain& ground = *subject.terrain;
  const auto above = ground.at(root.x(), root.z());
  const double reach = krok::ragdoll::extent(subject.clip.skeleton);
  if (!above || ground.at(root.x(), root.z(), root.y() + reach)) return {};
  return Error("ragdoll-through",
               fmt::format("the body fell through the ground: its root is {} m below it in the end",
                           readable(above->height - root.y(), 3)),
               "begin above the ground (krok-edit --on-ground, --settle, --move) and within 10 m "
               "of where the fall ends");
}

}  // namespace

Result<Fallen> make_fall(const Subject& subject, const krok::ragdoll::FallOptions& options) {
  auto fall = krok::ragdoll::simulate_fall(subject.clip, subject.roles, subject.bodies,
                                           subject.limits, options);
  if (!fall) return fall.error();
  Fallen fallen;
  fallen.clip = std::move(fall->clip);
  fallen.fall = std::move(*fall);
  fallen.depth_at_start = depth_at(options.at, subject);
  if (Status status = check_above_ground(subject, fallen.clip); !status) return status.error();
  const auto is_full = [](const krok::ragdoll::Body& body) {
    return body.parent < 0 || body.strength >= 1 || body.mode == krok::ragdoll::BodyMode::animated;
  };
  fallen.undisturbed =
      fallen.fall.follows && options.pushes.empty() && std::ranges::all_of(subject.bodies, is_full);
  const auto bend_toes = [&] {
    krok::ragdoll::bend_toes(fallen.fall.first_frame, subject.roles, subject.bodies,
                             heights_of(*subject.terrain), fallen.clip);
  };
  if (subject.rises.empty()) {
    bend_toes();
    return fallen;
  }
  if (fallen.fall.rest < 0) {
    return Error("ragdoll-moving", "the body does not come to rest, so that it cannot get up",
                 "give a longer --duration");
  }
  const double still = (options.at + fallen.fall.rest + kLying) * fallen.clip.rate;
  const int frame = std::min(fallen.clip.frame_count() - 1, static_cast<int>(std::ceil(still)) + 1);
  krok::ragdoll::GetUpOptions how;
  how.ground = heights_of(*subject.terrain);
  auto risen =
      krok::ragdoll::get_up(fallen.clip, frame, subject.rises, subject.roles, subject.bodies, how);
  if (!risen) return risen.error();
  fallen.clip = std::move(risen->clip);
  bend_toes();
  fallen.risen = std::move(*risen);
  return fallen;
}

std::vector<Error> faults_of(const Fallen& fallen) {
  std::vector<Error> faults;
  const krok::ragdoll::Fall& fall = fallen.fall;
  if (fall.jumps) {
    faults.emplace_back("ragdoll-jump",
                        "the motion jumps where the fall begins, so that it began without speed",
                        "another --at, or krok-import --skip-rest-frame auto if a T-pose is before "
                        "the motion");
  }
  if (fall.rest < 0 && !fall.follows) {
    faults.emplace_back("ragdoll-moving", "the body still moves where the motion ends",
                        "a longer --duration lets it come to rest");
  }
  if (fall.largest.limit_excess > kMaxExcess) {
    faults.emplace_back("ragdoll-limit",
                        fmt::format("a joint is {:.1f} degrees beyond its range (1 is tolerated)",
                                    fall.largest.limit_excess / kRadiansPerDegree),
                        "a weaker push");
  }
  if (fallen.depth_at_start > kMaxDepthAtStart) {
    faults.emplace_back("ragdoll-penetration",
                        fmt::format("a body is {:.1f} mm in the ground when the body takes over "
                                    "(50 are tolerated)",
                                    fallen.depth_at_start * 1e3),
                        "another --at, or a motion made for this ground");
  } else if (fall.largest.penetration > kMaxPenetration) {
    faults.emplace_back("ragdoll-penetration",
                        fmt::format("a body is {:.1f} mm in the ground (5 are tolerated)",
                                    fall.largest.penetration * 1e3),
                        fall.settling.penetration > kMaxPenetration
                            ? "it is there when the body takes over: another --at, or a motion "
                              "made for this ground"
                            : "a weaker push, or ground without edges that are sharp or thin");
  }
  if (fallen.undisturbed && fall.mean_off > kMaxOff) {
    faults.emplace_back(
        "ragdoll-off-motion",
        fmt::format("the motion is followed {:.1f} degrees off (RMS; 5 are "
                    "tolerated), {:.0f} at most",
                    fall.mean_off / kRadiansPerDegree, fall.largest_off / kRadiansPerDegree),
        "feet in the ground hold legs back: --hold 0.5 gives way, krok-edit "
        "--settle lifts them; --at after a rest frame");
  }
  if (!fallen.risen) return faults;
  const krok::ragdoll::RisenClip& risen = *fallen.risen;
  if (risen.acceleration > kMaxAcceleration * risen.motion_acceleration) {
    faults.emplace_back(
        "ragdoll-rise-acceleration",
        fmt::format("getting up turns a joint at {:.1f} x the motion's acceleration (1.5 is "
                    "tolerated)",
                    risen.acceleration / risen.motion_acceleration),
        "another --get-up, which begins more as the body lies");
  }
  if (risen.crouches) {
    faults.emplace_back("ragdoll-rise-standing",
                        "the motion to get up with begins standing: a crouch with the hands on the "
                        "ground was put before it",
                        "a --get-up that begins lying, which gets up as people do");
  }
  if (risen.depth > kMaxDepth) {
    faults.emplace_back("ragdoll-rise-penetration",
                        fmt::format("getting up takes a body {:.1f} cm into the ground (1 is "
                                    "tolerated)",
                                    risen.depth * 1e2),
                        "another --get-up, or one made for this ground");
  }
  return faults;
}

Json report_of(const Subject& subject, const Fallen& fallen) {
  Xxh3Stream hash;
  hash.update(std::as_bytes(std::span(fallen.clip.positions)));
  hash.update(std::as_bytes(std::span(fallen.clip.orientations)));
  Json json;
  json["frames"] = fallen.clip.frame_count();
  json["first_simulated_frame"] = fallen.fall.first_frame;
  json["bodies"] = subject.bodies.size();
  if (subject.covered) json["mesh_within_3cm"] = *subject.covered;
  json["hash"] = hex(hash.digest());
  json["rest_time"] = fallen.fall.rest < 0 ? Json() : Json(fallen.fall.rest);
  json["largest"] = json_of(fallen.fall.largest);
  json["settling"] = json_of(fallen.fall.settling);
  if (fallen.fall.follows) {
    json["off_motion"] = {{"mean_angle", to_degrees(fallen.fall.mean_off)},
                          {"largest_angle", to_degrees(fallen.fall.largest_off)}};
  }
  if (!fallen.risen) return json;
  const krok::ragdoll::RisenClip& risen = *fallen.risen;
  Json tried = Json::array();
  for (const krok::ragdoll::RiseChoice& choice : risen.tried) {
    tried.push_back({{"motion", subject.rise_names[at(choice.motion)]},
                     {"mirrored", choice.mirrored},
                     {"distance", choice.distance}});
  }
  json["get_up"] = {{"motion", subject.rise_names[at(risen.choice.motion)]},
                    {"mirrored", risen.choice.mirrored},
                    {"crouches", risen.crouches},
                    {"distance", risen.choice.distance},
                    {"first_frame", risen.first_frame},
                    {"handover_frame", risen.handover},
                    {"acceleration", risen.acceleration},
                    {"motion_acceleration", risen.motion_acceleration},
                    {"penetration", std::max(0.0, risen.depth)},
                    {"tried", std::move(tried)}};
  return json;
}

std::string summary_of(const Subject& subject, const krok::ragdoll::FallOptions& options,
                       const Fallen& fallen) {
  if (fallen.fall.follows) {
    return fmt::format("simulated from {:.2f} s to {:.2f} s, {:.1f} degrees off the motion",
                       options.at, options.at + fallen.fall.simulated,
                       fallen.fall.mean_off / kRadiansPerDegree);
  }
  std::string text = fmt::format("a fall from {:.2f} s, ", options.at);
  if (fallen.fall.rest < 0) return text + "not at rest";
  text += fmt::format("at rest after {:.2f} s", fallen.fall.rest);
  if (!fallen.risen) return text;
  return text + fmt::format(", gets up with {}{} until {:.2f} s",
                            subject.rise_names[at(fallen.risen->choice.motion)],
                            fallen.risen->choice.mirrored ? ", mirrored," : "",
                            fallen.clip.duration());
}

}  // namespace krok::cli::ragdoll
