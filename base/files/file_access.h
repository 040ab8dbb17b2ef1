// SPDX-License-Identifier: BSD-3-Clause
// Why a file of the user cannot be read. std::filesystem and streams take what is behind a closed folder for missing.
#pragma once

#include <filesystem>
#include <string>

namespace rumi {

// Says, for a person, why the path cannot be read: "no such file or folder", "no permission to read it ...", "no
// permission to enter the folder ..."; to be put behind the name and a colon. Empty if it can be read (a folder: listed
// and entered). `remedy` is appended if it does not exist.
std::string why_unreadable(const std::filesystem::path& path, const std::string& remedy = {});

// True if something of that name is there, or may be there in a folder that may not be entered: reading it will tell.
bool may_be_there(const std::filesystem::path& path);

// Names the owner of `path`, or of its folder if it does not exist: "; /srv belongs to root (uid 0), and this is anna
// (uid 1000)"; to be put behind the reason for which it cannot be written. Empty if it belongs to the user of this
// process.
std::string note_on_owner(const std::filesystem::path& path);

}  // namespace rumi
