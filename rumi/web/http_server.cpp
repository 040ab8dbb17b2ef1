// SPDX-License-Identifier: BSD-3-Clause
#include "rumi/web/http_server.h"

#include <arpa/inet.h>
#include <fmt/format.h>
#include <microhttpd.h>
#include <netinet/in.h>
#include <poll.h>
#include <strings.h>

#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <string_view>
#include <utility>
#include <vector>

namespace rumi::tool {
namespace {

// Connections beyond kMaxConnections that get an answer: that there are too many. Others wait to be accepted.
constexpr unsigned kMoreConnections = 16;
constexpr size_t kEventBlockBytes = 65536;

// The page needs nothing from other servers. No other page may show it or read from it.
constexpr std::pair<const char*, const char*> kHeaders[] = {
    {"Content-Security-Policy",
     "default-src 'self'; img-src 'self' blob:; base-uri 'none'; form-action 'none'; frame-ancestors 'none'"},
    {"X-Content-Type-Options", "nosniff"},
    {"X-Frame-Options", "DENY"},
    {"Referrer-Policy", "no-referrer"},
    {"Cross-Origin-Resource-Policy", "same-origin"},
    {"Cross-Origin-Opener-Policy", "same-origin"},
    {"Cache-Control", "no-store"},
};

// True if the header Host names this computer: "localhost:8642", "[::1]:8642". Any port is accepted, because it may be
// forwarded, for example by `ssh -L`.
bool is_this_computer(std::string_view host) {
  const size_t colon = host.rfind(':');
  const bool has_port = colon != std::string_view::npos && host.find(']', colon) == std::string_view::npos;
  const std::string name(has_port ? host.substr(0, colon) : host);
  return strcasecmp(name.c_str(), "localhost") == 0 || name == "127.0.0.1" || name == "[::1]";
}

// True if the request names this computer. The page of another site can reach this port by a name that its DNS resolves
// to 127.0.0.1, but the header Host has the name that was used.
bool is_for_this_computer(MHD_Connection* connection) {
  std::vector<std::string> hosts;
  const auto note = [](void* found, MHD_ValueKind, const char* name, const char* value) {
    if (strcasecmp(name, "Host") == 0) static_cast<std::vector<std::string>*>(found)->emplace_back(value ? value : "");
    return MHD_YES;
  };
  MHD_get_connection_values(connection, MHD_HEADER_KIND, note, &hosts);
  return hosts.size() == 1 && is_this_computer(hosts.front());
}

// The answer shares the body and does not copy it. libmicrohttpd does not write to it.
MHD_Response* response_of(const std::shared_ptr<const std::string>& body) {
  auto* const kept = new std::shared_ptr<const std::string>(body ? body : std::make_shared<const std::string>());
  return MHD_create_response_from_buffer_with_free_callback_cls(
      (*kept)->size(), const_cast<char*>((*kept)->data()),
      [](void* p) { delete static_cast<std::shared_ptr<const std::string>*>(p); }, kept);
}

}  // namespace

HttpAnswer text_answer(int status, const std::string& text) {
  return {.status = status, .body = std::make_shared<const std::string>(text + "\n")};
}

struct HttpServer::Listener {
  HttpServer* server;
  MHD_Connection* connection;
  std::map<std::string, int64_t> told = {};  // by name of the event: number of the latest one that was put into `out`
  std::string out = {};
  size_t sent = 0;  // bytes of `out` that were sent
  bool waits = false, gone = false;

  void go_on() {
    if (std::exchange(waits, false)) MHD_resume_connection(connection);
  }
  ssize_t put(char* to, size_t size) {
    if (gone) return MHD_CONTENT_READER_END_OF_STREAM;
    if (sent == out.size()) take_events();
    const size_t n = out.copy(to, size, sent);
    sent += n;
    if (n == 0) {
      waits = true;
      MHD_suspend_connection(connection);
    }
    return static_cast<ssize_t>(n);
  }
  void take_events() {
    out.clear();
    sent = 0;
    for (const auto& [name, event] : server->events_)
      if (std::exchange(told[name], event.number) != event.number) out += event.text;
  }
};

struct HttpServer::Calls {
  // Called when the head of a request has arrived, for each part of its body, and when the request is complete.
  static MHD_Result on_request(void* self, MHD_Connection* connection, const char* path, const char* method,
                               const char*, const char*, size_t* body_bytes, void** state) {
    if (*body_bytes > 0) return MHD_NO;  // closes the connection of a request that has a body
    const bool has_begun = std::exchange(*state, self) == nullptr;
    const bool reads = std::strcmp(method, "GET") == 0 || std::strcmp(method, "HEAD") == 0;
    if (has_begun && reads) return MHD_YES;
    auto* const server = static_cast<HttpServer*>(self);
    try {
      return answer(*server, connection, server->checked_answer(connection, path, reads));
    } catch (const std::exception& e) {  // exceptions must not pass through the C library
      return answer(*server, connection, text_answer(MHD_HTTP_INTERNAL_SERVER_ERROR, e.what()));
    }
  }

