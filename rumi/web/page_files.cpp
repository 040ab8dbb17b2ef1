// SPDX-License-Identifier: BSD-3-Clause
#include "rumi/web/page_files.h"

#include <fmt/format.h>

#include <fstream>
#include <sstream>
#include <stdexcept>

namespace rumi::tool {
namespace {

namespace fs = std::filesystem;

constexpr const char* kHtml = "text/html; charset=utf-8";
constexpr const char* kCss = "text/css; charset=utf-8";
constexpr const char* kScript = "text/javascript; charset=utf-8";
constexpr const char* kSvg = "image/svg+xml";

constexpr struct {
  const char *path, *file, *type;
} kFiles[] = {
    {"/", "index.html", kHtml},
    {"/style.css", "style.css", kCss},
    {"/icon.svg", "icon.svg", kSvg},
    {"/main.js", "main.js", kScript},
    {"/map_view.js", "map_view.js", kScript},
    {"/orbit.js", "orbit.js", kScript},
    {"/drawing.js", "drawing.js", kScript},
    {"/submap_blob.js", "submap_blob.js", kScript},
    {"/tables.js", "tables.js", kScript},
    {"/timeline.js", "timeline.js", kScript},
};

std::string read(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::stringstream text;
  text << in.rdbuf();
  if (!in || text.str().empty())
    throw std::runtime_error(
        fmt::format("{}: cannot be read; it is part of what `rumi web` shows: install Rumi again "
                    "(in a build tree: run cmake again)",
                    file.string()));
  return text.str();
}

}  // namespace

fs::path page_folder_of(const fs::path& bin) {
  std::error_code error;
  const fs::path installed = (bin / RUMI_PAGE_FROM_BIN).lexically_normal();
  return fs::is_directory(installed, error) ? installed : bin.parent_path() / "web_page";
}

PageFiles::PageFiles(const fs::path& folder) {
  for (const auto& [path, file, type] : kFiles)
    answers_[path] = {.type = type, .body = std::make_shared<const std::string>(read(folder / file))};
}

std::optional<HttpAnswer> PageFiles::find(const std::string& path) const {
  const auto found = answers_.find(path);
  return found == answers_.end() ? std::nullopt : std::optional(found->second);
}

}  // namespace rumi::tool
