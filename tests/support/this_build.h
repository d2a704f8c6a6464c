#pragma once

// What differs from one build to another, compiled in one source: all others are the same in every
// checkout, so that ccache knows them again, and the sanitized programs share them with the release
// build. Paths are absolute.

#include <string>

namespace krok::test {

std::string source_folder();    // the project's
std::string corpus_folder();    // captures that are not part of it; may not exist
std::string tools_folder();     // krok-import and others
std::string sample_programs();  // make-walk and others
std::string make_walk();
std::string reports_folder();  // where run() leaves the reports of --json
std::string failing_calls();   // the library that lets calls of the system fail
std::string bench_parts();     // programs that do a part of what a tool does

// Whether the libraries are built with a sanitizer that uses memory or threads itself.
bool sanitized();

}  // namespace krok::test
