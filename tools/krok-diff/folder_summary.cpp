// Reports on two folders: text, JSON, page.

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "core/markup.h"
#include "core/numbers.h"
#include "core/text.h"
#include "tools/cli/output_set.h"
#include "tools/krok-diff/compare_files.h"
#include "tools/krok-diff/folders.h"

namespace krok::cli::diff {

namespace {

constexpr std::array kStatuses = {FileStatus::same,          FileStatus::differs,
                                  FileStatus::only_in_first, FileStatus::only_in_second,
                                  FileStatus::unreadable,    FileStatus::not_compared};

const char* status_key(FileStatus status) {
  switch (status) {
    case FileStatus::same:
      return "same";
    case FileStatus::differs:
      return "differs";
    case FileStatus::only_in_first:
      return "only_in_first";
    case FileStatus::only_in_second:
      return "only_in_second";
    case FileStatus::unreadable:
      return "unreadable";
    case FileStatus::not_compared:
      break;
  }
  return "not_compared";
}

std::string safe(const std::string& text) {
  return printable(to_utf8(text));
}

std::string title_of(const Options& options) {
  return fmt::format("{} against {}", safe(options.first), safe(options.second));
}

// Labels and counts; counts of 0 are omitted except for `same`.
std::vector<std::pair<std::string, std::size_t>> counts_of(const FolderOutcome& outcome,
                                                           const Options& options) {
  std::vector<std::pair<std::string, std::size_t>> counts;
  for (const FileStatus status : kStatuses) {
    const std::size_t count = outcome.count(status);
    if (count > 0 || status == FileStatus::same) {
      counts.emplace_back(status_words(status, options), count);
    }
  }
  return counts;
}

// For HTML, and for Markdown table cells, where a bar must be escaped.
std::string escaped(const std::string& text) {
  std::string result = to_markup(safe(text));
  for (std::size_t at = 0; (at = result.find('|', at)) != std::string::npos;) {
    result.replace(at, 1, "&#124;");
  }
  return result;
}

// Texts of a row of the page.
struct PageRow {
  std::string status, path, what;
};

std::vector<PageRow> page_rows(const FolderOutcome& outcome, const FolderUpdate& update,
                               const Options& options) {
  std::vector<PageRow> rows;
  for (const FileResult& file : outcome.files) {
    if (file.status == FileStatus::same) continue;
    rows.push_back({status_words(file.status, options), file.path, file.what});
  }
  const auto add = [&](const char* what, const std::vector<std::string>& paths) {
    for (const std::string& path : paths) rows.push_back({what, path, ""});
  };
  add("now replaced", update.replaced);
  add("now added", update.added);
  add("now removed", update.removed);
  return rows;
}

std::string markdown(const FolderOutcome& outcome, const FolderUpdate& update,
                     const Options& options) {
  std::string text = fmt::format("## {}\n\n| files | |\n|---|--:|\n", escaped(title_of(options)));
  for (const auto& [words, count] : counts_of(outcome, options)) {
    text += fmt::format("| {} | {} |\n", escaped(words), count);
  }
  const auto rows = page_rows(outcome, update, options);
  if (!rows.empty()) text += "\n| file | | what |\n|---|---|---|\n";
  for (const PageRow& row : rows) {
    text += fmt::format("| <code>{}</code> | {} | {} |\n", escaped(row.path), escaped(row.status),
                        escaped(row.what));
  }
  return text;
}

constexpr const char* kStyle =
    "body{font:15px/1.5 system-ui,sans-serif;margin:2rem auto;max-width:70rem;padding:0 1rem;"
    "color:#1b1f24;background:#fff}h1{font-size:1.3rem}table{border-collapse:collapse;"
    "margin:1rem 0}th,td{text-align:left;padding:.25rem .8rem;border-bottom:1px solid #d8dde3;"
    "vertical-align:top}td.n{text-align:right}code{overflow-wrap:anywhere}"
    "p.same{color:#14662f}p.other{color:#a01c1c;font-weight:600}"
    "@media(prefers-color-scheme:dark){body{color:#dce1e7;background:#15181c}"
    "th,td{border-color:#39424d}p.same{color:#7ddc9a}p.other{color:#ff9a8a}}";

std::string html(const FolderOutcome& outcome, const FolderUpdate& update, const Options& options) {
  const std::string title = escaped(title_of(options));
  const auto rows = page_rows(outcome, update, options);
  std::string text = fmt::format(
      "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width\">\n<title>{}</title>\n"
      "<style>{}</style></head>\n<body><h1>{}</h1>\n",
      title, kStyle, title);
  text +=
      rows.empty() ? "<p class=\"same\">The same.</p>\n" : "<p class=\"other\">Not the same.</p>\n";
  text += "<table>\n";
  for (const auto& [words, count] : counts_of(outcome, options)) {
    text += fmt::format("<tr><td>{}</td><td class=\"n\">{}</td></tr>\n", escaped(words), count);
  }
  text += "</table>\n";
  if (!rows.empty()) {
    text += "<table>\n<thead><tr><th>File</th><th></th><th>What</th></tr></thead>\n<tbody>\n";
    for (const PageRow& row : rows) {
      text += fmt::format("<tr><td><code>{}</code></td><td>{}</td><td>{}</td></tr>\n",
                          escaped(row.path), escaped(row.status), escaped(row.what));
    }
    text += "</tbody></table>\n";
  }
  return text + "</body></html>\n";
}

}  // namespace

std::string status_words(FileStatus status, const Options& options) {
  switch (status) {
    case FileStatus::same:
      return "the same";
    case FileStatus::differs:
      return "differs";
    case FileStatus::only_in_first:
      return "only in " + safe(options.first);
    case FileStatus::only_in_second:
      return "only in " + safe(options.second);
    case FileStatus::unreadable:
      return "cannot be read";
    case FileStatus::not_compared:
      break;
  }
  return "not compared";
}

std::string to_text(const FolderOutcome& outcome, const Options& options, bool all) {
  std::string text;
  for (const FileResult& file : outcome.files) {
    const bool listed = file.status != FileStatus::same && file.status != FileStatus::not_compared;
    if (!listed && !all) continue;
    text += fmt::format("{}: {}{}{}\n", status_words(file.status, options), safe(file.path),
                        file.what.empty() ? "" : ": ", safe(file.what));
  }
  for (const std::string& note : outcome.notes) text += "note: " + safe(note) + "\n";
  const auto counts = counts_of(outcome, options);
  std::size_t width = 0;
  for (const auto& [words, count] : counts) width = std::max(width, words.size());
  text += fmt::format("{}: {}\n", title_of(options),
                      counted(static_cast<long long>(outcome.files.size()), "file"));
  for (const auto& [words, count] : counts) {
    text += fmt::format("  {:<{}}  {:>5}\n", words, width, count);
  }
  return text;
}

Json to_json(const FolderOutcome& outcome, const Options& options) {
  Json json;
  json["kind"] = "folders";
  json["same"] = outcome.count(FileStatus::same) == outcome.files.size();
  json["first"] = options.first;
  json["second"] = options.second;
  json["tolerance"] = to_json(options.tolerance);
  Json& counts = json["counts"];
  for (const FileStatus status : kStatuses) counts[status_key(status)] = outcome.count(status);
  json["notes"] = outcome.notes;
  json["files"] = Json::array();
  for (const FileResult& file : outcome.files) {
    Json entry;
    entry["path"] = file.path;
    entry["status"] = status_key(file.status);
    if (!file.what.empty()) entry["what"] = file.what;
    if (!file.outcome.is_null()) entry["difference"] = file.outcome;
    json["files"].push_back(std::move(entry));
  }
  return json;
}

Status check_summary_name(const std::string& path) {
  const std::string ending = extension(path);
  if (path.empty() || path == "-" || ending == ".html" || ending == ".htm" || ending == ".md") {
    return {};
  }
  return Error("usage", fmt::format("--summary {}: the output is HTML or Markdown", path),
               "use the extension .html or .md");
}

Status write_summary(const FolderOutcome& outcome, const FolderUpdate& update,
                     const Options& options, ToolContext& context) {
  const std::string& path = options.folders.summary;
  if (path.empty()) return {};
  const std::string text = extension(path) == ".md" ? markdown(outcome, update, options)
                                                    : html(outcome, update, options);
  return write_output(context, path, [&](OutputFile& file) { return file.write(text); });
}

}  // namespace krok::cli::diff
