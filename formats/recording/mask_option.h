// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace rumi {

inline constexpr const char* kNoMask = "none";  // as camera_driver.mask: not even the one beside the data

}  // namespace rumi
