// SPDX-License-Identifier: BSD-3-Clause
// A web page in one file, which loads nothing else.
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace rumi::tool {

std::string base64(std::span<const uint8_t> bytes);
// Escapes the text for HTML, also for use inside attributes.
std::string escape_html(const std::string& text);

class HtmlPage {
 public:
  explicit HtmlPage(const std::string& title);

  // All functions escape their text. `note` may be empty.
  void section(const std::string& heading, const std::string& note = "");
  void paragraph(const std::string& text);
  void table(const std::vector<std::string>& header, const std::vector<std::vector<std::string>>& rows);
  // format: "png" or "jpeg". The caption is also the alternative text.
  void picture(std::span<const uint8_t> image, const std::string& format, const std::string& caption);
  struct Thumbnail {
    std::vector<uint8_t> jpeg;
    std::string caption, color;  // color: of the frame around the image, in CSS
  };
  void thumbnails(const std::vector<Thumbnail>& images);
  // Lines of values over seconds. Both axes begin at 0.
  using Lines = std::map<std::string, std::vector<std::pair<double, double>>>;
  void chart(const std::string& title, const std::string& unit, const Lines& lines);
  std::string finish() const;

 private:
  std::string title_, body_;
};

}  // namespace rumi::tool
