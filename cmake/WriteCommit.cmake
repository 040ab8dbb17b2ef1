# SPDX-License-Identifier: BSD-3-Clause
# Runs in each build: writes OUTPUT, the source of base/command_line/about.h, where that has changed. Given: SOURCE, the
# project's folder. A tarball has its commit in packaging/commit.txt (git archive put it there); a checkout is asked.
file(STRINGS ${SOURCE}/packaging/commit.txt commit)
string(REGEX REPLACE " .*" "" commit "${commit}")
if(commit MATCHES "Format")
  execute_process(COMMAND git describe --always --exclude=* --dirty=+changes WORKING_DIRECTORY ${SOURCE}
                  OUTPUT_VARIABLE commit OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
endif()
if(NOT commit)
  set(commit unknown)
endif()
file(CONFIGURE OUTPUT ${OUTPUT} CONTENT "#include \"base/command_line/about.h\"

const char* const rumi::kCommit = \"${commit}\";
")
