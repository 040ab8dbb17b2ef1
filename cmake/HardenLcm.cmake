# SPDX-License-Identifier: BSD-3-Clause
# lcm-gen 1.3 trusts the lengths in a message: `v.resize(n)` with a hostile n throws or exhausts memory before the
# truncation is noticed, and a string of length 0 reads npos bytes. Every element takes at least one byte on the wire, so
# a length beyond the bytes that are left is a broken message; the generated decoders are made to say so.
file(GLOB headers ${DIR}/*.hpp)
foreach(header ${headers})
  file(READ ${header} text)
  string(REGEX REPLACE "(this->[^\n;]*)\\.resize\\((this->[A-Za-z0-9_]+)\\);"
         "if (\\2 < 0 || \\2 > maxlen - pos) return -1; \\1.resize(\\2);" text "${text}")
  string(REGEX REPLACE "if\\((__[A-Za-z0-9_]*len_*) > maxlen - pos\\) return -1;"
         "if (\\1 < 1 || \\1 > maxlen - pos) return -1;" text "${text}")
  file(WRITE ${header} "${text}")
endforeach()