  static MHD_Result answer(HttpServer& server, MHD_Connection* connection, const HttpAnswer& answer) {
    MHD_Response* const response = answer.events ? events_response(server, connection) : response_of(answer.body);
    if (!response) return MHD_NO;
    for (const auto& [name, value] : kHeaders) MHD_add_response_header(response, name, value);
    MHD_add_response_header(response, MHD_HTTP_HEADER_CONTENT_TYPE, answer.type.c_str());
    if (answer.status == MHD_HTTP_METHOD_NOT_ALLOWED)
      MHD_add_response_header(response, MHD_HTTP_HEADER_ALLOW, "GET, HEAD");
    if (answer.status != MHD_HTTP_OK && answer.status != MHD_HTTP_NOT_FOUND)
      MHD_add_response_header(response, MHD_HTTP_HEADER_CONNECTION, "close");
    const MHD_Result result = MHD_queue_response(connection, static_cast<unsigned>(answer.status), response);
    MHD_destroy_response(response);  // the connection has its own reference
    return result;
  }

  static MHD_Response* events_response(HttpServer& server, MHD_Connection* connection) {
    Listener& listener = server.listeners_.emplace_back(Listener{.server = &server, .connection = connection});
    MHD_Response* const response = MHD_create_response_from_callback(
        MHD_SIZE_UNKNOWN, kEventBlockBytes,
        [](void* one, uint64_t, char* to, size_t size) { return static_cast<Listener*>(one)->put(to, size); },
        &listener,
        [](void* one) {
          std::list<Listener>& all = static_cast<Listener*>(one)->server->listeners_;
          all.remove_if([&](const Listener& each) { return &each == one; });
        });
    if (response) MHD_set_response_options(response, MHD_RF_HTTP_1_0_COMPATIBLE_STRICT, MHD_RO_END);  // not in chunks
    return response;
  }
};

HttpServer::HttpServer(int port, Answer answer, unsigned patience_seconds) : answer_(std::move(answer)) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  address.sin_port = htons(static_cast<uint16_t>(port));
  errno = 0;
  daemon_ = MHD_start_daemon(MHD_USE_EPOLL | MHD_ALLOW_SUSPEND_RESUME, static_cast<uint16_t>(port), nullptr, nullptr,
                             Calls::on_request, this, MHD_OPTION_SOCK_ADDR, reinterpret_cast<sockaddr*>(&address),
                             MHD_OPTION_CONNECTION_LIMIT, static_cast<unsigned>(kMaxConnections) + kMoreConnections,
                             MHD_OPTION_CONNECTION_TIMEOUT, patience_seconds, MHD_OPTION_END);
  if (!daemon_)
    throw std::runtime_error(
        errno == EADDRINUSE
            ? fmt::format("port {} is in use: another `rumi web` perhaps; choose another one with --port", port)
            : fmt::format("port {} on 127.0.0.1 cannot be opened: {}", port, std::strerror(errno)));
}

HttpServer::~HttpServer() {
  for (Listener& listener : listeners_) listener.go_on();  // the library aborts if a connection is suspended
  MHD_stop_daemon(daemon_);
}

int HttpServer::port() const { return MHD_get_daemon_info(daemon_, MHD_DAEMON_INFO_BIND_PORT)->port; }

void HttpServer::tell(const std::string& event, const std::string& data) {
  events_[event] = {++last_event_, fmt::format("event: {}\ndata: {}\n\n", event, data)};
  for (Listener& listener : listeners_) listener.go_on();
}

void HttpServer::serve(int timeout_ms) {
  leave_who_is_gone();
  MHD_run_wait(daemon_, timeout_ms);
  if (listeners_.empty()) events_.clear();  // a new listener must not hear an old event
}

// Ends the connections of clients that are gone. libmicrohttpd does not look at suspended connections.
void HttpServer::leave_who_is_gone() {
  for (Listener& listener : listeners_) {
    const auto* info = MHD_get_connection_info(listener.connection, MHD_CONNECTION_INFO_CONNECTION_FD);
    pollfd socket{info->connect_fd, POLLRDHUP, 0};
    if (poll(&socket, 1, 0) <= 0) continue;
    listener.gone = true;
    listener.go_on();
  }
}

HttpAnswer HttpServer::checked_answer(MHD_Connection* connection, const std::string& path, bool reads) {
  if (!reads) return text_answer(MHD_HTTP_METHOD_NOT_ALLOWED, "nothing can be changed here: only GET is answered");
  if (!is_for_this_computer(connection))
    return text_answer(MHD_HTTP_FORBIDDEN,
                       "this page is only for http://localhost and http://127.0.0.1 (the request names another host)");
  if (MHD_get_daemon_info(daemon_, MHD_DAEMON_INFO_CURRENT_CONNECTIONS)->num_connections > kMaxConnections)
    return text_answer(MHD_HTTP_SERVICE_UNAVAILABLE, "too many connections: close some pages");
  HttpAnswer answer = answer_(path);
  if (answer.events && listeners_.size() >= kMaxListeners)
    answer = text_answer(MHD_HTTP_SERVICE_UNAVAILABLE,
                         fmt::format("{} pages are open already, which is the most", kMaxListeners));
  return answer;
}

}  // namespace rumi::tool
