#include "tools/krok-diff/folders.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <span>
#include <sstream>

#include "core/file.h"
#include "core/numbers.h"
#include "core/text.h"
#include "tools/cli/output_set.h"
#include "tools/cli/paths.h"
#include "tools/krok-diff/options.h"

// A page about a comparison.

namespace krok::cli::diff {

namespace {

namespace fs = std::filesystem;

// For HTML, and for Markdown table cells, where a bar must be escaped.
std::string escaped(const std::string& text) {
  std::string result = to_markup(printable(to_utf8(text)));
  for (std::size_t at = 0; (at = result.find('|', at)) != std::string::npos;) {
    result.replace(at, 1, "&#124;");
  }
  return result;
}

// A row of the page. Files that are now the same, after an update, have no `file`.
struct PageRow {
  std::string status, path, what;
  const FileResult* file = nullptr;

  bool has_detail() const { return file != nullptr && file->status == FileStatus::differs; }
};

// What needs attention first: files that cannot be read, then by how bad the difference is.
std::vector<PageRow> page_rows(const FolderOutcome& outcome, const FolderUpdate& update,
                               const Options& options) {
  const auto rank = [](const FileResult& file) {
    return file.status == FileStatus::unreadable ? -1 : static_cast<int>(file.status);
  };
  std::vector<const FileResult*> files;
  for (const FileResult& file : outcome.files) {
    if (file.status != FileStatus::same) files.push_back(&file);
  }
  std::stable_sort(files.begin(), files.end(), [&](const FileResult* a, const FileResult* b) {
    return rank(*a) != rank(*b) ? rank(*a) < rank(*b) : a->detail.excess > b->detail.excess;
  });
  std::vector<PageRow> rows;
  for (const FileResult* file : files) {
    rows.push_back({status_words(file->status, options), file->path, file->what, file});
  }
  const auto add = [&](const char* what, const std::vector<std::string>& paths) {
    for (const std::string& path : paths) rows.push_back({what, path, "", nullptr});
  };
  add("now replaced", update.replaced);
  add("now added", update.added);
  add("now removed", update.removed);
  return rows;
}

std::string markdown(const FolderOutcome& outcome, const std::vector<PageRow>& rows,
                     const Options& options) {
  std::string text = fmt::format("## {}\n\n| files | |\n|---|--:|\n", escaped(title_of(options)));
  for (const auto& [words, count] : counts_of(outcome, options)) {
    text += fmt::format("| {} | {} |\n", escaped(words), count);
  }
  if (!rows.empty()) text += "\n| file | | what |\n|---|---|---|\n";
  for (const PageRow& row : rows) {
    text += fmt::format("| <code>{}</code> | {} | {} |\n", escaped(row.path), escaped(row.status),
                        escaped(row.what));
  }
  return text;
}

constexpr const char* kStyle = R"(
:root{color-scheme:light dark;--ink:#1b1f24;--soft:#57606a;--paper:#fff;--line:#d8dde3;
--card:#f7f8fa;--good:#14662f;--bad:#a01c1c;--link:#0b5cad}
@media(prefers-color-scheme:dark){:root{--ink:#dce1e7;--soft:#9aa5b1;--paper:#15181c;--line:#39424d;
--card:#1c2127;--good:#7ddc9a;--bad:#ff9a8a;--link:#7db8f5}}
body{font:15px/1.5 system-ui,sans-serif;margin:2rem auto;max-width:80rem;padding:0 1rem;
color:var(--ink);background:var(--paper)}
h1{font-size:1.3rem;overflow-wrap:anywhere}h2{font-size:1.05rem;margin:0;overflow-wrap:anywhere}
a{color:var(--link)}code{font:.93em ui-monospace,monospace;overflow-wrap:anywhere}
table{border-collapse:collapse;margin:1rem 0}
th,td{text-align:left;padding:.25rem .8rem;border-bottom:1px solid var(--line);vertical-align:top}
td:first-child{min-width:9rem}
.n{text-align:right;font-variant-numeric:tabular-nums}
p{margin:.3rem 0}.same{color:var(--good)}.other{color:var(--bad);font-weight:600}.soft{color:var(--soft)}
article{margin:1.2rem 0;padding:1rem;border:1px solid var(--line);border-radius:6px;
background:var(--card)}
article:target{border-color:var(--link)}
.shots{display:flex;flex-wrap:wrap;gap:.8rem 1.2rem;margin:.8rem 0 .4rem}
figure{margin:0;width:min-content;min-width:11rem;max-width:100%}
figcaption{font-size:.87rem;color:var(--soft);overflow-wrap:anywhere}
.shot{display:block;padding:0;border:1px solid var(--line);background:none;cursor:zoom-in;max-width:100%}
.shot img{display:block;height:14rem;width:auto;max-width:100%;object-fit:contain}
.shot:focus-visible{outline:3px solid var(--link)}
.key{display:block;height:.6rem;margin:.3rem 0 0}.ends{display:flex;justify-content:space-between}
pre{white-space:pre-wrap;font:.87rem/1.45 ui-monospace,monospace;margin:.6rem 0}
summary{cursor:pointer;width:max-content}.chart{max-width:100%;height:auto}
@media(min-width:60rem){.shot img{height:24rem}}
@media(max-width:40rem){body{margin:1rem auto}th,td{padding:.25rem .4rem}
td:first-child{min-width:6rem}td:last-child:not(.n){overflow-wrap:anywhere}figure{min-width:0;flex:1 1 8rem}
.shot img{width:100%;height:auto}summary{padding:.7rem 0;min-height:44px;box-sizing:border-box}}
dialog{border:0;padding:1rem;max-width:96vw;background:var(--paper);color:var(--ink)}
dialog::backdrop{background:rgba(0,0,0,.7)}
dialog img{display:block;max-width:92vw;height:min(80vh,60rem);object-fit:contain;cursor:pointer}
)";

// A picture opens large; a click or an arrow key there switches between before, after and
// difference at the same place, which shows small changes best.
constexpr const char* kScript = R"(
const box = document.querySelector('dialog');
const large = box.querySelector('img'), caption = box.querySelector('p');
let shots = [], at = 0;
const show = (index) => {
  at = (index + shots.length) % shots.length;
  large.src = shots[at].src;
  large.alt = shots[at].alt;
  caption.textContent = `${shots[at].alt} (${at + 1} of ${shots.length}; arrow keys switch)`;
};
document.addEventListener('click', (event) => {
  const shot = event.target.closest('.shot');
  if (shot) {
    shots = [...shot.closest('.shots').querySelectorAll('.shot img')];
    show(shots.indexOf(shot.querySelector('img')));
    box.showModal();
  } else if (event.target === large) {
    show(at + 1);
  } else if (event.target === box) {
    box.close();
  }
});
box.addEventListener('keydown', (event) => {
  if (event.key === 'ArrowRight') show(at + 1);
  if (event.key === 'ArrowLeft') show(at - 1);
});
)";

// The address of a file, relative to the page.
std::string link_to(const std::string& path, const std::string& page) {
  const fs::path folder =
      fs::absolute(page == "-" ? "page" : page).lexically_normal().parent_path();
  const fs::path relative = fs::absolute(path).lexically_normal().lexically_relative(folder);
  return uri_of(relative.generic_string());
}

std::string html_of_key(const render::ColourKey& key) {
  constexpr int kStops = 20;
  std::string stops;
  for (int i = 0; i <= kStops; ++i) {
    const render::Colour colour = key.at(key.high * i / kStops);
    stops += fmt::format(",#{:02x}{:02x}{:02x}", colour.red, colour.green, colour.blue);
  }
  std::string text = "distance from before";
  if (key.low > 0 && key.low < key.high) {
    text += fmt::format(", grey up to {} {}", readable(key.low, 3), escaped(key.unit));
  }
  return text + fmt::format(
                    "<span class=\"key\" style=\"background:linear-gradient(90deg{})\"></span>"
                    "<span class=\"ends\"><span>0</span><span>{} {}</span></span>",
                    stops, readable(key.high, 3), escaped(key.unit));
}

std::string figure(const std::string& words, const std::string& png, const Pictures& pictures,
                   const std::string& caption) {
  return fmt::format(
      "<figure><button class=\"shot\" type=\"button\"><img alt=\"{}\" width=\"{}\" height=\"{}\" "
      "src=\"data:image/png;base64,{}\"></button><figcaption>{}</figcaption></figure>\n",
      escaped(words), pictures.width, pictures.height, png, caption);
}

std::string html_of_pictures(const PageRow& row, const std::string& first,
                             const std::string& second, const std::string& page) {
  const Pictures& pictures = *row.file->detail.pictures;
  const auto link = [&](const char* words, const std::string& path) {
    return fmt::format("{}: <a href=\"{}\"><code>{}</code></a>", words, link_to(path, page),
                       escaped(path));
  };
  const std::string difference =
      pictures.key
          ? html_of_key(*pictures.key)
          : "before, faint, and after; points do not correspond, so no distances are shown";
  std::string text = "<div class=\"shots\">\n";
  text += figure(row.path + " before", pictures.before, pictures, link("before", first));
  text += figure(row.path + " after", pictures.after, pictures, link("after", second));
  text += figure(row.path + " difference", pictures.difference, pictures, difference);
  text += "</div>\n";
  if (!pictures.moment.empty()) {
    text += fmt::format("<p class=\"soft\">at {}</p>\n", escaped(pictures.moment));
  }
  return text;
}

std::string html_of_detail(const PageRow& row, std::size_t number, const Options& options,
                           bool folders, const std::string& page) {
  const FileDetail& detail = row.file->detail;
  const std::string first = folders ? below(options.first, row.path) : options.first;
  const std::string second = folders ? below(options.second, row.path) : options.second;
  std::string text = fmt::format("<article id=\"file-{}\"><h2><code>{}</code></h2>\n<p>{}</p>\n",
                                 number, escaped(row.path), escaped(row.what));
  if (detail.pictures) {
    text += html_of_pictures(row, first, second, page);
  } else {
    text += fmt::format("<p><a href=\"{}\">before</a> <a href=\"{}\">after</a></p>\n",
                        link_to(first, page), link_to(second, page));
  }
  text += "<details><summary>All measures</summary><pre>";
  std::istringstream lines(detail.text);
  for (std::string line; std::getline(lines, line);) text += escaped(line) + "\n";
  text += "</pre>";
  if (!detail.chart.empty()) {
    text += fmt::format(
        "<img class=\"chart\" alt=\"{} over time\" loading=\"lazy\" "
        "src=\"data:image/svg+xml;base64,{}\">",
        escaped(row.path), to_base64(std::as_bytes(std::span(detail.chart))));
  }
  return text + "</details></article>\n";
}

std::string html_of_table(const FolderOutcome& outcome, const std::vector<PageRow>& rows,
                          const Options& options) {
  std::string text = "<table>\n";
  for (const auto& [words, count] : counts_of(outcome, options)) {
    text += fmt::format("<tr><td>{}</td><td class=\"n\">{}</td></tr>\n", escaped(words), count);
  }
  text += "</table>\n";
  if (rows.empty()) return text;
  text += "<table>\n<thead><tr><th>File</th><th>Status</th><th>What</th></tr></thead>\n<tbody>\n";
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const PageRow& row = rows[i];
    std::string name = fmt::format("<code>{}</code>", escaped(row.path));
    if (row.has_detail()) name = fmt::format("<a href=\"#file-{}\">{}</a>", i + 1, name);
    text += fmt::format("<tr><td>{}</td><td>{}</td><td>{}</td></tr>\n", name, escaped(row.status),
                        escaped(row.what));
  }
  return text + "</tbody></table>\n";
}

std::string html(const FolderOutcome& outcome, const std::vector<PageRow>& rows,
                 const Options& options, const std::string& page) {
  std::error_code unknown;
  const bool folders = fs::is_directory(options.second, unknown);
  const std::string title = escaped(title_of(options));
  std::string text = fmt::format(
      "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width\">\n<title>{}</title>\n"
      "<style>{}</style></head>\n<body><main><h1>{}</h1>\n",
      title, kStyle, title);
  text +=
      rows.empty() ? "<p class=\"same\">The same.</p>\n" : "<p class=\"other\">Not the same.</p>\n";
  if (folders) text += html_of_table(outcome, rows, options);
  bool pictures = false;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (!rows[i].has_detail()) continue;
    text += html_of_detail(rows[i], i + 1, options, folders, page);
    pictures = pictures || rows[i].file->detail.pictures.has_value();
  }
  text += "</main>";
  if (pictures) {
    text += fmt::format(
        "<dialog aria-label=\"picture\"><img alt=\"\"><p class=\"soft\"></p></dialog>\n"
        "<script>{}</script>",
        kScript);
  }
  return text + "</body></html>\n";
}

// A test case for each file, in the form of JUnit that CI servers read (Jenkins, GitLab, GitHub's
// reporters). The times that the comparisons took are its only values that differ from run to run.
std::string junit(const FolderOutcome& outcome, const Options& options) {
  const auto element_of = [](FileStatus status) {
    return status == FileStatus::same           ? ""
           : status == FileStatus::unreadable   ? "error"
           : status == FileStatus::not_compared ? "skipped"
                                                : "failure";
  };
  const auto count_of = [&](std::string_view element) {
    return std::ranges::count_if(
        outcome.files, [&](const FileResult& file) { return element_of(file.status) == element; });
  };
  std::string text = fmt::format(
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites>\n<testsuite name=\"{}\" "
      "tests=\"{}\" failures=\"{}\" errors=\"{}\" skipped=\"{}\">\n",
      escaped(title_of(options)), outcome.files.size(), count_of("failure"), count_of("error"),
      count_of("skipped"));
  for (const FileResult& file : outcome.files) {
    text += fmt::format("<testcase classname=\"krok-diff\" name=\"{}\" time=\"{:.3f}\"",
                        escaped(file.path), file.seconds);
    const std::string_view element = element_of(file.status);
    if (element.empty()) {
      text += "/>\n";
      continue;
    }
    text += fmt::format("><{} message=\"{}{}{}\"/></testcase>\n", element,
                        escaped(status_words(file.status, options)), file.what.empty() ? "" : ": ",
                        escaped(file.what));
  }
  return text + "</testsuite>\n</testsuites>\n";
}

}  // namespace

Status write_summary(const FolderOutcome& outcome, const FolderUpdate& update,
                     const Options& options, ToolContext& context) {
  const auto rows = page_rows(outcome, update, options);
  for (const std::string& path : options.summaries) {
    const std::string text = extension(path) == ".xml" ? junit(outcome, options)
                             : is_page(path)           ? html(outcome, rows, options, path)
                                                       : markdown(outcome, rows, options);
    const Status status = write_output(context, path, text);
    if (!status) return status;
  }
  return {};
}

}  // namespace krok::cli::diff
