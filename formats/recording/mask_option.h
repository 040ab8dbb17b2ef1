// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace rumi {

inline constexpr const char* kNoMask = "none";  // for camera_driver.mask: no mask at all, not even one beside the data

}  // namespace rumi
