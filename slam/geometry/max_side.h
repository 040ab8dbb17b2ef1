// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace rumi {

// The longest side of an image that Rumi accepts, in pixels. Camera::check() refuses cameras with longer ones.
inline constexpr int kMaxSide = 16384;

}  // namespace rumi
