#include "support/this_build.h"

namespace krok::test {

std::string source_folder() {
  return KROK_SOURCE_DIR;
}
std::string corpus_folder() {
  return KROK_SOURCE_DIR "/../shared/corpus";
}
std::string tools_folder() {
  return KROK_BUILD_DIR "/bin";
}
std::string sample_programs() {
  return KROK_SAMPLES_DIR;
}
std::string make_walk() {
  return KROK_SAMPLES_DIR "/make-walk";
}
std::string reports_folder() {
  return KROK_BUILD_DIR "/test_results/reports";
}
std::string failing_calls() {
  return KROK_BUILD_DIR "/tests/libfailing_calls.so";
}
std::string bench_parts() {
  return KROK_BUILD_DIR "/bench_parts";
}

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
bool sanitized() {
  return true;
}
#else
bool sanitized() {
  return false;
}
#endif

}  // namespace krok::test
