// SPDX-License-Identifier: BSD-3-Clause
#include "rumi/web/http_server.h"

#include <arpa/inet.h>
#include <fmt/format.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <utility>
#include <vector>

#include "base/due.h"

namespace rumi::tool {
namespace {

constexpr int64_t kPatienceUs = 30'000'000;  // with a client that neither asks nor reads
constexpr int kBacklog = 16;
constexpr size_t kReadBytes = 4096;

const char* reason_of(int status) {
  switch (status) {
    case 200:
      return "OK";
    case 400:
      return "Bad Request";
    case 403:
      return "Forbidden";
    case 404:
      return "Not Found";
    case 405:
      return "Method Not Allowed";
    case 413:
      return "Content Too Large";
    case 431:
      return "Request Header Fields Too Large";
    case 503:
      return "Service Unavailable";
    case 505:
      return "HTTP Version Not Supported";
    default:
      return "Error";
  }
}

// The page needs nothing from elsewhere, and nobody else is to show it or to read from it.
constexpr const char* kSecurity =
    "Content-Security-Policy: default-src 'self'; img-src 'self' blob:; base-uri 'none'; form-action 'none'; "
    "frame-ancestors 'none'\r\n"
    "X-Content-Type-Options: nosniff\r\n"
    "X-Frame-Options: DENY\r\n"
    "Referrer-Policy: no-referrer\r\n"
    "Cross-Origin-Resource-Policy: same-origin\r\n"
    "Cross-Origin-Opener-Policy: same-origin\r\n"
    "Cache-Control: no-store\r\n";

std::string explanation(int status) {
  switch (status) {
    case 403:
      return "this page is only for http://localhost and http://127.0.0.1 (the request names another host)";
    case 405:
      return "nothing can be changed here: only GET is answered";
    default:
      return reason_of(status);
  }
}

bool would_block() { return errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR; }

FileDescriptor listen_on(int port, int* bound_port) {
  FileDescriptor socket(::socket(AF_INET, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
  const int on = 1;  // else the port stays taken for a minute after the last run
  if (socket) setsockopt(socket.get(), SOL_SOCKET, SO_REUSEADDR, &on, sizeof(on));
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  address.sin_port = htons(static_cast<uint16_t>(port));
  socklen_t size = sizeof(address);
  auto* const any_address = reinterpret_cast<sockaddr*>(&address);
  if (!socket || bind(socket.get(), any_address, size) != 0 || listen(socket.get(), kBacklog) != 0 ||
      getsockname(socket.get(), any_address, &size) != 0)
    throw std::runtime_error(
        errno == EADDRINUSE
            ? fmt::format("port {} is in use: another `rumi web` perhaps; choose another one with --port", port)
            : fmt::format("port {} on 127.0.0.1 cannot be opened: {}", port, std::strerror(errno)));
  *bound_port = ntohs(address.sin_port);
  return socket;
}

}  // namespace

HttpAnswer text_answer(int status, const std::string& text) {
  return {.status = status, .body = std::make_shared<const std::string>(text + "\n")};
}

HttpServer::HttpServer(int port, Answer answer) : answer_(std::move(answer)), socket_(listen_on(port, &port_)) {}

size_t HttpServer::listeners() const {
  return static_cast<size_t>(
      std::count_if(connections_.begin(), connections_.end(), [](const Connection& c) { return c.listens; }));
}

bool HttpServer::is_sending() const {
  return std::any_of(connections_.begin(), connections_.end(), [](const Connection& c) { return c.pending() > 0; });
}

void HttpServer::tell(const std::string& event, const std::string& data) {
  events_[event] = {++last_event_, fmt::format("event: {}\ndata: {}\n\n", event, data)};
}

void HttpServer::serve(int64_t steady_us, int timeout_ms) {
  std::vector<pollfd> waits{{socket_.get(), POLLIN, 0}};
  for (Connection& connection : connections_) {
    if (connection.listens && connection.pending() == 0) put_events(connection);
    const bool sends = connection.pending() > 0;
    waits.push_back({connection.socket.get(), static_cast<int16_t>(sends ? POLLOUT : POLLIN), 0});
  }
  poll(waits.data(), waits.size(), timeout_ms);
  auto wait = waits.begin() + 1;
  for (auto it = connections_.begin(); it != connections_.end(); ++wait)
    it = step(*it, wait->revents != 0 && wait->events == POLLIN, steady_us) ? std::next(it) : connections_.erase(it);
  if (waits.front().revents != 0) accept_all(steady_us);
  if (listeners() == 0) events_.clear();  // who comes later is to hear nothing that is old
}

void HttpServer::accept_all(int64_t steady_us) {
  for (;;) {
    FileDescriptor socket(accept4(socket_.get(), nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC));
    if (!socket) return;
    const int on = 1;
    setsockopt(socket.get(), IPPROTO_TCP, TCP_NODELAY, &on, sizeof(on));
    Connection connection;
    connection.socket = std::move(socket);
    connection.progress_us = steady_us;
    if (connections_.size() >= kMaxConnections) {
      connection.close_after = true;
      put(connection, text_answer(503, "too many connections: close some pages"));
    }
    // One too many is gone after its answer, or with the next one.
    if (connections_.size() > kMaxConnections) connections_.pop_back();
    connections_.push_back(std::move(connection));
  }
}

bool HttpServer::step(Connection& connection, bool readable, int64_t steady_us) {
  if (readable && !receive(connection, steady_us)) return false;
  if (connection.pending() > 0 && !send(connection, steady_us)) return false;
  const bool may_wait = connection.listens && connection.pending() == 0;
  return may_wait || !is_due(steady_us, connection.progress_us, kPatienceUs);
}

// Once, so that nobody is served without an end; poll() tells again of what is left.
bool HttpServer::receive(Connection& connection, int64_t steady_us) {
  char bytes[kReadBytes];
  const ssize_t n = recv(connection.socket.get(), bytes, sizeof(bytes), 0);
  if (n < 0) return would_block();
  if (n == 0) return false;
  if (connection.listens) return true;  // has nothing more to say
  if (connection.in.empty()) connection.progress_us = steady_us;
  connection.in.append(bytes, static_cast<size_t>(n));
  return answer_requests(connection);
}

bool HttpServer::answer_requests(Connection& connection) {
  HttpRequest request;
  const ReadRequest read = read_request(connection.in, &request);
  if (read.status == 0) return true;
  connection.in.erase(0, read.bytes);
  connection.close_after = read.status != 200 || !request.keep_alive;
  HttpAnswer answer = read.status == 200 ? answer_(request) : text_answer(read.status, explanation(read.status));
  if (answer.events && listeners() >= kMaxListeners)
    answer = text_answer(503, fmt::format("{} pages are open already, which is the most", kMaxListeners));
  put(connection, answer);
  if (answer.events) put_events(connection);
  return true;
}

void HttpServer::put(Connection& connection, const HttpAnswer& answer) const {
  connection.out = fmt::format("HTTP/1.1 {} {}\r\nContent-Type: {}\r\n{}", answer.status, reason_of(answer.status),
                               answer.type, kSecurity);
  if (answer.status == 405) connection.out += "Allow: GET\r\n";
  if (!answer.events) connection.out += fmt::format("Content-Length: {}\r\n", answer.body ? answer.body->size() : 0);
  connection.out += connection.close_after || answer.events ? "Connection: close\r\n\r\n" : "\r\n";
  connection.body = answer.body;
  connection.sent = 0;
  connection.listens = answer.events;
  connection.close_after = connection.close_after && !answer.events;
}

void HttpServer::put_events(Connection& connection) const {
  for (const auto& [name, event] : events_)
    if (std::exchange(connection.told[name], event.number) != event.number) connection.out += event.text;
}

bool HttpServer::send(Connection& connection, int64_t steady_us) {
  while (connection.pending() > 0) {
    const bool in_head = connection.sent < connection.out.size();
    const std::string& part = in_head ? connection.out : *connection.body;
    const size_t from = in_head ? connection.sent : connection.sent - connection.out.size();
    const ssize_t n = ::send(connection.socket.get(), part.data() + from, part.size() - from, MSG_NOSIGNAL);
    if (n < 0) return would_block();
    connection.sent += static_cast<size_t>(n);
    connection.progress_us = steady_us;
  }
  connection.out.clear();
  connection.body.reset();
  connection.sent = 0;
  if (connection.close_after) return false;
  // What was asked for meanwhile.
  return connection.listens || connection.in.empty() || answer_requests(connection);
}

}  // namespace rumi::tool
