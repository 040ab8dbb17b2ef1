// SPDX-License-Identifier: BSD-3-Clause
#include "rumi/web/http_request.h"

#include <algorithm>
#include <cctype>

namespace rumi::tool {
namespace {

std::string lower(std::string_view text) {
  std::string out(text);
  std::transform(out.begin(), out.end(), out.begin(), [](unsigned char c) { return std::tolower(c); });
  return out;
}

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && (text.front() == ' ' || text.front() == '\t')) text.remove_prefix(1);
  while (!text.empty() && (text.back() == ' ' || text.back() == '\t')) text.remove_suffix(1);
  return text;
}

// Of "localhost:8642" or "[::1]:8642". Any port: it may be forwarded, as by `ssh -L`.
bool is_this_computer(std::string_view host) {
  const size_t colon = host.rfind(':');
  const bool has_port = colon != std::string_view::npos && host.find(']', colon) == std::string_view::npos;
  const std::string name = lower(has_port ? host.substr(0, colon) : host);
  return name == "localhost" || name == "127.0.0.1" || name == "[::1]";
}

struct Headers {
  int hosts = 0;
  bool local = false, body = false, close = false;
};

// False for a line that is no header.
bool read_header(std::string_view line, Headers* headers) {
  const size_t colon = line.find(':');
  if (colon == std::string_view::npos || colon == 0 || line.front() == ' ' || line.front() == '\t') return false;
  const std::string name = lower(line.substr(0, colon));
  const std::string_view value = trimmed(line.substr(colon + 1));
  if (name == "host") {
    ++headers->hosts;
    headers->local = is_this_computer(value);
  } else if (name == "content-length") {
    headers->body |= value != "0";
  } else if (name == "transfer-encoding") {
    headers->body = true;
  } else if (name == "connection") {
    headers->close |= lower(value).find("close") != std::string::npos;
  }
  return true;
}

// "GET /path HTTP/1.1". Returns the status that it deserves.
int read_first_line(std::string_view line, HttpRequest* request) {
  const size_t first = line.find(' '), last = line.rfind(' ');
  if (first == std::string_view::npos || first == last) return 400;
  const std::string_view target = line.substr(first + 1, last - first - 1), version = line.substr(last + 1);
  if (version != "HTTP/1.1" && version != "HTTP/1.0") return version.starts_with("HTTP/") ? 505 : 400;
  if (target.empty() || target.front() != '/' || target.find(' ') != std::string_view::npos) return 400;
  if (line.substr(0, first) != "GET") return 405;
  request->path = target.substr(0, target.find('?'));
  request->keep_alive = version == "HTTP/1.1";
  return 200;
}

}  // namespace

ReadRequest read_request(std::string_view text, HttpRequest* request) {
  constexpr std::string_view kEnd = "\r\n\r\n", kLineEnd = "\r\n";
  const size_t end = text.substr(0, kMaxHeadBytes).find(kEnd);
  if (end == std::string_view::npos) return {text.size() >= kMaxHeadBytes ? 431 : 0, 0};
  std::string_view head = text.substr(0, end + kLineEnd.size());
  const auto next_line = [&] {
    const size_t stop = head.find(kLineEnd);
    const std::string_view line = head.substr(0, stop);
    head.remove_prefix(stop + kLineEnd.size());
    return line;
  };
  const int status = read_first_line(next_line(), request);
  if (status != 200) return {status, 0};
  Headers headers;
  while (!head.empty())
    if (!read_header(next_line(), &headers)) return {400, 0};
  if (headers.hosts != 1) return {400, 0};
  if (!headers.local) return {403, 0};
  if (headers.body) return {413, 0};
  request->keep_alive = request->keep_alive && !headers.close;
  return {200, end + kEnd.size()};
}

}  // namespace rumi::tool
