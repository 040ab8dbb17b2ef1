# SPDX-License-Identifier: BSD-3-Clause
# Runs in each build: writes OUTPUT, which defines the commit for base/command_line/about.h, if it has changed. SOURCE is the
# project's folder. In a tarball, packaging/commit.txt has the commit (git archive wrote it); in a checkout, git is asked.
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
