// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace rumi {

// Pixels: the longest side of an image that any part of Rumi takes. Camera::check() refuses cameras with longer ones.
inline constexpr int kMaxSide = 16384;

}  // namespace rumi
