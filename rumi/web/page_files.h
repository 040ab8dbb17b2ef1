// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>

#include "rumi/web/http_server.h"

namespace rumi::tool {

// Returns the folder of the page for a `rumi` in the folder `bin`, installed or in a build tree.
std::filesystem::path page_folder_of(const std::filesystem::path& bin);

// The files of the page. All are read at the start, so no path from a browser ever reaches the file system.
class PageFiles {
 public:
  // Throws std::runtime_error, which names the file, if one is missing.
  explicit PageFiles(const std::filesystem::path& folder);
  std::optional<HttpAnswer> find(const std::string& path) const;

 private:
  std::map<std::string, HttpAnswer> answers_;  // by path of the request
};

}  // namespace rumi::tool
