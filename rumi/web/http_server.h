// SPDX-License-Identifier: BSD-3-Clause
// Serves a page to browsers on this computer with GNU libmicrohttpd, in the thread that calls serve(). A slow client
// never makes others wait: for each client the server keeps one answer, or, if the client listens to events
// (server-sent events), the newest event of each name.
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
  bool events = false;  // the connection stays open and gets the events of tell()
};
HttpAnswer text_answer(int status, const std::string& text);

class HttpServer {
 public:
  static constexpr size_t kMaxConnections = 64, kMaxListeners = 8;
  static constexpr unsigned kPatienceSeconds = 30;  // then a client that neither asks nor reads is cut off
  // Returns the answer to a GET of this path, which has no query ("?...").
  using Answer = std::function<HttpAnswer(const std::string& path)>;

  // Listens on 127.0.0.1. port 0: any free port. Throws std::runtime_error with a message for the user.
  HttpServer(int port, Answer answer, unsigned patience_seconds = kPatienceSeconds);
  ~HttpServer();
  HttpServer(const HttpServer&) = delete;
  HttpServer& operator=(const HttpServer&) = delete;

  int port() const;
  // Waits up to timeout_ms for requests, and does what can be done without waiting for a client.
  void serve(int timeout_ms);
  // Sends the event to all listeners. It replaces an earlier event of this name. A client that begins to listen while
  // others do gets the newest event of each name.
  void tell(const std::string& event, const std::string& data);
  size_t listeners() const { return listeners_.size(); }

 private:
  struct Event {
    int64_t number = 0;
    std::string text;
  };
  struct Listener;
  struct Calls;  // callbacks for the library

  HttpAnswer checked_answer(MHD_Connection* connection, const std::string& path, bool reads);
  void leave_who_is_gone();

  Answer answer_;
  std::list<Listener> listeners_;
  std::map<std::string, Event> events_;
  int64_t last_event_ = 0;
  MHD_Daemon* daemon_ = nullptr;
};

}  // namespace rumi::tool
