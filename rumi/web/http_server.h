// SPDX-License-Identifier: BSD-3-Clause
// Serves a page to browsers on this computer, in the thread of whoever calls serve(): nothing waits for a client. What
// is kept for a client is one answer, or for one that listens to events (server-sent events) the newest event of each
// name, however slowly it reads.
#pragma once

#include <cstdint>
#include <functional>
#include <list>
#include <map>
#include <memory>
#include <string>

#include "base/file_descriptor.h"
#include "rumi/web/http_request.h"

namespace rumi::tool {

struct HttpAnswer {
  int status = 200;
  std::string type = "text/plain; charset=utf-8";
  std::shared_ptr<const std::string> body = {};
  bool events = false;  // the connection stays open, and gets what is told
};
HttpAnswer text_answer(int status, const std::string& text);

class HttpServer {
 public:
  static constexpr size_t kMaxConnections = 64, kMaxListeners = 8;
  using Answer = std::function<HttpAnswer(const HttpRequest&)>;

  // On 127.0.0.1; port 0: any that is free. Throws std::runtime_error with a message for the user.
  HttpServer(int port, Answer answer);

  int port() const { return port_; }
  // Waits up to timeout_ms for something to do and does all that can be done at once. steady_us: of a clock that nobody
  // sets.
  void serve(int64_t steady_us, int timeout_ms);
  // To all listeners, now and later; takes the place of the event of that name that was told before.
  void tell(const std::string& event, const std::string& data);
  size_t listeners() const;
  // A client has not been handed all of its answer yet.
  bool is_sending() const;

 private:
  struct Connection {
    FileDescriptor socket;
    std::string in, out;
    std::shared_ptr<const std::string> body;  // sent behind `out`
    size_t sent = 0;                          // of both
    bool listens = false, close_after = false;
    int64_t progress_us = 0;
    std::map<std::string, int64_t> told;  // the number of the event of each name
    size_t pending() const { return out.size() + (body ? body->size() : 0) - sent; }
  };
  struct Event {
    int64_t number = 0;
    std::string text;
  };
  void accept_all(int64_t steady_us);
  // These return false if the connection is to be closed.
  bool step(Connection& connection, bool readable, int64_t steady_us);
  bool receive(Connection& connection, int64_t steady_us);
  bool answer_requests(Connection& connection);
  bool send(Connection& connection, int64_t steady_us);
  void put_events(Connection& connection) const;
  void put(Connection& connection, const HttpAnswer& answer) const;

  Answer answer_;
  int port_ = 0;
  FileDescriptor socket_;  // tells the port
  std::list<Connection> connections_;
  std::map<std::string, Event> events_;
  int64_t last_event_ = 0;
};

}  // namespace rumi::tool
