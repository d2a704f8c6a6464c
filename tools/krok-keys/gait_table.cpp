#include "tools/krok-keys/gait_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <tuple>

#include "contacts/loop_steps.h"
#include "contacts/sole_points.h"
#include "core/numbers.h"
#include "core/text.h"
#include "formats/csv/csv_writer.h"
#include "formats/io/open_motion.h"
#include "motion/travel.h"
#include "tools/cli/option_kinds.h"
#include "tools/cli/output_set.h"
#include "tools/cli/paths.h"
#include "tools/shared/keys_sidecar.h"

namespace krok::cli::keys {

namespace {

constexpr const char* kHeader =
    "file,duration [s],cycles,steps,speed [m/s],cadence [1/min],stride_length [m],"
    "step_length_left [m],step_length_right [m],step_width [m],stance_left [%],stance_right [%],"
    "double_support [%],slide_speed [mm/s],gait\n";

// Empty for what no step shows.
std::string row_of(const std::string& name, double duration, const GaitFacts& facts) {
  const auto& [gait, steps, slide] = facts;
  const auto if_known = [](double value, double factor = 1) {
    return value > 0 ? std::optional(value * factor) : std::nullopt;
  };
  const bool steps_known = gait.stance[0] > 0 && gait.stance[1] > 0;
  std::string row = fmt::format("{},{},{},{}", csv::field(to_utf8(name)), readable(duration, 6),
                                gait.cycles, steps.steps);
  for (const std::optional<double>& value : std::array<std::optional<double>, 10>{
           steps.speed, if_known(gait.cadence), steps.stride_length, steps.step_length[0],
           steps.step_length[1], steps.step_width, if_known(gait.stance[0], 100),
           if_known(gait.stance[1], 100),
           steps_known ? std::optional(100 * gait.double_support) : std::nullopt,
           facts.is_run() ? std::nullopt : std::optional(1000 * slide)}) {
    row += value ? "," + readable(*value, 4) : ",";
  }
  return fmt::format("{},{}\n", row, steps_known ? facts.name() : "");
}

using Rows = Result<std::string>(const std::string& path, const io::FindRoles& find_roles,
                                 ToolContext& context);

Result<std::string> gait_row(const std::string& path, const io::FindRoles& find_roles,
                             ToolContext& context) {
  const auto clip = io::open_motion(path, context);
  if (!clip) return clip.error();
  const auto roles = find_roles(clip->skeleton);
  if (!roles) return roles.error();
  const auto keys =
      choose_keys(KeysChoice::automatic, path, name_of_input(path), *clip, find_roles, context);
  if (!keys) return keys.error();
  const MotionKeys none;
  const MotionKeys& found = *keys ? **keys : none;
  const GaitFacts facts = gait_facts(*clip, *roles, found.keytimes);
  if (facts.gait.cycles == 0 && !found.keytimes.empty()) {
    const bool no_step = facts.steps.steps == 0;
    context.diagnose_in(
        path, {make_warning("keys-no-cycle",
                            fmt::format("no foot makes a whole cycle, from strike to strike{}: "
                                        "{}cadence, stance and double support are blank",
                                        no_step ? ", and there are no three stances in turn" : "",
                                        no_step ? "speed, lengths, width, " : ""))});
  }
  context.diagnose_in(path, doubts_of_gait(*clip, *roles));
  return row_of(path, clip->duration(), facts);
}

Result<std::string> event_rows(const std::string& path, const io::FindRoles& find_roles,
                               ToolContext& context) {
  const auto clip = io::open_motion(path, context);
  if (!clip) return clip.error();
  const auto keys =
      choose_keys(KeysChoice::automatic, path, name_of_input(path), *clip, find_roles, context);
  if (!keys) return keys.error();
  std::string rows;
  if (!*keys) return rows;
  for (const Keytime& key : (*keys)->keytimes) {
    rows += fmt::format("{},{},{:.6f},{}\n", csv::field(to_utf8(path)), csv::field(key.name),
                        key.time, std::lround(key.time * clip->rate));
  }
  return rows;
}

// Motions that cannot be read are reported and left out.
Result<int> write_rows(const Options& options, const char* header, Rows* rows_of, const char* task,
                       const char* contents, const char* more, const std::string& output,
                       ToolContext& context) {
  const auto find_roles = io::open_role_map(options.map, context);
  if (!find_roles) return find_roles.error();
  std::string text = header;
  std::size_t motions = 0;
  context.progress->begin(task, options.inputs.size());
  for (const std::string& path : options.inputs) {
    const auto rows = [&] {
      const HiddenProgress hidden(context);
      return rows_of(path, *find_roles, context);
    }();
    if (rows) {
      text += *rows;
      ++motions;
    } else {
      Error error = rows.error();
      if (error.where.file.empty()) error.where.file = path;
      context.diagnose(error);
    }
    context.progress->advance(1);
  }
  context.progress->end();
  if (motions == 0) return Error("keys-table", "none of the motions can be read");
  const Status status = write_output(context, output, text);
  if (!status) return status.error();
  context.report.result["rows"] = std::ranges::count(text, '\n') - 1;
  context.log(fmt::format("{}: {} of {} of {}{}", output, contents, motions,
                          counted(std::ssize(options.inputs), "motion"), more));
  return motions == options.inputs.size() ? kExitDone : kExitPartly;
}

}  // namespace

GaitFacts gait_facts(const Clip& clip, const RoleMap& roles, const std::vector<Keytime>& keytimes) {
  const auto moving = travelling_on_feet(clip, roles);
  const double slide = slide_speed(moving ? *moving : clip, roles);
  const auto rounds = rounds_of(clip, roles);
  if (!rounds) {
    return {gait_metrics(keytimes), step_measures(moving ? *moving : clip, roles, keytimes), slide};
  }
  // Of a loop the steps of its circle, each counted once.
  const std::vector<Keytime> all = in_rounds(keytimes, *rounds);
  GaitFacts facts{gait_metrics(all), step_measures(rounds->clip, roles, all), slide};
  const auto strikes = std::ranges::count_if(all, [&](const Keytime& key) {
    return key.name.ends_with("_strike") && key.time * rounds->clip.rate < rounds->period;
  });
  facts.gait.cycles = std::min(facts.gait.cycles, static_cast<int>(strikes));
  facts.steps.steps = std::min(facts.steps.steps, static_cast<int>(strikes));
  return facts;
}

Diagnostics doubts_of_gait(const Clip& clip, const RoleMap& roles) {
  const int hips = roles.joint(Role::hips);
  std::vector<Jump> jumps = hips < 0 ? std::vector<Jump>() : jumps_of(clip, hips);
  // Out of a rest pose in the first frame, of which readers warn.
  std::erase_if(jumps, [](const Jump& jump) { return jump.frame == 1; });
  if (jumps.empty()) return {};
  const Jump& first = jumps.front();
  return {make_warning(
      "keys-jump",
      fmt::format(
          "the hips jump by {} m at {} s{}: no stride is measured across that, steps beside "
          "it may be wrong",
          readable(first.distance, 3), readable(first.frame / clip.rate, 3),
          jumps.size() > 1 ? fmt::format(", and {} more times", jumps.size() - 1) : ""),
      "cut the parts with krok-edit --from and --to")};
}

Result<int> write_gait_table(const Options& options, ToolContext& context) {
  return write_rows(options, kHeader, gait_row, "measuring gait", "gait", "", options.table,
                    context);
}

Result<int> write_event_table(const Options& options, ToolContext& context) {
  return write_rows(options, "file,event,time [s],frame\n", event_rows, "finding steps",
                    "strikes and toe-offs", "; --table OUT.csv has speed, cadence and steps",
                    context.output, context);
}

namespace {

struct MarkedKeytime {
  Keytime key;
  bool by_hand = false;
};
struct MarkedContact {
  Contact contact;
  bool by_hand = false;
};

bool marked(const std::vector<std::uint8_t>& marks, std::size_t i) {
  return i < marks.size() && marks[i] != 0;
}

std::vector<MarkedKeytime> keytimes_of(const krok::keys::Sidecar& sidecar) {
  std::vector<MarkedKeytime> list;
  for (std::size_t i = 0; i < sidecar.keys.keytimes.size(); ++i) {
    list.push_back({sidecar.keys.keytimes[i], marked(sidecar.keytimes_by_hand, i)});
  }
  return list;
}
std::vector<MarkedContact> contacts_of(const krok::keys::Sidecar& sidecar) {
  std::vector<MarkedContact> list;
  for (std::size_t i = 0; i < sidecar.keys.contacts.size(); ++i) {
    list.push_back({sidecar.keys.contacts[i], marked(sidecar.contacts_by_hand, i)});
  }
  return list;
}

void put(std::vector<MarkedKeytime> list, krok::keys::Sidecar& sidecar) {
  std::ranges::stable_sort(list, {}, [](const MarkedKeytime& k) { return k.key.time; });
  sidecar.keys.keytimes.clear();
  sidecar.keytimes_by_hand.clear();
  for (MarkedKeytime& entry : list) {
    sidecar.keys.keytimes.push_back(std::move(entry.key));
    sidecar.keytimes_by_hand.push_back(entry.by_hand ? 1 : 0);
  }
}
void put(std::vector<MarkedContact> list, krok::keys::Sidecar& sidecar) {
  std::ranges::stable_sort(list, {}, [](const MarkedContact& c) {
    return std::tuple(c.contact.start, c.contact.joint);
  });
  sidecar.keys.contacts.clear();
  sidecar.contacts_by_hand.clear();
  for (const MarkedContact& entry : list) {
    sidecar.keys.contacts.push_back(entry.contact);
    sidecar.contacts_by_hand.push_back(entry.by_hand ? 1 : 0);
  }
}

bool overlap(const Contact& a, const Contact& b) {
  return a.joint == b.joint && a.start <= b.end && b.start <= a.end;
}

// The keytime of that name nearest to `time`, within kSameKeytime.
std::vector<MarkedKeytime>::iterator nearest(std::vector<MarkedKeytime>& list,
                                             const std::string& name, double time) {
  auto best = list.end();
  for (auto it = list.begin(); it != list.end(); ++it) {
    const double apart = std::abs(it->key.time - time);
    if (it->key.name != name || apart > kSameKeytime) continue;
    if (best == list.end() || apart < std::abs(best->key.time - time)) best = it;
  }
  return best;
}

Result<double> seconds_of(const ClipTime& time, const Clip& clip) {
  const double seconds = time.seconds(clip.rate);
  if (seconds >= 0 && seconds <= clip.duration() + 1e-9) return std::min(seconds, clip.duration());
  return Error("keys-time",
               fmt::format("{} s is outside the motion, 0 to {} s", readable(seconds),
                           readable(clip.duration(), 4)),
               frame_hint(time, clip.frame_count()));
}

Result<int> joint_of(const std::string& name, const Clip& clip) {
  const int joint = clip.skeleton.find(name);
  if (joint >= 0) return joint;
  return Error("keys-joint", fmt::format("the motion has no joint '{}'", name),
               "krok-info -v lists its joints");
}

Vec3 place_of(const Clip& clip, int joint, double from, double to) {
  const int last = clip.frame_count() - 1;
  const int first = std::clamp(static_cast<int>(std::lround(from * clip.rate)), 0, last);
  const int end = std::clamp(static_cast<int>(std::lround(to * clip.rate)), first, last);
  std::array<std::vector<double>, 3> values;
  for (int f = first; f <= end; ++f) {
    const Vec3f& at = clip.frame_positions(f)[static_cast<std::size_t>(joint)];
    for (int i = 0; i < 3; ++i) values[static_cast<std::size_t>(i)].push_back(at[i]);
  }
  Vec3 place;
  for (int i = 0; i < 3; ++i) {
    auto& list = values[static_cast<std::size_t>(i)];
    std::ranges::sort(list);
    place[i] = list[list.size() / 2];
  }
  return place;
}

// Fails for a name that no keytime has, which may be misspelt, unless such names are wanted.
Status check_name(const std::string& name, const std::vector<MarkedKeytime>& list, bool new_names) {
  std::vector<std::string> known = {"left_strike", "left_off", "right_strike", "right_off"};
  for (const MarkedKeytime& one : list) {
    if (std::ranges::find(known, one.key.name) == known.end()) known.push_back(one.key.name);
  }
  if (new_names || std::ranges::find(known, name) != known.end()) return {};
  const std::string near = nearest_name(name, known);
  return Error("keys-name", fmt::format("there is no keytime '{}'", shown(name)),
               near.empty()
                   ? fmt::format("there are {}; --new adds one of a new name", either_of(known))
                   : fmt::format("did you mean '{}'? --new adds one of a new name", near));
}

Status set_keytimes(const Changes& changes, const Clip& clip, krok::keys::Sidecar& sidecar) {
  std::vector<MarkedKeytime> list = keytimes_of(sidecar);
  for (const KeytimeChange& change : changes.remove) {
    std::size_t removed = 0;
    if (change.time) {
      const auto time = seconds_of(*change.time, clip);
      if (!time) return time.error();
      const auto found = nearest(list, change.name, *time);
      if (found != list.end()) list.erase(found), removed = 1;
    } else {
      removed =
          std::erase_if(list, [&](const MarkedKeytime& k) { return k.key.name == change.name; });
    }
    if (removed == 0) {
      const bool known = std::ranges::any_of(
          list, [&](const MarkedKeytime& one) { return one.key.name == change.name; });
      return Error(
          "keys-none",
          fmt::format("no keytime '{}'{} to remove", change.name, known ? " near that time" : ""),
          "run without --remove to list the keytimes");
    }
    sidecar.edited = true;
  }
  for (const KeytimeChange& change : changes.set) {
    const auto time = seconds_of(*change.time, clip);
    if (!time) return time.error();
    if (Status status = check_name(change.name, list, changes.new_names); !status) return status;
    const auto found = nearest(list, change.name, *time);
    if (found != list.end()) list.erase(found);
    list.push_back({{*time, change.name}, true});
  }
  put(std::move(list), sidecar);
  for (std::size_t i = 1; i < sidecar.keys.keytimes.size(); ++i) {
    const Keytime &a = sidecar.keys.keytimes[i - 1], &b = sidecar.keys.keytimes[i];
    if (b.time - a.time >= 2e-6) continue;
    return Error(
        "keys-time",
        fmt::format("'{}' and '{}' would both be at {} s", a.name, b.name, readable(b.time)),
        "keytimes must be at least 2 microseconds apart");
  }
  return {};
}

Status set_contacts(const Changes& changes, const Clip& clip, krok::keys::Sidecar& sidecar) {
  std::vector<MarkedContact> list = contacts_of(sidecar);
  for (const KeytimeChange& change : changes.remove_contact) {
    const auto joint = joint_of(change.name, clip);
    if (!joint) return joint.error();
    const auto time = seconds_of(*change.time, clip);
    if (!time) return time.error();
    const std::size_t removed = std::erase_if(list, [&](const MarkedContact& c) {
      return c.contact.joint == *joint && c.contact.start <= *time && *time <= c.contact.end;
    });
    if (removed == 0) {
      return Error("keys-none",
                   fmt::format("'{}' has no contact at {} s", change.name, readable(*time)),
                   "run without --remove-contact to list the contacts");
    }
    sidecar.edited = true;
  }
  for (const ContactChange& change : changes.add_contact) {
    const auto joint = joint_of(change.joint, clip);
    if (!joint) return joint.error();
    const auto from = seconds_of(change.from, clip);
    if (!from) return from.error();
    const auto to = seconds_of(change.to, clip);
    if (!to) return to.error();
    if (*to < *from) {
      return Error("keys-time", fmt::format("--add-contact {}: ends at {} s, before it starts "
                                            "at {} s",
                                            change.joint, readable(*to), readable(*from)));
    }
    const Contact contact{*joint, *from, *to, place_of(clip, *joint, *from, *to)};
    std::erase_if(list, [&](const MarkedContact& c) { return overlap(c.contact, contact); });
    list.push_back({contact, true});
  }
  put(std::move(list), sidecar);
  return {};
}

}  // namespace

krok::keys::Sidecar with_edits(MotionKeys found, const krok::keys::Sidecar& before) {
  krok::keys::Sidecar result;
  result.keys = std::move(found);
  std::vector<MarkedKeytime> keytimes = keytimes_of(result);
  std::vector<MarkedContact> contacts = contacts_of(result);
  for (const MarkedKeytime& set : keytimes_of(before)) {
    if (!set.by_hand) continue;
    const auto same = nearest(keytimes, set.key.name, set.key.time);
    if (same != keytimes.end() && !same->by_hand) keytimes.erase(same);
    keytimes.push_back(set);
  }
  for (const MarkedContact& set : contacts_of(before)) {
    if (!set.by_hand) continue;
    std::erase_if(contacts, [&](const MarkedContact& c) {
      return !c.by_hand && overlap(c.contact, set.contact);
    });
    contacts.push_back(set);
  }
  put(std::move(keytimes), result);
  put(std::move(contacts), result);
  return result;
}

Status change(const Changes& changes, const Clip& clip, krok::keys::Sidecar& sidecar) {
  if (Status status = set_keytimes(changes, clip, sidecar); !status) return status.error();
  return set_contacts(changes, clip, sidecar);
}

}  // namespace krok::cli::keys
