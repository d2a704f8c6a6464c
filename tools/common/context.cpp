#include <fmt/format.h>

#include <cstdio>

#include "core/hash.h"
#include "tools/common/console_progress.h"
#include "tools/common/paths.h"
#include "tools/common/tool.h"

namespace krok {

void ToolContext::put_message(const std::string& text) {
  if (kept_messages != nullptr) {
    *kept_messages += text;
  } else {
    write_message(console, text);
  }
}

void ToolContext::tell(Diagnostic diagnostic) {
  if (diagnostic.where.file.empty() && !subject.file.empty()) diagnostic.where = subject;
  const bool shown = diagnostic.severity == Severity::error ||
                     (!quiet && (verbose || diagnostic.severity != Severity::note));
  if (shown) put_message(message_of(report.tool, diagnostic));
  report.issues.push_back(std::move(diagnostic));
}

void ToolContext::tell(const Diagnostics& diagnostics) {
  for (const Diagnostic& diagnostic : diagnostics) tell(diagnostic);
}

void ToolContext::warn(std::string code, std::string message, std::string hint) {
  Diagnostic diagnostic;
  diagnostic.severity = Severity::warning;
  diagnostic.code = std::move(code);
  diagnostic.message = std::move(message);
  diagnostic.hint = std::move(hint);
  tell(std::move(diagnostic));
}

void ToolContext::say(const std::string& line) {
  const bool one_of_many = kept_messages != nullptr;
  if (!quiet && !report_on_standard_output && (verbose || !one_of_many)) put_message(line + "\n");
}

void ToolContext::print(const std::string& text) {
  if (report_on_standard_output) return;
  // Nothing can be done about a failure here; it is checked once, at the end.
  (void)std::fwrite(text.data(), 1, text.size(), stdout);
}

Result<InputFile> ToolContext::open_input(const std::string& path) {
  for (const std::string& destination : destinations) {
    if (same_file(path, destination)) {
      refused_inputs.push_back(path);
      return Error("usage", "is read and would be replaced by a result", "choose another name")
          .in_file(path);
    }
  }
  for (const Report::Input& input : report.inputs) {
    if (path == "-" && input.path == path) {
      return Error("usage", "standard input can be read only once", "name a file for the other");
    }
  }
  auto file = InputFile::open(path);
  if (file) report.inputs.push_back({path, hex(file->checksum())});
  return file;
}

void ToolContext::wrote(const std::string& path) {
  report.outputs.push_back(path);
}

Provenance ToolContext::provenance() const {
  Provenance provenance;
  provenance.tool = report.tool;
  provenance.version = report.version;
  for (const auto& input : report.inputs) {
    provenance.sources.push_back({base_name(input.path), input.xxh3});
  }
  for (const auto& [name, value] : result_options.items()) {
    provenance.options.emplace_back(name,
                                    value.is_string() ? value.get<std::string>() : value.dump());
  }
  for (const Diagnostic& issue : report.issues) {
    if (issue.severity == Severity::warning) {
      provenance.warnings.push_back(fmt::format("{} [{}]", issue.message, issue.code));
    }
  }
  return provenance;
}

}  // namespace krok
