#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>

#include "core/hash.h"
#include "core/text.h"
#include "formats/io/inputs.h"
#include "tools/cli/console_progress.h"
#include "tools/cli/paths.h"
#include "tools/cli/report.h"
#include "tools/cli/tool.h"

namespace krok::cli {

namespace {

// Warnings or errors with one code that are shown, and warnings that are kept in a result: a file
// with tens of thousands of joints can have one for each.
constexpr int kMaxAlike = 20;

}  // namespace

// Everything a tool says goes through here or print(), and may quote what is in a file.
void ToolContext::put_message(const std::string& text, const std::string& code) {
  if (one_of_many != nullptr) {
    one_of_many->messages.push_back({printable(text, true), code});
  } else {
    write_message(console, printable(text, true));
  }
}

void ToolContext::diagnose(Diagnostic diagnostic) {
  if (diagnostic.where.file.empty() && !subject.file.empty()) diagnostic.where = subject;
  const bool shown = diagnostic.severity == Severity::error ||
                     (!quiet && (verbose || diagnostic.severity != Severity::note));
  // A file that is read for each of its animations warns of itself once.
  if (diagnostic.severity == Severity::warning &&
      !said_.insert(message_of(report.tool, diagnostic)).second) {
    return;
  }
  const std::string& file = diagnostic.where.file;
  const bool of_few = !shown || verbose || one_of_many != nullptr || file.empty() ||
                      by_file_.is_shown(diagnostic.code, file);
  const int alike = shown && of_few && !verbose ? ++alike_[diagnostic.code] : 1;
  const std::string code = verbose ? std::string() : diagnostic.code;
  if (shown && of_few && alike <= kMaxAlike) put_message(message_of(report.tool, diagnostic), code);
  if (shown && alike == kMaxAlike + 1) {
    put_message(fmt::format("  more of these {} are not shown; -v and --json have all [{}]\n",
                            diagnostic.severity == Severity::error ? "errors" : "warnings", code),
                code);
  }
  report.issues.push_back(std::move(diagnostic));
}

void ToolContext::end_messages() {
  if (const std::string more = by_file_.more(); !more.empty()) put_message(more);
  by_file_ = {};
}

void ToolContext::warn(std::string code, std::string message, std::string hint) {
  diagnose(make_warning(std::move(code), std::move(message), std::move(hint)));
}

Status ToolContext::leave_out(const std::string& path, Error error, std::size_t inputs) {
  if (error.where.file.empty()) error.where.file = path;
  if (inputs < 2) return error;
  if (!keep_going) {
    error.hint += fmt::format("{}--keep-going leaves it out", error.hint.empty() ? "" : "; ");
    return error;
  }
  Diagnostic diagnostic = error;
  diagnostic.severity = Severity::warning;
  diagnostic.hint = "left out";
  diagnose(std::move(diagnostic));
  left_out.insert(path);
  return {};
}

void ToolContext::log(const std::string& line) {
  if (quiet || report_on_standard_output || (!verbose && one_of_many != nullptr)) return;
  if (files_with_report.empty()) {
    put_message(line + "\n");
  } else {
    lines_with_report.push_back(line);
  }
}

void ToolContext::print(const std::string& given) {
  if (report_on_standard_output) return;
  const std::string text = printable(given, true);
  // Failures are checked once, at the end.
  (void)std::fwrite(text.data(), 1, text.size(), stdout);
}

ToolContext ToolContext::beside(OneOfMany& messages, int threads) const {
  static Progress none;
  ToolContext context;
  context.report.tool = report.tool;
  context.jobs = threads;
  context.limits = limits;
  context.quiet = true;
  context.progress = &none;
  context.one_of_many = &messages;
  context.destinations = destinations;
  return context;
}

Result<InputFile> ToolContext::open_input(const std::string& path) {
  auto file = open_long_input(path);
  if (file) note_checksum(*file);
  return file;
}

Result<InputFile> ToolContext::open_long_input(const std::string& address) {
  const std::string path = io::address_of(address).file;
  const auto replaces = [&](const std::string& destination) {
    return same_file(path, destination);
  };
  if (std::any_of(destinations.begin(), destinations.end(), replaces) ||
      (!written_.empty() && written_.count(place_of(path)) > 0)) {
    refused_inputs.push_back(path);
    return replaced_error(path);
  }
  for (const Report::Input& input : report.inputs) {
    if (path == "-" && input.path == path) {
      return Error("usage", "standard input can be read only once",
                   "use a file for the other input");
    }
  }
  auto file = io::open_address(address);
  if (file) report.inputs.push_back({path, "", file->part()});
  if (!file && file.error().hint == "check the path") {
    Error error = file.error();
    error.hint = missing_file_hint(path);
    return error;
  }
  return file;
}

void ToolContext::note_checksum(const InputFile& input) {
  for (Report::Input& opened : report.inputs) {
    if (opened.xxh3.empty() && opened.path == input.path()) opened.xxh3 = hex(input.checksum());
  }
}

void ToolContext::depends_on_neighbours(const std::string& path, const std::string& ending) {
  report.choices.push_back({std::filesystem::path(path).parent_path().string(), ending});
}

Status ToolContext::check_output(const std::string& path) {
  for (const Report::Input& input : report.inputs) {
    if (!same_file(input.path, path)) continue;
    refused_inputs.push_back(input.path);
    return replaced_error(input.path);
  }
  if (one_of_many != nullptr && one_of_many->check_unforeseen && !is_destination(path)) {
    if (Status status = one_of_many->check_unforeseen(path); !status) return status;
  }
  const std::string place = place_of(path);
  if (!place.empty()) written_.insert(place);
  const auto is_same = [&](const std::string& other) {
    return !place.empty() && place_of(other) == place;
  };
  if ((!report_path.empty() && is_same(report_path)) ||
      std::any_of(report.outputs.begin(), report.outputs.end(), is_same)) {
    return twice_error(path);
  }
  return {};
}

bool ToolContext::is_destination(const std::string& path) const {
  return std::find(destinations.begin(), destinations.end(), path) != destinations.end();
}

void ToolContext::wrote(const std::string& path) {
  report.outputs.push_back(path);
}

// Formats store text as UTF-8; file names may be any bytes.
Provenance ToolContext::provenance() const {
  Provenance provenance;
  provenance.tool = report.tool;
  provenance.version = report.version;
  for (const auto& input : report.inputs) {
    const std::string part = input.animation.empty() ? "" : "#" + input.animation;
    provenance.sources.push_back({to_utf8(base_name(input.path) + part), input.xxh3});
  }
  const auto text_of = [](const Json& value) {
    return value.is_string() ? to_utf8(value.get<std::string>()) : json_text(value);
  };
  for (const auto& [name, value] : result_options.items()) {
    // Repeated options are listed once per occurrence.
    const Json values = value.is_array() ? value : Json::array({value});
    for (const Json& one : values) provenance.options.emplace_back(name, text_of(one));
  }
  std::map<std::string, int> alike;
  for (const Diagnostic& issue : report.issues) {
    if (issue.severity == Severity::warning && ++alike[issue.code] <= kMaxAlike) {
      provenance.warnings.push_back(to_utf8(fmt::format("{} [{}]", issue.message, issue.code)));
    }
  }
  return provenance;
}

}  // namespace krok::cli
