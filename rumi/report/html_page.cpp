// SPDX-License-Identifier: BSD-3-Clause
#include "rumi/report/html_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

namespace rumi::tool {
namespace {

const char* const kStyle = R"(
body{font:15px/1.45 system-ui,"DejaVu Sans",sans-serif;color:#28282c;background:#f6f6f3;max-width:1280px;margin:24px auto;padding:0 16px}
h1{font-size:26px;margin:0 0 4px} h2{font-size:19px;margin:34px 0 6px;border-bottom:1px solid #d6d6d2;padding-bottom:3px}
p{margin:6px 0} .note{color:#6e6e76}
img{max-width:100%;border:1px solid #d6d6d2;background:#fff}
figure{margin:10px 0} figcaption{color:#6e6e76;font-size:13px}
.thumbnails{display:flex;flex-wrap:wrap;gap:8px;margin:8px 0 14px} .thumbnails figure{margin:0;width:150px}
.thumbnails img{width:100%;border:4px solid;box-sizing:border-box;display:block}
table{border-collapse:collapse;margin:8px 0;background:#fff} th,td{border:1px solid #d6d6d2;padding:3px 9px;text-align:left;vertical-align:top}
th{background:#ececE8;font-weight:600} td{font-variant-numeric:tabular-nums}
)";

std::string data_url(std::span<const uint8_t> image, const std::string& format) {
  return fmt::format("data:image/{};base64,{}", format, base64(image));
}

}  // namespace

std::string base64(std::span<const uint8_t> bytes) {
  static const char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (size_t i = 0; i < bytes.size(); i += 3) {
    const size_t n = std::min<size_t>(3, bytes.size() - i);
    uint32_t bits = 0;
    for (size_t k = 0; k < 3; ++k) bits = bits << 8 | (k < n ? bytes[i + k] : 0u);
    for (size_t k = 0; k < 4; ++k) text += k <= n ? kDigits[bits >> (18 - 6 * k) & 63] : '=';
  }
  return text;
}

std::string escape_html(const std::string& text) {
  std::string escaped;
  for (const char c : text) {
    switch (c) {
      case '&':
        escaped += "&amp;";
        break;
      case '<':
        escaped += "&lt;";
        break;
      case '>':
        escaped += "&gt;";
        break;
      case '"':
        escaped += "&quot;";
        break;
      case '\'':
        escaped += "&#39;";
        break;
      default:
        escaped += c;
    }
  }
  return escaped;
}

HtmlPage::HtmlPage(const std::string& title) : title_(escape_html(title)) {}

void HtmlPage::section(const std::string& heading, const std::string& note) {
  body_ += fmt::format("<h2>{}</h2>\n", escape_html(heading));
  if (!note.empty()) body_ += fmt::format("<p class=\"note\">{}</p>\n", escape_html(note));
}

void HtmlPage::paragraph(const std::string& text) { body_ += fmt::format("<p>{}</p>\n", escape_html(text)); }

void HtmlPage::table(const std::vector<std::string>& header, const std::vector<std::vector<std::string>>& rows) {
  body_ += "<table>";
  const auto row = [&](const std::vector<std::string>& cells, const char* tag) {
    body_ += "<tr>";
    for (const std::string& cell : cells) body_ += fmt::format("<{0}>{1}</{0}>", tag, escape_html(cell));
    body_ += "</tr>\n";
  };
  if (!header.empty()) row(header, "th");
  for (const auto& cells : rows) row(cells, "td");
  body_ += "</table>\n";
}

void HtmlPage::picture(std::span<const uint8_t> image, const std::string& format, const std::string& caption) {
  body_ += fmt::format("<figure><img alt=\"{0}\" src=\"{1}\"><figcaption>{0}</figcaption></figure>\n",
                       escape_html(caption), data_url(image, format));
}

void HtmlPage::thumbnails(const std::vector<Thumbnail>& images) {
  body_ += "<div class=\"thumbnails\">\n";
  for (const Thumbnail& image : images)
    body_ += fmt::format(
        "<figure><img alt=\"{0}\" style=\"border-color:{1}\" src=\"{2}\"><figcaption>{0}</figcaption></figure>\n",
        escape_html(image.caption), escape_html(image.color), data_url(image.jpeg, "jpeg"));
  body_ += "</div>\n";
}

void HtmlPage::chart(const std::string& title, const std::string& unit, const Lines& lines) {
  static const char* const kColors[] = {"#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#28282c"};
  constexpr double kLeft = 60, kTop = 34, kWidth = 1120, kHeight = 180;
  double end_s = 1e-9, highest = 1e-9;
  for (const auto& [name, points] : lines)
    for (const auto& [at_s, value] : points) {
      end_s = std::max(end_s, at_s);
      highest = std::max(highest, value);
    }
  std::string svg =
      fmt::format("<svg viewBox=\"0 0 1200 240\" width=\"100%\" font-size=\"12\"><text x=\"0\" y=\"14\">{}, {}</text>",
                  escape_html(title), escape_html(unit));
  for (int quarter = 0; quarter <= 4; ++quarter) {
    const double y = kTop + kHeight * (1 - quarter / 4.0), x = kLeft + kWidth * quarter / 4.0;
    svg += fmt::format(
        "<path d=\"M{:.1f} {:.1f}h{:.1f}\" stroke=\"#d6d6d2\"/><text x=\"{:.1f}\" y=\"{:.1f}\" "
        "text-anchor=\"end\">{:.3g}</text>"
        "<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"middle\">{:.4g} s</text>",
        kLeft, y, kWidth, kLeft - 6, y + 4, highest * quarter / 4, x, kTop + kHeight + 18, end_s * quarter / 4);
  }
  size_t number = 0;
  for (const auto& [name, points] : lines) {
    const char* color = kColors[number % std::size(kColors)];
    std::string path;
    for (const auto& [at_s, value] : points)
      path += fmt::format("{}{:.1f} {:.1f}", path.empty() ? "M" : "L", kLeft + kWidth * at_s / end_s,
                          kTop + kHeight * (1 - value / highest));
    svg += fmt::format(
        "<path d=\"{0}\" fill=\"none\" stroke=\"{1}\" stroke-width=\"1.5\"/><text x=\"{2}\" y=\"14\" "
        "fill=\"{1}\">{3}</text>",
        path, color, 240 + 150 * number, escape_html(name));
    ++number;
  }
  body_ += svg + "</svg>\n";
}

std::string HtmlPage::finish() const {
  return fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<title>{0}</title>\n<style>{1}</style>\n"
      "</head>\n<body>\n<h1>{0}</h1>\n{2}</body>\n</html>\n",
      title_, kStyle, body_);
}

}  // namespace rumi::tool
