// SPDX-License-Identifier: BSD-3-Clause
// Serves a page to browsers on this computer by GNU libmicrohttpd, in the thread that calls serve(). Nothing waits for
// a client: for each the server keeps one answer, or, if it listens to events (server-sent events), the newest event of
// each name, however slowly it reads.
#pragma once

#include <cstdint>
#include <functional>
#include <list>
#include <map>
#include <memory>
#include <string>

struct MHD_Connection;
struct MHD_Daemon;

namespace rumi::tool {

struct HttpAnswer {
  int status = 200;
  std::string type = "text/plain; charset=utf-8";
  std::shared_ptr<const std::string> body = {};
  bool events = false;  // the connection stays open, and gets the events
};
HttpAnswer text_answer(int status, const std::string& text);

class HttpServer {
 public:
  static constexpr size_t kMaxConnections = 64, kMaxListeners = 8;
  static constexpr unsigned kPatienceSeconds = 30;  // for a client that neither asks nor reads
  // Answers a GET of this path, which comes without a query ("?...").
  using Answer = std::function<HttpAnswer(const std::string& path)>;

  // Listens on 127.0.0.1; port 0: any free one. Throws std::runtime_error with a message for the user.
  HttpServer(int port, Answer answer, unsigned patience_seconds = kPatienceSeconds);
  ~HttpServer();
  HttpServer(const HttpServer&) = delete;
  HttpServer& operator=(const HttpServer&) = delete;

  int port() const;
  // Waits up to timeout_ms for requests, and does what can be done at once.
  void serve(int timeout_ms);
  // Sends the event to all listeners, now and later. It replaces an earlier event of that name.
  void tell(const std::string& event, const std::string& data);
  size_t listeners() const { return listeners_.size(); }

 private:
  struct Event {
    int64_t number = 0;
    std::string text;
  };
  struct Listener;
  struct Calls;  // what the library calls

  HttpAnswer checked_answer(MHD_Connection* connection, const std::string& path, bool reads);
  void leave_who_is_gone();

  Answer answer_;
  std::list<Listener> listeners_;
  std::map<std::string, Event> events_;
  int64_t last_event_ = 0;
  MHD_Daemon* daemon_ = nullptr;
};

}  // namespace rumi::tool
