// SPDX-License-Identifier: BSD-3-Clause
#include "rumi/web/http_server.h"

#include <gmock/gmock.h>

#include <list>

#include "tests/rumi/web/http_client.h"

namespace rumi::tool {
namespace {

using ::testing::ContainsRegex;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr int64_t kSecond = 1'000'000;

std::string large_text() {
  std::string text(30'000'000, 'x');
  text += "END";
  return text;
}

class HttpServerTest : public ::testing::Test {
 protected:
  HttpAnswer answer(const std::string& path) {
    asked_.push_back(path);
    if (path == "/events") return {.type = "text/event-stream", .events = true};
    if (path == "/broken") throw std::runtime_error("it broke");
    if (path == "/large") return {.body = large_};
    return text_answer(200, "this is " + path);
  }
  // Returns the head of the answer to a request; empty if the connection is closed without an answer.
  std::string head_of_answer(const std::string& request) {
    HttpClient client(server_);
    client.say(request);
    const auto is_there = [&] { return client.heard().find("\r\n\r\n") != std::string::npos || client.closed(); };
    EXPECT_TRUE(testing::happens(is_there, [&] { client.step(); })) << request;
    return client.heard().substr(0, client.heard().find("\r\n\r\n"));
  }
  void listen(HttpClient& client) {
    client.get("/events");
    ASSERT_TRUE(client.hears("\r\n\r\n"));
  }
  std::vector<std::string> asked_;
  std::shared_ptr<const std::string> large_ = std::make_shared<const std::string>(large_text());
  HttpServer server_{0, [this](const std::string& path) { return answer(path); }};
};

TEST_F(HttpServerTest, AnswersOneAfterTheOtherOnOneConnection) {
  HttpClient client(server_);
  client.say("GET /a HTTP/1.1\r\nHost: localhost\r\n\r\nGET /b HTTP/1.1\r\nHost: localhost\r\n\r\nGET /c HTT");
  ASSERT_TRUE(client.hears("this is /b\n"));
  EXPECT_THAT(client.heard(), HasSubstr("HTTP/1.1 200 OK\r\n"));
  EXPECT_THAT(client.heard(), HasSubstr("Content-Length: 11\r\n"));
  client.say("P/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n");
  ASSERT_TRUE(client.is_closed());
  EXPECT_THAT(client.heard(), HasSubstr("this is /c\n"));
  EXPECT_THAT(asked_, ::testing::ElementsAre("/a", "/b", "/c"));
}

TEST_F(HttpServerTest, NothingFromElsewhereAndForNobodyElse) {
  HttpClient client(server_);
  client.get("/");
  ASSERT_TRUE(client.hears("this is"));
  for (const char* header : {"Content-Security-Policy: default-src 'self';", "X-Content-Type-Options: nosniff",
                             "X-Frame-Options: DENY", "Cross-Origin-Resource-Policy: same-origin"})
    EXPECT_THAT(client.heard(), HasSubstr(header));
  EXPECT_THAT(client.heard(), Not(HasSubstr("Access-Control")));
}

TEST_F(HttpServerTest, WhatIsRefusedIsToldWhyAndClosed) {
  HttpClient post(server_), foreign(server_), garbage(server_);
  post.say("POST /a HTTP/1.1\r\nHost: localhost\r\nContent-Length: 2\r\n\r\nhi");
  ASSERT_TRUE(post.is_closed());
  EXPECT_THAT(post.heard(), HasSubstr("405 Method Not Allowed"));
  EXPECT_THAT(post.heard(), HasSubstr("Allow: GET, HEAD\r\n"));
  EXPECT_THAT(post.heard(), HasSubstr("nothing can be changed here"));
  foreign.say("GET /a HTTP/1.1\r\nHost: evil.example\r\n\r\n");
  ASSERT_TRUE(foreign.is_closed());
  EXPECT_THAT(foreign.heard(), HasSubstr("403 Forbidden"));
  garbage.say(std::string("\x16\x03\x01\x00\r\n\r\n", 8));
  ASSERT_TRUE(garbage.is_closed());
  EXPECT_TRUE(asked_.empty());
}

TEST_F(HttpServerTest, IsAskedForAPathWithoutParameters) {
  EXPECT_THAT(head_of_answer("GET /a/b?c=1 HTTP/1.1\r\nHost: localhost\r\n\r\n"), HasSubstr("200 OK"));
  EXPECT_THAT(head_of_answer("HEAD /c HTTP/1.0\r\nHost: localhost\r\n\r\n"), HasSubstr("Content-Length: 11"));
  EXPECT_THAT(asked_, ::testing::ElementsAre("/a/b", "/c"));
}

// The page of another site can reach this port by a name of its own, which its DNS resolves to 127.0.0.1.
TEST_F(HttpServerTest, OnlyByTheNamesOfThisComputer) {
  const auto with_host = [&](const std::string& host) {
    return head_of_answer("GET / HTTP/1.1\r\nHost: " + host + "\r\n\r\n");
  };
  for (const char* host :
       {"localhost", "localhost:8642", "LocalHost:1", "127.0.0.1", "127.0.0.1:9000", "[::1]", "[::1]:80"})
    EXPECT_THAT(with_host(host), HasSubstr("200 OK")) << host;
  asked_.clear();
  for (const char* host : {"evil.example", "evil.example:8642", "localhost.evil.example", "127.0.0.1.evil.example",
                           "192.168.1.5:8642", "localhost@evil.example", "::1"})
    EXPECT_THAT(with_host(host), HasSubstr("403 Forbidden")) << host;
  for (const char* host : {"", "evil.example localhost", "localhost\r\n .evil.example",
                           "localhost\r\nHost: evil.example", "evil.example\r\nHost: localhost"})
    EXPECT_THAT(with_host(host), ContainsRegex("^HTTP/1.1 40[03] ")) << host;
  EXPECT_THAT(head_of_answer("GET / HTTP/1.1\r\nAccept: */*\r\n\r\n"), ContainsRegex("^HTTP/1.1 40[03] ")) << "none";
  EXPECT_THAT(head_of_answer("GET / HTTP/1.0\r\n\r\n"), ContainsRegex("^HTTP/1.[01] 403 ")) << "none";
  EXPECT_TRUE(asked_.empty());
}

TEST_F(HttpServerTest, WhatIsTooMuchIsNotRead) {
  const std::string begin = "GET / HTTP/1.1\r\nHost: localhost\r\n";
  EXPECT_EQ(head_of_answer(begin + "Content-Length: 5\r\n\r\nhello"), "");
  EXPECT_EQ(head_of_answer(begin + "Transfer-Encoding: chunked\r\n\r\n5\r\nhello\r\n"), "");
  EXPECT_THAT(head_of_answer(begin + "A: " + std::string(100'000, 'a')), HasSubstr("431 Request Header Fields"));
  EXPECT_THAT(head_of_answer("GET /" + std::string(100'000, 'a')), HasSubstr("414 "));
  EXPECT_TRUE(asked_.empty());
}

TEST_F(HttpServerTest, AnErrorIsAnAnswerToo) {
  EXPECT_THAT(head_of_answer("GET /broken HTTP/1.1\r\nHost: localhost\r\n\r\n"), HasSubstr("500 Internal"));
}

TEST_F(HttpServerTest, ALargeAnswerComesWholeToASlowReader) {
  HttpClient client(server_, 4096), other(server_);
  client.get("/large");
  for (int i = 0; i < 100; ++i) server_.serve(0);
  other.get("/quick");
  EXPECT_TRUE(other.hears("this is /quick")) << "waits for the other one";
  ASSERT_TRUE(client.hears("END"));
  EXPECT_EQ(client.heard().size() - client.heard().find("\r\n\r\n") - 4, large_->size());
}

TEST_F(HttpServerTest, ListenersHearTheNewestOfEachEvent) {
  HttpClient client(server_);
  server_.tell("map", "told to nobody");
  server_.serve(0);
  listen(client);
  EXPECT_THAT(client.heard(), HasSubstr("Content-Type: text/event-stream\r\n"));
  server_.tell("map", "1");
  server_.tell("map", "2");
  server_.tell("pose", "3");
  ASSERT_TRUE(client.hears("event: pose\ndata: 3\n\n"));
  EXPECT_THAT(client.heard(), HasSubstr("event: map\ndata: 2\n\n"));
  EXPECT_THAT(client.heard(), Not(HasSubstr("data: 1\n")));
  EXPECT_THAT(client.take(), Not(HasSubstr("nobody")));
  HttpClient later(server_);
  listen(later);
  ASSERT_TRUE(later.hears("data: 3\n\n")) << "is not told what is known";
  server_.tell("pose", "4");
  ASSERT_TRUE(client.hears("data: 4\n\n"));
  EXPECT_THAT(client.heard(), Not(HasSubstr("data: 2\n"))) << "is told twice";
}

// The sleeper does not read while events of 400 MB in all are sent. When it reads, it gets the rest of the event that
// was under way, and the newest one.
TEST_F(HttpServerTest, WhoDoesNotReadIsNotToldAllLater) {
  constexpr int kEvents = 4000;
  HttpClient sleeper(server_, 4096), reader(server_);
  listen(sleeper);
  listen(reader);
  for (int i = 1; i <= kEvents; ++i) {
    server_.tell("map", std::string(100'000, 'x') + std::to_string(i) + "END");
    server_.serve(0);
  }
  EXPECT_TRUE(reader.hears("x4000END"));
  ASSERT_TRUE(sleeper.hears("x4000END"));
  EXPECT_LT(sleeper.heard().size(), 40'000'000u);
}

TEST_F(HttpServerTest, ListenersAreFew) {
  std::list<HttpClient> clients;
  for (size_t i = 0; i < HttpServer::kMaxListeners; ++i) listen(clients.emplace_back(server_));
  EXPECT_EQ(server_.listeners(), HttpServer::kMaxListeners);
  HttpClient late(server_);
  late.get("/events");
  ASSERT_TRUE(late.hears("are open already"));
  EXPECT_THAT(late.heard(), HasSubstr("503 Service Unavailable"));
  clients.pop_front();  // closes the connection of the first client
  ASSERT_TRUE(
      testing::happens([&] { return server_.listeners() < HttpServer::kMaxListeners; }, [&] { server_.serve(0); }));
  HttpClient next(server_);
  listen(next);
  EXPECT_THAT(next.heard(), HasSubstr("200 OK"));
}

TEST_F(HttpServerTest, ConnectionsAreBounded) {
  std::list<HttpClient> clients;
  for (size_t i = 0; i < HttpServer::kMaxConnections; ++i) {
    clients.emplace_back(server_).get("/");
    ASSERT_TRUE(clients.back().hears("this is"));
  }
  for (int i = 0; i < 5; ++i) {
    HttpClient late(server_);
    late.get("/");
    ASSERT_TRUE(late.is_closed());
    EXPECT_THAT(late.heard(), HasSubstr("503"));
  }
  clients.front().get("/again");
  EXPECT_TRUE(clients.front().hears("this is /again"));
}

// Connections that ask nothing are bounded, too. The operating system lets further ones wait.
TEST_F(HttpServerTest, ConnectionsThatAskNothingAreBounded) {
  std::list<HttpClient> clients;
  for (size_t i = 0; i < HttpServer::kMaxConnections + 30; ++i) {
    clients.emplace_back(server_);
    server_.serve(0);
  }
  clients.back().get("/");
  for (int i = 0; i < 20; ++i) server_.serve(0);
  EXPECT_TRUE(asked_.empty());
  while (clients.size() > HttpServer::kMaxConnections) clients.pop_front();
  EXPECT_TRUE(clients.back().hears("this is /"));
}

// The clock is that of the library. A client has one second here.
TEST_F(HttpServerTest, WhoNeitherAsksNorReadsIsLeft) {
  HttpServer impatient(
      0, [this](const std::string& path) { return answer(path); }, 1);
  HttpClient silent(impatient), half(impatient), sleeper(impatient, 4096), listener(impatient);
  half.say("GET /a");
  sleeper.get("/large");
  listen(listener);
  EXPECT_TRUE(half.is_closed());
  EXPECT_TRUE(silent.is_closed());
  EXPECT_TRUE(testing::happens([&] { return large_.use_count() == 1; }, [&] { impatient.serve(0); }));
  EXPECT_TRUE(sleeper.is_closed());
  EXPECT_LT(sleeper.heard().size(), large_->size());
  impatient.tell("map", "there");
  EXPECT_TRUE(listener.hears("there")) << "a listener may be silent for as long as it likes";
}

TEST_F(HttpServerTest, APortInUseIsNamedWithTheRemedy) {
  try {
    HttpServer second(server_.port(), [](const std::string&) { return HttpAnswer(); });
    FAIL() << "two servers on one port";
  } catch (const std::runtime_error& e) {
    EXPECT_THAT(e.what(), HasSubstr("port " + std::to_string(server_.port()) + " is in use"));
    EXPECT_THAT(e.what(), HasSubstr("--port"));
  }
}

}  // namespace
}  // namespace rumi::tool
