// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>

namespace rumi {

// Tells what to do with a file that is not read (a recording of a ZED camera, an archive, ...); to be put behind its
// name. Empty: it is no such file.
std::string advice_on_foreign_recording(const std::filesystem::path& path);

// Tells what to do if the input is an address (rtsp://...), a pipe ("-") or a pattern (%05d.jpg, *.jpg) and not the
// name of a file or folder. Empty: it may be a name.
std::string advice_on_input(const std::string& input);

// Says why a file is no video that can be decoded; to be put behind its name. Empty: not known.
std::string why_no_video(const std::filesystem::path& file);

}  // namespace rumi
