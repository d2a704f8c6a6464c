# Writes OUTPUT, a header with KROK_BUILD_STATE: empty for the sources of a commit and for those outside of
# a repository, else what --version says of them. The file is written only if it changes.
set(state "")
execute_process(COMMAND git -C ${SOURCE} rev-parse --show-toplevel OUTPUT_VARIABLE top
                OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET RESULT_VARIABLE failed)
if(NOT failed AND top STREQUAL SOURCE)
  execute_process(COMMAND git -C ${SOURCE} describe --always --dirty=+ --exclude=* OUTPUT_VARIABLE commit
                  OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
  if(commit MATCHES "^([0-9a-f]+)[+]$")
    set(state " (${CMAKE_MATCH_1} with uncommitted changes)")
  endif()
endif()
file(CONFIGURE OUTPUT ${OUTPUT} CONTENT "#define KROK_BUILD_STATE \"${state}\"\n")
