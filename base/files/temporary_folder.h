// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>

namespace rumi {

// A new folder, which goes, with all that is in it, when this ends.
class TemporaryFolder {
 public:
  // Creates the folder in `parent`; its name begins with `prefix`. Throws std::runtime_error if it cannot be made.
  TemporaryFolder(const std::filesystem::path& parent, const std::string& prefix);
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  const std::string& path() const { return path_; }

 private:
  std::string path_;
};

}  // namespace rumi
