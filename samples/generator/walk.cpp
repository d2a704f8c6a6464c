#include "samples/generator/walk.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "samples/generator/body_motion.h"
#include "samples/generator/noise.h"

namespace krok::samples {

namespace {

void add_contact(std::vector<Contact>& contacts, Contact contact, double last) {
  contact.open_start = contact.open_start || contact.from < 0;
  contact.open_end = contact.open_end || contact.to > last;
  if (contact.open_start) contact.from = 0;
  if (contact.open_end) contact.to = last;
  if (contact.to > contact.from) contacts.push_back(contact);
}

// Records the contacts and footprints within the clip, in clip time.
void record_contacts(const FootPlan& plan, const Actor& actor, Walk& walk) {
  const double last = plan.last_time - plan.first_time;
  for (Footprint print : plan.prints) {
    for (double* time :
         {&print.strike, &print.flat, &print.heel_rise, &print.ball_rise, &print.off}) {
      *time -= plan.first_time;
    }
    const bool starts_before = print.first_of_foot || print.strike < 0;
    const bool lasts_beyond = print.last_of_foot || print.off > last;
    if ((!print.first_of_foot && print.strike > last) || (!print.last_of_foot && print.off < 0)) {
      continue;
    }
    const int index = static_cast<int>(walk.prints.size());
    walk.prints.push_back(print);
    FootContacts& foot = walk.feet[static_cast<std::size_t>(print.side)];
    const bool ball_first = print.strike_pitch < 0;
    const Quat ground(Eigen::AngleAxisd(print.heading, Vec3::UnitY()) *
                      Eigen::AngleAxisd(-print.slope, Vec3::UnitX()));
    Contact heel{index,
                 ball_first ? print.flat : print.strike,
                 print.heel_rise,
                 print.first_of_foot,
                 print.last_of_foot,
                 print.heel};
    Contact toe{index,
                ball_first ? print.strike : print.flat,
                print.off,
                print.first_of_foot,
                print.last_of_foot,
                print.heel + ground * Vec3(actor.toe_tip - actor.heel)};
    add_contact(foot.heel, heel, last);
    add_contact(foot.toe, toe, last);
    if (!starts_before) foot.strikes.push_back(print.strike);
    if (!lasts_beyond) foot.offs.push_back(print.off);
  }
}

void reverse(std::vector<Contact>& contacts, double last, int prints) {
  for (Contact& contact : contacts) {
    contact.from = std::exchange(contact.to, last - contact.from);
    contact.from = std::max(0.0, last - contact.from);
    std::swap(contact.open_start, contact.open_end);
    contact.print = prints - 1 - contact.print;
  }
  std::ranges::reverse(contacts);
}

void reverse(Footprint& print, double last) {
  const Footprint before = print;
  print.strike = last - before.off;
  print.flat = last - before.heel_rise;
  print.ball_rise = last - before.flat;
  print.heel_rise = print.off = last - before.strike;
  print.strike_pitch = before.off_pitch;
  print.off_pitch = before.strike_pitch;
  std::swap(print.first_of_foot, print.last_of_foot);
}

void reverse(Walk& walk) {
  const double last = walk.clip.duration();
  const Clip forward = walk.clip;
  std::vector<Transform> pose(forward.skeleton.names.size());
  for (int frame = 0; frame < forward.frame_count(); ++frame) {
    forward.get_pose(forward.frame_count() - 1 - frame, pose);
    walk.clip.set_pose(frame, pose);
  }
  for (FootContacts& foot : walk.feet) {
    reverse(foot.heel, last, static_cast<int>(walk.prints.size()));
    reverse(foot.toe, last, static_cast<int>(walk.prints.size()));
    std::swap(foot.strikes, foot.offs);
    for (auto* times : {&foot.strikes, &foot.offs}) {
      std::ranges::reverse(*times);
      for (double& time : *times) time = last - time;
    }
  }
  std::ranges::reverse(walk.prints);
  // A step leads to a print from the one that it led to.
  double step = 0;
  for (Footprint& print : walk.prints) {
    reverse(print, last);
    step = -std::exchange(print.step_length, step);
  }
}

}  // namespace

Result<Walk> make_walk(const WalkOptions& options) {
  if (Status status = check(options); !status) return std::move(status).error();
  Walk walk;
  walk.options = options;
  walk.actor = make_actor(options.stature);
  const FootPlan plan = plan_feet(options, walk.actor);
  walk.step_time = plan.step_time;

  const double frames = std::floor((plan.last_time - plan.first_time) * options.rate + 1e-6) + 1;
  if (frames > 1e6) {
    return Error("walk-too-long", "the walk would have more than a million frames",
                 "use fewer steps or a lower frame rate");
  }
  const BodyMotion body(options, walk.actor, plan);
  walk.clip.skeleton = walk.actor.skeleton;
  walk.clip.rate = options.rate;
  walk.clip.resize(static_cast<int>(frames));
  std::vector<Transform> world(walk.actor.skeleton.names.size());
  NoiseSource noise(options.seed);
  for (int frame = 0; frame < walk.clip.frame_count(); ++frame) {
    body.pose(plan.first_time + frame / options.rate, world);
    add_noise(options, walk.actor.skeleton, noise, world);
    walk.clip.set_pose(frame, world);
  }
  record_contacts(plan, walk.actor, walk);
  if (options.backward) reverse(walk);
  return walk;
}

Result<StandingActor> make_standing_actor(double stature) {
  WalkOptions options;
  options.stature = stature;
  options.steps = 1;
  options.from_standing = true;
  auto walk = make_walk(options);
  if (!walk) return walk.error();
  std::vector<Transform> pose(walk->actor.skeleton.names.size());
  walk->clip.get_pose(0, pose);
  return StandingActor{std::move(walk->actor), std::move(pose)};
}

}  // namespace krok::samples
