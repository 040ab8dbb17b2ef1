// SPDX-License-Identifier: BSD-3-Clause
// A client that reads only when it is told to. It lives in the server's thread, so its functions that wait also serve.
#pragma once

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>

#include <string>

#include "base/files/file_descriptor.h"
#include "rumi/web/http_server.h"
#include "tests/support/patience.h"

namespace rumi::tool {

class HttpClient {
 public:
  explicit HttpClient(HttpServer& server, int receive_buffer = 0)
      : server_(server), socket_(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    if (receive_buffer > 0) setsockopt(socket_.get(), SOL_SOCKET, SO_RCVBUF, &receive_buffer, sizeof(receive_buffer));
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    address.sin_port = htons(static_cast<uint16_t>(server.port()));
    EXPECT_EQ(connect(socket_.get(), reinterpret_cast<sockaddr*>(&address), sizeof(address)), 0);
  }

  void say(const std::string& text) {
    EXPECT_EQ(send(socket_.get(), text.data(), text.size(), MSG_NOSIGNAL), static_cast<ssize_t>(text.size()));
  }
  void get(const std::string& path) { say("GET " + path + " HTTP/1.1\r\nHost: localhost\r\n\r\n"); }

  void read_what_is_there() {
    char bytes[65536];
    ssize_t n = 0;
    while ((n = recv(socket_.get(), bytes, sizeof(bytes), MSG_DONTWAIT)) > 0)
      heard_.append(bytes, static_cast<size_t>(n));
    closed_ |= n == 0 || (n < 0 && errno != EAGAIN);
  }
  // Serves and reads until `text` has come. False if it does not come.
  bool hears(const std::string& text) {
    return testing::happens([&] { return heard_.find(text) != std::string::npos; }, [&] { step(); });
  }
  bool is_closed() {
    return testing::happens([&] { return closed_; }, [&] { step(); });
  }
  // Returns all that came since the last call.
  std::string take() { return std::exchange(heard_, {}); }
  const std::string& heard() const { return heard_; }
  void step() {
    server_.serve(0);
    read_what_is_there();
  }
  bool closed() const { return closed_; }

 private:
  HttpServer& server_;
  FileDescriptor socket_;
  std::string heard_;
  bool closed_ = false;
};

}  // namespace rumi::tool
