// SPDX-License-Identifier: BSD-3-Clause
// Says why a file that the user named cannot be read. std::filesystem and streams report a file as missing if there is
// no permission to enter its folder.
#pragma once

#include <filesystem>
#include <string>

namespace rumi {

// Returns why the path cannot be read, to be put behind its name and a colon: "no such file or folder", "no permission
// to read it ...", "no permission to enter the folder ...". Returns an empty string if it can be read (a folder: listed
// and entered). `remedy` is appended if the path does not exist.
std::string why_unreadable(const std::filesystem::path& path, const std::string& remedy = {});

// True if the path exists, or may exist in a folder that this process has no permission to enter: then reading it tells
// the reason.
bool may_be_there(const std::filesystem::path& path);

// Returns a note on the owner of `path` (of its folder if it does not exist), to be put behind the reason why it cannot
// be written: "; /srv belongs to root (uid 0), and this is anna (uid 1000)". Returns an empty string if the owner is
// the user of this process, or cannot be found out.
std::string note_on_owner(const std::filesystem::path& path);

}  // namespace rumi
