// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace rumi {

inline constexpr int kMaxSide = 16384;  // pixels; what Camera::check() allows

}  // namespace rumi
