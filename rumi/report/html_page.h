// SPDX-License-Identifier: BSD-3-Clause
// A web page in one file, which fetches nothing.
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace rumi::tool {

std::string base64(std::span<const uint8_t> bytes);
// The text escaped for HTML, also inside attributes.
std::string escape_html(const std::string& text);

class HtmlPage {
 public:
  explicit HtmlPage(const std::string& title);

  // All text is escaped here. `note` may be empty.
  void section(const std::string& heading, const std::string& note = "");
  void paragraph(const std::string& text);
  void table(const std::vector<std::string>& header, const std::vector<std::vector<std::string>>& rows);
  // format: "png" or "jpeg". The alternative text is the caption too.
  void picture(std::span<const uint8_t> image, const std::string& format, const std::string& caption);
  struct Thumbnail {
    std::vector<uint8_t> jpeg;
    std::string caption, color;  // of the frame around it, as CSS has it
  };
  void thumbnails(const std::vector<Thumbnail>& images);
  // Lines over seconds, from 0 upwards.
  using Lines = std::map<std::string, std::vector<std::pair<double, double>>>;
  void chart(const std::string& title, const std::string& unit, const Lines& lines);
  std::string finish() const;

 private:
  std::string title_, body_;
};

}  // namespace rumi::tool
