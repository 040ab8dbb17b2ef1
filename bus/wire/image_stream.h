// SPDX-License-Identifier: BSD-3-Clause
// Tells which camera or recording an image comes from; its time alone does not (docs/wire.md, "Names of things").
#pragma once

#include <cstdint>

#include "lcmtypes/rumi/image_t.hpp"

namespace rumi {

// Key in the image's metadata. The value is a decimal number above 0.
inline constexpr const char* kStreamKey = "stream";

inline constexpr int64_t kNoStream = 0;

// Returns the image's stream; kNoStream if it names no stream, or an impossible one.
int64_t stream_of(const image_t& image);
void set_stream(int64_t stream, image_t* image);

}  // namespace rumi
