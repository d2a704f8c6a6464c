#include <fmt/format.h>

#include <array>

#include "tools/krok-edit/options.h"

// Options that modify another option, and that option.

namespace krok::cli::edit {

namespace {

struct Need {
  const char* option;
  bool (*met)(const Arguments&);
  const char* of;
};

bool filters(const Arguments& a) {
  return a.filter != Arguments::Filter::none;
}
bool cleans(const Arguments& a) {
  return a.spikes || filters(a);
}
bool appends(const Arguments& a) {
  return !a.append.empty();
}
// A sequence may loop if its file says so.
bool may_loop(const Arguments& a) {
  return a.loop || a.cycle != CycleFoot::none || !a.sequences.empty();
}

constexpr const char* kLoop = "--loop, --cycle, or --sequences with a looped one";
constexpr std::array kNeeds = {
    Need{"--spike-threshold", [](const Arguments& a) { return a.spikes; }, "--spikes"},
    Need{"--cutoff", [](const Arguments& a) { return a.filter == Arguments::Filter::butterworth; },
         "--filter butterworth"},
    Need{"--window", [](const Arguments& a) { return a.filter == Arguments::Filter::savgol; },
         "--filter savgol"},
    Need{"--order", filters, "--filter"},
    Need{"--joints", cleans, "--spikes or --filter"},
    Need{"--below", cleans, "--spikes or --filter"},
    Need{"--contacts", [](const Arguments& a) { return a.plant; }, "--plant"},
    Need{"--blend", appends, "--append"},
    Need{"--match-height", appends, "--append"},
    Need{"--loop-blend", may_loop, kLoop},
    Need{"--loop-end", may_loop, kLoop},
    Need{"--loop-turn", may_loop, kLoop},
    Need{"--loop-climb", may_loop, kLoop},
    Need{"--rounds", may_loop, kLoop},
};

}  // namespace

Status check_needs(const Arguments& arguments) {
  for (const Need& need : kNeeds) {
    if (!arguments.given || !arguments.given(need.option) || need.met(arguments)) continue;
    return Error("usage", fmt::format("{} has no effect without {}", need.option, need.of));
  }
  return {};
}

}  // namespace krok::cli::edit
