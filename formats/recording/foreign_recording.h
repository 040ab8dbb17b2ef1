// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>

namespace rumi {

// What to do with a file of another system that is not read (of a ZED camera, an archive, ...), after its name; empty:
// it is none of these.
std::string advice_on_foreign_recording(const std::filesystem::path& path);

// What to do where the input is no name of a file or folder, but an address (rtsp://...), a pipe ("-") or a pattern
// (%05d.jpg, *.jpg); empty: it may be a name.
std::string advice_on_input(const std::string& input);

// After the name of a file that is no video that can be decoded: why not; empty: not known.
std::string why_no_video(const std::filesystem::path& file);

}  // namespace rumi
