#include "samples/generator/ground_truth.h"

#include <cmath>

#include "core/json_internal.h"

namespace krok::samples {

namespace {

using Json = nlohmann::ordered_json;

// To a micrometre or microsecond, the precision of the BVH file.
double rounded(double value) {
  const double result = std::round(value * 1e6) * 1e-6;
  const double printed = std::round(result * 1e6) / 1e6;
  return printed == 0 ? 0 : printed;
}
double degrees(double angle) {
  return rounded(angle / kRadiansPerDegree);
}

Json vector(const Vec3& v) {
  return Json::array({rounded(v.x()), rounded(v.y()), rounded(v.z())});
}

const char* side_name(Side side) {
  return side == Side::left ? "left" : "right";
}

Json parameters(const Walk& walk) {
  const WalkOptions& options = walk.options;
  Json json;
  json["stature"] = rounded(options.stature);
  json["steps"] = options.steps;
  json["step_length"] = rounded(options.step_length);
  json["step_width"] = rounded(options.step_width);
  json["turn"] = degrees(options.turn);
  json["rise"] = rounded(options.rise);
  json["ground"] = options.ground == Ground::stairs ? "stairs" : "slope";
  json["cadence"] = rounded(60 / walk.step_time);
  json["from_standing"] = options.from_standing;
  json["first_side"] = side_name(options.first_side);
  json["noise_angle"] = degrees(options.noise_angle);
  json["noise_position"] = rounded(options.noise_position);
  json["seed"] = options.seed;
  return json;
}

Json contact_points(const Actor& actor) {
  Json json = Json::object();
  for (const Side side : {Side::left, Side::right}) {
    const LegJoints& leg = actor.legs[static_cast<std::size_t>(side)];
    const auto point = [&](int joint, const Vec3& offset) {
      Json entry;
      entry["joint"] = actor.skeleton.names[static_cast<std::size_t>(joint)];
      entry["offset"] = vector(offset);
      return entry;
    };
    json[side_name(side)]["heel"] = point(leg.foot, actor.heel);
    json[side_name(side)]["toe"] = point(leg.toes, actor.toe_tip - actor.toe_joint);
  }
  return json;
}

Json times(const std::vector<double>& values) {
  Json json = Json::array();
  for (double value : values) json.push_back(rounded(value));
  return json;
}

Json footprints(const Walk& walk) {
  const double last = walk.clip.duration();
  // Null for events outside the clip, which cannot be measured.
  const auto moment = [&](double time, bool never) {
    return never || time < 0 || time > last ? Json(nullptr) : Json(rounded(time));
  };
  Json json = Json::array();
  for (const Footprint& print : walk.prints) {
    Json entry;
    entry["side"] = side_name(print.side);
    entry["heel"] = vector(print.heel);
    entry["heading"] = degrees(print.heading);
    entry["slope"] = degrees(print.slope);
    entry["path_point"] = vector(print.path_point);
    entry["path_heading"] = degrees(print.path_heading);
    entry["step_length"] = rounded(print.step_length);
    entry["strike"] = moment(print.strike, print.first_of_foot);
    entry["flat"] = moment(print.flat, print.first_of_foot);
    entry["heel_rise"] = moment(print.heel_rise, print.last_of_foot);
    entry["ball_rise"] = moment(print.ball_rise, print.last_of_foot);
    entry["off"] = moment(print.off, print.last_of_foot);
    json.push_back(std::move(entry));
  }
  return json;
}

Json contacts(const std::vector<Contact>& list, const Clip& clip) {
  Json json = Json::array();
  for (const Contact& contact : list) {
    Json entry;
    entry["footprint"] = contact.print;
    entry["from"] = rounded(contact.from);
    entry["to"] = rounded(contact.to);
    // The first and the last frame within the contact.
    entry["from_frame"] = static_cast<int>(std::ceil(contact.from * clip.rate - 1e-6));
    entry["to_frame"] = static_cast<int>(std::floor(contact.to * clip.rate + 1e-6));
    entry["open_start"] = contact.open_start;
    entry["open_end"] = contact.open_end;
    entry["place"] = vector(contact.place);
    json.push_back(std::move(entry));
  }
  return json;
}

}  // namespace

std::string ground_truth_json(const Walk& walk, const std::string& capture_name) {
  Json json;
  json["schema"] = "krok.walk/1";
  json["capture"] = capture_name;
  json["units"] = "metres, seconds, degrees; +Y up, the walk starts along +Z";
  json["rate"] = walk.clip.rate;
  json["frames"] = walk.clip.frame_count();
  json["parameters"] = parameters(walk);
  json["contact_points"] = contact_points(walk.actor);
  for (const Side side : {Side::left, Side::right}) {
    const FootContacts& foot = walk.feet[static_cast<std::size_t>(side)];
    json["keytimes"][std::string(side_name(side)) + "_strike"] = times(foot.strikes);
    json["keytimes"][std::string(side_name(side)) + "_off"] = times(foot.offs);
  }
  json["footprints"] = footprints(walk);
  for (const Side side : {Side::left, Side::right}) {
    const FootContacts& foot = walk.feet[static_cast<std::size_t>(side)];
    json["contacts"][side_name(side)]["heel"] = contacts(foot.heel, walk.clip);
    json["contacts"][side_name(side)]["toe"] = contacts(foot.toe, walk.clip);
  }
  return json_text(json, 1) + "\n";
}

}  // namespace krok::samples
