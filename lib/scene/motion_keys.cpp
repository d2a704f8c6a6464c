#include "scene/motion_keys.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace krok {
namespace {

constexpr double kBeyond = 1e-3;  // seconds; times are rounded when written
constexpr double kApart = 1e-6;   // seconds

bool within(double time, double duration) {
  return std::isfinite(time) && time >= -kBeyond && time <= duration + kBeyond;
}

}  // namespace

MotionKeys part_of(const MotionKeys& keys, double from, double to) {
  MotionKeys part;
  for (Contact contact : keys.contacts) {
    if (contact.end < from || contact.start > to) continue;
    contact.start = std::max(contact.start, from) - from;
    contact.end = std::min(contact.end, to) - from;
    part.contacts.push_back(contact);
  }
  for (Keytime key : keys.keytimes) {
    if (key.time < from || key.time > to) continue;
    key.time -= from;
    part.keytimes.push_back(std::move(key));
  }
  return part;
}

Status check(const MotionKeys& keys, const Skeleton& skeleton, double duration) {
  for (std::size_t i = 0; i < keys.contacts.size(); ++i) {
    const Contact& contact = keys.contacts[i];
    if (contact.joint < 0 || contact.joint >= skeleton.joint_count()) {
      return Error("keys-joint", fmt::format("contact {} refers to joint {} of {}", i,
                                             contact.joint, skeleton.joint_count()));
    }
    if (!within(contact.start, duration) || !within(contact.end, duration) ||
        contact.end < contact.start) {
      return Error("keys-time", fmt::format("contact {}: {} s to {} s in a motion of {} s", i,
                                            contact.start, contact.end, duration));
    }
    if (!is_near(contact.place)) {
      return Error("keys-place",
                   fmt::format("the position of contact {} is not finite or over 1e9 m away", i));
    }
  }
  for (std::size_t i = 0; i < keys.keytimes.size(); ++i) {
    const Keytime& key = keys.keytimes[i];
    if (key.name.empty()) return Error("keys-name", fmt::format("keytime {} has no name", i));
    const bool rises = i == 0 || key.time >= keys.keytimes[i - 1].time + kApart;
    if (!within(key.time, duration) || !rises) {
      return Error("keys-time",
                   fmt::format("keytime {} ({}): {} s in a motion of {} s{}", i, key.name, key.time,
                               duration, rises ? "" : ", not after the one before it"));
    }
  }
  return {};
}

}  // namespace krok
