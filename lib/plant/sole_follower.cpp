#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "math/hermite.h"
#include "math/quaternion.h"
#include "plant/sole_follower_internal.h"

namespace krok::plant {

namespace {

constexpr double kSoon = 0.05;  // seconds: stands apart by less are one
constexpr double kMaxSettled =
    0.05;                          // metres by which a sole is set higher or lower on uneven ground
constexpr double kUsualTip = 1.4;  // of the sole from heel to ball: where its tip is
constexpr double kInTheWay = 0.02;   // metres: what is so much higher than a sole is in its way
constexpr double kOverEdge = 0.03;   // metres: what is so much lower does not carry it
constexpr int kTries = 10;           // places before and behind the middle
constexpr double kShortSole = 0.02;  // metres: shorter soles have no direction

// The mean over `frames` of a point of the sole in the frame of the foot.
Vec3 in_foot(const Clip& clip, const std::vector<int>& frames, int foot, const SolePoint& point) {
  if (point.joint == foot) return point.offset;
  Vec3 sum = Vec3::Zero();
  for (const int f : frames) {
    sum += joint_at(clip, f, foot).inverse() * (joint_at(clip, f, point.joint) * point.offset);
  }
  return sum / static_cast<double>(frames.size());
}

bool holds(const std::array<int, 2>& time, int frame) {
  return frame >= time[0] && frame <= time[1];
}

}  // namespace

Quat SoleShape::axes() const {
  Mat3 columns;
  columns << up.cross(forward), up, forward;
  return Quat(columns).normalized();
}

void SoleFollower::find_standings(std::span<const Contact> contacts, const SolePoint& heel,
                                  const SolePoint* ball) {
  const double rate = source_->rate;
  const int end = source_->frame_count() - 1;
  for (const Contact& contact : contacts) {
    const bool of_heel = contact.joint == heel.joint;
    const bool of_ball = ball != nullptr && contact.joint == ball->joint;
    if (!of_heel && !of_ball) continue;
    const int first = std::max(0, static_cast<int>(std::ceil(contact.start * rate - 1e-3)));
    const int last = std::min(end, static_cast<int>(std::floor(contact.end * rate + 1e-3)));
    if (last < first) continue;
    Standing standing;
    standing.first = first;
    standing.last = last;
    // Without a joint at the ball, heel and ball stand as long as the foot does.
    if (of_heel) standing.heel = {first, last};
    if (of_ball) standing.ball = {first, last};
    standings_.push_back(standing);
  }
  std::ranges::stable_sort(standings_, {}, &Standing::first);
  std::vector<Standing> joined;
  const auto unite = [](std::array<int, 2>& into, const std::array<int, 2>& more) {
    if (more[1] < more[0]) return;
    into = into[1] < into[0] ? more
                             : std::array{std::min(into[0], more[0]), std::max(into[1], more[1])};
  };
  for (const Standing& standing : standings_) {
    if (!joined.empty() && standing.first <= joined.back().last + kSoon * rate) {
      joined.back().last = std::max(joined.back().last, standing.last);
      unite(joined.back().heel, standing.heel);
      unite(joined.back().ball, standing.ball);
      continue;
    }
    joined.push_back(standing);
  }
  standings_ = std::move(joined);
}

namespace {

// The frames in which a foot is flat: heel and ball both stand.
std::vector<int> flat_frames(const std::vector<Standing>& standings) {
  std::vector<int> flat;
  for (const Standing& standing : standings) {
    const int first = std::max(standing.heel[0], standing.ball[0]);
    const int last = std::min(standing.heel[1], standing.ball[1]);
    for (int f = first; f <= last; ++f) flat.push_back(f);
  }
  if (!flat.empty()) return flat;
  for (const Standing& standing : standings) flat.push_back((standing.first + standing.last) / 2);
  return flat;
}

SoleShape shape_of(const Clip& clip, const std::vector<SolePoint>& points, const Clip& source,
                   int source_foot, const std::vector<int>& flat, const GroundBelow& ground) {
  const SolePoint& heel = *point_of(points, FootPart::heel);
  const SolePoint& ball = *point_of(points, FootPart::ball);
  SoleShape shape;
  const int foot = shape.foot = heel.joint;
  shape.heel = heel.offset;
  shape.ball = in_foot(clip, flat, foot, ball);
  Vec3 up = Vec3::Zero();
  for (const int f : flat) {
    const Vec3 there = ground.up(joint_at(source, f, source_foot).position);
    up += joint_at(clip, f, foot).orientation.conjugate() * there;
  }
  shape.up = up.normalized();
  const Vec3 ahead = shape.ball - shape.heel;
  shape.forward = (ahead - shape.up * shape.up.dot(ahead)).normalized();
  const SolePoint* tip = point_of(points, FootPart::tip);
  shape.tip = tip == nullptr ? kUsualTip * shape.length()
                             : (in_foot(clip, flat, foot, *tip) - shape.heel).dot(shape.forward);
  return shape;
}

Error no_sole(const char* whose, FootSide side) {
  return {"contacts-feet",
          fmt::format("the sole of {}'s {} foot is not known", whose, name_of(side)),
          "a role map tells which joints are feet and toes"};
}

// A frame in which the foot is flat, if there is one.
int middle_of(const Standing& standing) {
  const int first = std::max(standing.heel[0], standing.ball[0]);
  const int last = std::min(standing.heel[1], standing.ball[1]);
  return first <= last ? (first + last) / 2 : (standing.first + standing.last) / 2;
}

}  // namespace

Result<SoleFollower> SoleFollower::create(const Clip& source, const RoleMap& source_roles,
                                          FootSide side, const GroundBelow& ground,
                                          std::span<const Contact> contacts) {
  SoleFollower follower;
  follower.source_ = &source;
  follower.hip_ = leg_joints(source_roles, side).upper;
  follower.other_hip_ =
      leg_joints(source_roles, side == FootSide::left ? FootSide::right : FootSide::left).upper;
  const Feet feet = find_feet(source, source_roles, ground.up);
  const auto& points = feet.points[static_cast<std::size_t>(side)];
  const SolePoint* heel = point_of(points, FootPart::heel);
  const SolePoint* ball = point_of(points, FootPart::ball);
  if (heel == nullptr || ball == nullptr) return no_sole("the motion", side);
  follower.find_standings(contacts, *heel, ball);
  if (follower.standings_.empty()) {
    return Error("plant-contacts", std::string("the ") + name_of(side) + " foot never stands",
                 "krok-keys finds and edits contacts");
  }
  follower.flat_ = flat_frames(follower.standings_);
  follower.theirs_ = shape_of(source, points, source, heel->joint, follower.flat_, ground);
  if (follower.theirs_.length() < kShortSole) return no_sole("the motion", side);
  for (Standing& standing : follower.standings_) {
    const Transform foot = joint_at(source, middle_of(standing), follower.theirs_.foot);
    standing.height = 0.5 * ((foot * follower.theirs_.heel).y() +
                             (foot * follower.theirs_.ball).y() - follower.theirs_.ball_height());
  }
  return follower;
}

Status SoleFollower::lead_foot(const Clip& clip, const Leg& leg, double beside,
                               const GroundBelow& ground) {
  leg_ = leg;
  const SolePoint* heel = leg.point(FootPart::heel);
  const SolePoint* ball = leg.point(FootPart::ball);
  if (heel == nullptr || ball == nullptr) return no_sole("the target", leg.side);
  own_ = shape_of(clip, leg.points, *source_, theirs_.foot, flat_, ground);
  if (own_.length() < kShortSole) return no_sole("the target", leg.side);
  for (Standing& standing : standings_) place(standing, beside, ground);
  return {};
}

Vec3 SoleFollower::across_hips(const Standing& standing) const {
  Vec3 sum = Vec3::Zero();
  for (int f = standing.first; f <= standing.last; ++f) {
    sum += (joint_at(*source_, f, hip_).position - joint_at(*source_, f, other_hip_).position)
               .stableNormalized();
  }
  sum.y() = 0;
  return sum / (1 + standing.last - standing.first);
}

// Places the sole for a stance of the source: middles together, heel and ball on the ground.
void SoleFollower::place(Standing& standing, double beside, const GroundBelow& ground) const {
  const Transform foot = joint_at(*source_, middle_of(standing), theirs_.foot);
  const Vec3 forward = foot.orientation * theirs_.forward;
  const Vec3 heel = foot * theirs_.heel, ball = foot * theirs_.ball;
  standing.up = foot.orientation * theirs_.up;
  const double longer = own_.length() - theirs_.length();
  const Vec3 aside = beside == 0 ? Vec3(Vec3::Zero()) : Vec3(beside * across_hips(standing));
  const Vec3 led = heel + aside, sole_at_ball = ball + aside - theirs_.ball_height() * standing.up;
  // Moved back or ahead where a longer foot would stand against a step or over an edge.
  double best = 0, least = std::numeric_limits<double>::infinity();
  for (int k = 0; k <= 2 * kTries; ++k) {
    const int tried = (k + 1) / 2;
    const double ahead = std::abs(longer) * (k % 2 == 0 ? tried : -tried) / kTries;
    const Vec3 own_heel = led + (ahead - 0.5 * longer) * forward;
    const double trouble = trouble_at(own_heel, forward, ground) + 0.01 * std::abs(ahead);
    if (trouble >= least) continue;
    least = trouble;
    best = ahead;
  }
  Vec3 own_heel = led + (best - 0.5 * longer) * forward;
  Vec3 own_tread = sole_at_ball + (best + 0.5 * longer) * forward;  // below the ball
  // Both ends come down to the ground, which need not be even; what is over an edge stays.
  const auto settled = [&](const Vec3& point) -> std::optional<double> {
    const auto height = ground.height(point);
    if (!height || std::abs(*height - point.y()) > kMaxSettled) return {};
    return *height - point.y();
  };
  const auto at_heel = settled(own_heel), at_ball = settled(own_tread);
  const Vec3 flat = own_tread - own_heel;
  own_heel.y() += at_heel.value_or(at_ball.value_or(0));
  own_tread.y() += at_ball.value_or(at_heel.value_or(0));
  standing.tilt = rotation_vector(shortest_arc(flat, own_tread - own_heel));
  const Quat turn = from_rotation_vector(standing.tilt);
  standing.of_heel = own_heel - heel;
  standing.of_ball = own_heel + turn * Vec3(flat + own_.ball_height() * standing.up) - ball;
}

double SoleFollower::trouble_at(const Vec3& heel, const Vec3& forward,
                                const GroundBelow& ground) const {
  double trouble = 0;
  for (const double along : {0.0, own_.length(), own_.tip}) {
    const Vec3 point = heel + along * forward;
    const auto height = ground.height(point);
    if (height && *height > point.y() + kInTheWay) trouble += 4;
    if (along < own_.tip && (!height || *height < point.y() - kOverEdge)) trouble += 1;
  }
  return trouble;
}

SoleFollower::Lead SoleFollower::lead_at(const Standing& standing, double along) {
  return {along, (1 - along) * standing.of_heel + along * standing.of_ball, standing.tilt};
}

SoleFollower::Lead SoleFollower::lead_in(const Standing& standing, int frame) {
  const bool heel = holds(standing.heel, frame), ball = holds(standing.ball, frame);
  return lead_at(standing, heel == ball ? 0.5 : heel ? 0 : 1);
}

// A foot comes down with its heel and leaves with its ball, unless it does not stand on them then.
SoleFollower::Lead SoleFollower::lead(int frame) const {
  const auto after = std::ranges::find_if(
      standings_, [&](const Standing& standing) { return standing.last >= frame; });
  if (after == standings_.end()) return lead_in(standings_.back(), standings_.back().last);
  if (frame >= after->first) return lead_in(*after, frame);
  const Lead to = lead_at(*after, holds(after->heel, after->first) ? 0 : 1);
  if (after == standings_.begin()) return to;
  const Standing& before = *std::prev(after);
  const Lead from = lead_at(before, holds(before.ball, before.last) ? 1 : 0);
  const double share =
      smoother_step(static_cast<double>(frame - before.last) / (after->first - before.last));
  return {from.along + share * (to.along - from.along), from.off + share * (to.off - from.off),
          from.tilt + share * (to.tilt - from.tilt)};
}

double SoleFollower::standing_height(int frame) const {
  const auto after = std::ranges::find_if(
      standings_, [&](const Standing& standing) { return standing.last >= frame; });
  if (after == standings_.end()) return standings_.back().height;
  if (frame >= after->first || after == standings_.begin()) return after->height;
  const Standing& before = *std::prev(after);
  const double share =
      smoother_step(static_cast<double>(frame - before.last) / (after->first - before.last));
  return before.height + share * (after->height - before.height);
}

FootPath SoleFollower::path(const Clip& clip) const {
  FootPath path;
  path.extends_softly = true;
  const Quat theirs = theirs_.axes(), own = own_.axes().conjugate();
  for (int f = 0; f < clip.frame_count(); ++f) {
    const Transform source = joint_at(*source_, f, theirs_.foot);
    const Transform foot = joint_at(clip, f, own_.foot);
    const Lead now = lead(f);
    const Quat turned =
        (from_rotation_vector(now.tilt) * source.orientation * theirs * own).normalized();
    const Vec3 led = source * Vec3(theirs_.heel + now.along * (theirs_.ball - theirs_.heel));
    const Vec3 ankle =
        led + now.off - turned * Vec3(own_.heel + now.along * (own_.ball - own_.heel));
    path.turn.push_back(rotation_vector(turned * foot.orientation.conjugate()));
    path.shift.push_back(ankle - foot.position);
  }
  return path;
}

void SoleFollower::add_contacts(const Clip& clip, std::vector<Contact>& contacts) const {
  const auto add = [&](int joint, const std::array<int, 2>& time) {
    if (time[1] < time[0]) return;
    Contact contact;
    contact.joint = joint;
    contact.start = time[0] / clip.rate;
    contact.end = time[1] / clip.rate;
    contact.place = joint_at(clip, (time[0] + time[1]) / 2, joint).position;
    contacts.push_back(contact);
  };
  for (const Standing& standing : standings_) {
    add(own_.foot, standing.heel);
    if (leg_.toes >= 0) add(leg_.toes, standing.ball);
  }
}

void SoleFollower::measure(const Clip& clip, const GroundBelow& ground, FollowedFeet& into) const {
  const Vec3 sole_at_ball = own_.ball - own_.ball_height() * own_.up;
  const auto check = [&](const std::array<int, 2>& time, const Vec3& moves, const Vec3& lies) {
    Eigen::AlignedBox3d box;
    for (int f = time[0]; f <= time[1]; ++f) {
      box.extend(joint_at(clip, f, own_.foot) * moves);
      const bool flat = std::ranges::any_of(standings_, [&](const Standing& standing) {
        return holds(standing.heel, f) && holds(standing.ball, f);
      });
      const Vec3 sole = joint_at(clip, f, own_.foot) * lies;
      const auto height = ground.height(sole);
      // An end over an edge or a hole is carried by the other.
      if (flat && height && *height > sole.y() - kOverEdge) {
        into.off_ground = std::max(into.off_ground, std::abs(sole.y() - *height));
      }
    }
    if (!box.isEmpty()) into.drift = std::max(into.drift, box.diagonal().norm());
  };
  for (const Standing& standing : standings_) {
    check(standing.heel, own_.heel, own_.heel);
    check(standing.ball, own_.ball, sole_at_ball);
  }
  const auto deepest = [&](const Clip& of, const SoleShape& shape, double& sunk) {
    for (int f = 0; f < of.frame_count(); ++f) {
      for (const Vec3& point : {shape.heel, shape.ball}) {
        const Vec3 at = joint_at(of, f, shape.foot) * point;
        const auto height = ground.height(at);
        if (height) sunk = std::max(sunk, *height - at.y());
      }
    }
  };
  deepest(clip, own_, into.sunk);
  deepest(*source_, theirs_, into.source_sunk);
}

}  // namespace krok::plant
