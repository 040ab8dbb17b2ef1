// SPDX-License-Identifier: BSD-3-Clause
#include "rumi/web/http_server.h"

#include <gmock/gmock.h>

#include <list>

#include "tests/rumi/web/http_client.h"

namespace rumi::tool {
namespace {

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
  HttpAnswer answer(const HttpRequest& request) {
    asked_.push_back(request.path);
    if (request.path == "/events") return {.type = "text/event-stream", .events = true};
    if (request.path == "/large") return {.body = large_};
    return text_answer(200, "this is " + request.path);
  }
  void listen(HttpClient& client) {
    client.get("/events");
    ASSERT_TRUE(client.hears("\r\n\r\n"));
  }
  std::vector<std::string> asked_;
  std::shared_ptr<const std::string> large_ = std::make_shared<const std::string>(large_text());
  HttpServer server_{0, [this](const HttpRequest& request) { return answer(request); }};
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
  EXPECT_THAT(post.heard(), HasSubstr("Allow: GET\r\n"));
  EXPECT_THAT(post.heard(), HasSubstr("nothing can be changed here"));
  foreign.say("GET /a HTTP/1.1\r\nHost: evil.example\r\n\r\n");
  ASSERT_TRUE(foreign.is_closed());
  EXPECT_THAT(foreign.heard(), HasSubstr("403 Forbidden"));
  garbage.say(std::string("\x16\x03\x01\x00\r\n\r\n", 8));
  ASSERT_TRUE(garbage.is_closed());
  EXPECT_THAT(garbage.heard(), HasSubstr("400 Bad Request"));
  EXPECT_TRUE(asked_.empty());
}

TEST_F(HttpServerTest, ALargeAnswerComesWholeToASlowReader) {
  HttpClient client(server_, 4096), other(server_);
  client.get("/large");
  for (int i = 0; i < 100; ++i) server_.serve(0, 0);
  EXPECT_TRUE(server_.is_sending());
  other.get("/quick");
  EXPECT_TRUE(other.hears("this is /quick")) << "waits for the other one";
  ASSERT_TRUE(client.hears("END"));
  EXPECT_EQ(client.heard().size() - client.heard().find("\r\n\r\n") - 4, large_->size());
  EXPECT_FALSE(server_.is_sending());
}

TEST_F(HttpServerTest, ListenersHearTheNewestOfEachEvent) {
  HttpClient client(server_);
  server_.tell("map", "told to nobody");
  server_.serve(0, 0);
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

// 400 MB are told, and it reads none of it: it gets the newest when it does, and what was under way.
TEST_F(HttpServerTest, WhoDoesNotReadIsNotToldAllLater) {
  constexpr int kEvents = 4000;
  HttpClient sleeper(server_, 4096), reader(server_);
  listen(sleeper);
  listen(reader);
  for (int i = 1; i <= kEvents; ++i) {
    server_.tell("map", std::string(100'000, 'x') + std::to_string(i) + "END");
    server_.serve(0, 0);
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
  clients.pop_front();  // closed
  ASSERT_TRUE(
      testing::happens([&] { return server_.listeners() < HttpServer::kMaxListeners; }, [&] { server_.serve(0, 0); }));
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
    ASSERT_TRUE(late.is_closed());
    EXPECT_THAT(late.heard(), HasSubstr("503"));
  }
  clients.front().get("/again");
  EXPECT_TRUE(clients.front().hears("this is /again"));
}

TEST_F(HttpServerTest, WhoNeitherAsksNorReadsIsLeft) {
  HttpClient silent(server_), half(server_), sleeper(server_, 4096), listener(server_);
  half.say("GET /a");
  sleeper.get("/large");
  listen(listener);
  for (int i = 0; i < 100; ++i) server_.serve(10 * kSecond, 0);
  half.say("b");  // a letter now and then does not help
  server_.serve(39 * kSecond, 0);
  EXPECT_TRUE(half.is_closed(41 * kSecond));
  EXPECT_TRUE(silent.is_closed(41 * kSecond));
  EXPECT_TRUE(sleeper.is_closed(41 * kSecond));
  server_.tell("map", "there");
  EXPECT_TRUE(listener.hears("there", 1000 * kSecond)) << "a listener may be silent for as long as it likes";
}

TEST_F(HttpServerTest, APortInUseIsNamedWithTheRemedy) {
  try {
    HttpServer second(server_.port(), [](const HttpRequest&) { return HttpAnswer(); });
    FAIL() << "two servers on one port";
  } catch (const std::runtime_error& e) {
    EXPECT_THAT(e.what(), HasSubstr("port " + std::to_string(server_.port()) + " is in use"));
    EXPECT_THAT(e.what(), HasSubstr("--port"));
  }
}

}  // namespace
}  // namespace rumi::tool
