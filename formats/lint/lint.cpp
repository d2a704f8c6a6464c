#include "formats/lint/lint.h"

#include "formats/json/fields.h"

namespace krok::lint_files {

namespace {

using json::Given;

constexpr std::string_view kFormat = "lint";
constexpr std::size_t kMaxItems = 1'000'000;
constexpr double kLatest = 1e7;  // seconds

struct Rules {
  std::vector<RuleChoice> items;
};
struct Suppressions {
  std::vector<Suppression> items;
};
struct Faults {
  std::vector<KnownFault> items;
};

Status has_words(const Given& object, const std::string& text, std::string_view key) {
  if (text.find_first_not_of(" \t\n") != std::string::npos) return {};
  return object.member(key).wrong("the reason is empty", "say why the fault is accepted");
}

json::Object<Rules> profile_table() {
  json::Object<RuleChoice> rule;
  rule.field("rule", &RuleChoice::rule, json::text(), "id, as krok-lint --rules lists them")
      .required();
  rule.field("use", &RuleChoice::use, json::boolean());
  rule.field("limit", &RuleChoice::limit, json::positive(), "in the rule's unit");
  json::Object<Rules> file;
  file.file("krok.lint-profile/1", "Rules of krok-lint and their limits (krok.lint-profile/1)");
  file.field("rules", &Rules::items,
             json::list<RuleChoice>(json::object(rule), {"rule {0}", 0, kMaxItems}))
      .required();
  return file;
}

json::Object<Suppressions> suppressions_table() {
  json::Object<Suppression> item;
  item.field("rule", &Suppression::rule, json::text()).required();
  item.field("joint", &Suppression::joint, json::text());
  item.field("from", &Suppression::from, json::number(0, kLatest), "seconds");
  item.field("to", &Suppression::to, json::number(0, kLatest), "seconds");
  item.field("reason", &Suppression::reason, json::text())
      .required()
      .check([](const Given& object, const Suppression& of) {
        return has_words(object, of.reason, "reason");
      });
  json::Object<Suppressions> file;
  file.file("krok.lint-suppressions/1",
            "Faults of a motion that are accepted (krok.lint-suppressions/1)");
  file.field("suppressions", &Suppressions::items,
             json::list<Suppression>(json::object(item), {"suppression {0}", 0, kMaxItems}))
      .required();
  return file;
}

json::Object<Faults> baseline_table() {
  json::Object<KnownFault> fault;
  fault.field("file", &KnownFault::file, json::text(), "without folder and ending").required();
  fault.field("rule", &KnownFault::rule, json::text()).required();
  fault.field("joint", &KnownFault::joint, json::text());
  fault.field("from", &KnownFault::from, json::number(0, kLatest), "seconds").required();
  fault.field("to", &KnownFault::to, json::number(0, kLatest), "seconds").required();
  fault.field("near", &KnownFault::near, json::boolean(), "nearly a fault")
      .written_if([](const KnownFault& of) { return of.near; });
  json::Object<Faults> file;
  file.file("krok.lint-baseline/1", "Faults that are known (krok.lint-baseline/1)");
  file.lines(2);
  file.field("faults", &Faults::items,
             json::list<KnownFault>(
                 json::object(fault),
                 {.each = "fault {0}", .least = 0, .most = kMaxItems, .lines = true}))
      .required();
  return file;
}

template <typename Container>
auto items_of(Result<Container> read) -> Result<decltype(Container::items)> {
  if (!read) return std::move(read).error();
  return std::move(read->items);
}

}  // namespace

Result<std::vector<RuleChoice>> read_profile(std::string_view text) {
  return items_of(profile_table().read_text(text, kFormat));
}

Result<std::vector<Suppression>> read_suppressions(std::string_view text) {
  return items_of(suppressions_table().read_text(text, kFormat));
}

Result<std::vector<KnownFault>> read_baseline(std::string_view text) {
  return items_of(baseline_table().read_text(text, kFormat, std::size_t{1} << 30));
}

std::string write_baseline(const std::vector<KnownFault>& faults) {
  const Faults file{faults};
  return baseline_table().write(&file) + "\n";
}

}  // namespace krok::lint_files
