// SPDX-License-Identifier: BSD-3-Clause
#include "rumi/web/http_request.h"

#include <gtest/gtest.h>

namespace rumi::tool {
namespace {

const std::string kGood = "GET /a/b?c=1 HTTP/1.1\r\nHost: localhost:8642\r\nAccept: */*\r\n\r\n";

ReadRequest read(const std::string& text, HttpRequest* request = nullptr) {
  HttpRequest ignored;
  return read_request(text, request ? request : &ignored);
}
int status_of(const std::string& text) { return read(text).status; }
std::string with_host(const std::string& host) { return "GET / HTTP/1.1\r\nHost: " + host + "\r\n\r\n"; }

TEST(HttpRequest, IsReadWhole) {
  HttpRequest request;
  const ReadRequest done = read(kGood + "GET /next", &request);
  EXPECT_EQ(done.status, 200);
  EXPECT_EQ(done.bytes, kGood.size());
  EXPECT_EQ(request.path, "/a/b");
  EXPECT_TRUE(request.keep_alive);
  for (size_t n = 0; n < kGood.size(); ++n) EXPECT_EQ(status_of(kGood.substr(0, n)), 0) << n;
}

TEST(HttpRequest, SaysWhetherTheConnectionGoesOn) {
  HttpRequest request;
  EXPECT_EQ(read("GET / HTTP/1.1\r\nhost: localhost\r\nConnection: Close\r\n\r\n", &request).status, 200);
  EXPECT_FALSE(request.keep_alive);
  EXPECT_EQ(read("GET / HTTP/1.0\r\nHost: localhost\r\n\r\n", &request).status, 200);
  EXPECT_FALSE(request.keep_alive);
}

TEST(HttpRequest, OnlyGetWithoutABody) {
  for (const std::string method : {"POST", "PUT", "DELETE", "HEAD", "OPTIONS", "get", "CONNECT"})
    EXPECT_EQ(status_of(method + " / HTTP/1.1\r\nHost: localhost\r\n\r\n"), 405) << method;
  EXPECT_EQ(status_of("GET / HTTP/1.1\r\nHost: localhost\r\nContent-Length: 5\r\n\r\nhello"), 413);
  EXPECT_EQ(status_of("GET / HTTP/1.1\r\nHost: localhost\r\nTransfer-Encoding: chunked\r\n\r\n"), 413);
  EXPECT_EQ(status_of("GET / HTTP/1.1\r\nHost: localhost\r\nContent-Length: 0\r\n\r\n"), 200);
}

// A page of somebody else may reach this port by a name of its own that it lets point to 127.0.0.1.
TEST(HttpRequest, OnlyByTheNamesOfThisComputer) {
  for (const char* host :
       {"localhost", "localhost:8642", "LocalHost:1", "127.0.0.1", "127.0.0.1:9000", "[::1]", "[::1]:80"})
    EXPECT_EQ(status_of(with_host(host)), 200) << host;
  for (const char* host : {"", "evil.example", "evil.example:8642", "localhost.evil.example", "127.0.0.1.evil.example",
                           "192.168.1.5:8642", "evil.example localhost", "localhost@evil.example", "::1"})
    EXPECT_EQ(status_of(with_host(host)), 403) << host;
  EXPECT_EQ(status_of("GET / HTTP/1.1\r\nAccept: */*\r\n\r\n"), 400) << "none";
  EXPECT_EQ(status_of("GET / HTTP/1.1\r\nHost: localhost\r\nHost: evil.example\r\n\r\n"), 400) << "two";
}

TEST(HttpRequest, WhatIsNoneIsRefused) {
  for (const char* line : {"", "GET", "GET /", "GET  HTTP/1.1", "GET a HTTP/1.1", "GET http://localhost/ HTTP/1.1",
                           "GET / b HTTP/1.1", "\x16\x03\x01", "GET / SPDY/3"})
    EXPECT_EQ(status_of(std::string(line) + "\r\nHost: localhost\r\n\r\n"), 400) << line;
  EXPECT_EQ(status_of("GET / HTTP/3.0\r\nHost: localhost\r\n\r\n"), 505);
  EXPECT_EQ(status_of("GET / HTTP/1.1\r\nHost: localhost\r\nno colon\r\n\r\n"), 400);
  EXPECT_EQ(status_of("GET / HTTP/1.1\r\nHost: localhost\r\n : folded\r\n\r\n"), 400);
  EXPECT_EQ(status_of("GET /" + std::string(kMaxHeadBytes, 'a')), 431) << "has no end";
  EXPECT_EQ(status_of("GET /" + std::string(kMaxHeadBytes, 'a') + " HTTP/1.1\r\nHost: localhost\r\n\r\n"), 431);
}

}  // namespace
}  // namespace rumi::tool
