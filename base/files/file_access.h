// SPDX-License-Identifier: BSD-3-Clause
// Why a file of the user cannot be read. std::filesystem and streams take what is behind a closed folder for missing.
#pragma once

#include <filesystem>
#include <string>

namespace rumi {

// "no such file or folder", "no permission to read it ...", "no permission to enter the folder ...": for a person, to
// be put behind the name and a colon. Empty if it is there and can be read (a folder: listed and entered).
// `remedy` is added where it is missing.
std::string why_unreadable(const std::filesystem::path& path, const std::string& remedy = {});

// True if something of that name is there, or may be there in a folder that may not be entered: reading it will tell.
bool may_be_there(const std::filesystem::path& path);

// "; /srv belongs to root (uid 0), and this is anna (uid 1000)": to be put behind the reason for which `path` cannot be
// made or written. Of its folder where it is not there. Empty where it belongs to who runs this.
std::string note_on_owner(const std::filesystem::path& path);

}  // namespace rumi
